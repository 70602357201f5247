//! The tests of the lessons from outside: one program, which is linked once. `cargo test -p kalmanscope-lessons --test all NAME::` runs
//! those of one file.

mod adjustment;
mod claims;
mod lesson;
mod library;
mod outcome;
mod question;
mod records;
mod stories;
mod verify;
