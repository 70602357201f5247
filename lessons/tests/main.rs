//! The tests of the lessons from outside: one program, which is linked once. `cargo test -p kalmanscope-lessons --test all NAME::` runs
//! those of one file.
#![expect(clippy::unwrap_used, reason = "a helper that fails is a test that fails")]

mod adjustment;
mod claims;
mod lesson;
mod library;
mod outcome;
mod question;
mod records;
mod stories;
mod verify;
