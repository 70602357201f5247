//! The tests on a graphics processor, or on one in software: one program, which is linked once. `cargo test -p kalmanscope-gpu --test all
//! languages::` needs neither.
#![expect(clippy::unwrap_used, reason = "a helper that fails is a test that fails")]

mod common;
mod runs;

mod inside;
mod languages;
mod served;

/// Tests that take minutes where the graphics processor is one in software.
mod on_adapter {
    mod maps;
    mod random;
}
