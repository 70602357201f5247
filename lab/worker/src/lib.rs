//! The conversation between a page and a worker of its laboratory: the worker is given an ensemble, then cells of it, and
//! answers with their rows.
//!
//! | from the page | from the worker |
//! |---|---|
//! | | `["ready"]` |
//! | `["ensemble", job, ensemble, record]` | `["failed", job, reason]` where it cannot be used |
//! | `["cells", job, Uint32Array]` | `["rows", job, Uint32Array, Float64Array]` |
//!
//! A job is a number, an ensemble JSON. `record` is null, or `[dt, input, [key, column], …]` with a `Float64Array` for each column. Rows are
//! handed over, not copied.

#![cfg(target_arch = "wasm32")]

mod message;
mod record;
mod scope;

pub use message::{cells, runner};
pub use record::{in_message, measured};
pub use scope::{Words, answer, hear, tell};
