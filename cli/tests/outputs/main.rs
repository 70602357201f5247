//! Outputs of the built command: written whole or not at all, never over an input, and told by the exit code.
#![cfg(unix)]
#![expect(clippy::unwrap_used, reason = "a helper that fails is a test that fails")]

mod files;
mod folder;
mod limits;
mod streams;
mod words;
