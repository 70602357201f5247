//! Outputs of the built command: written whole or not at all, and never over an input; the exit code reports a failure.

mod files;
mod folder;
mod limits;
mod streams;
mod words;
