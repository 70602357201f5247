//! The tests of the lanes: one program, which is linked once. `cargo test -p kalmanscope-lanes --test all NAME::` runs those of one file.
#![expect(clippy::unwrap_used, reason = "a helper that fails is a test that fails")]

mod common;
mod engine;
