//! Outputs of the built command: written whole or not at all, and never over an input; the exit code reports a failure.
#![cfg(unix)]
#![expect(clippy::unwrap_used, reason = "a helper that fails is a test that fails")]

mod files;
mod folder;
mod limits;
mod streams;
mod words;
