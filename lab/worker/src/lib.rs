//! The conversation between a page and one of its workers: the worker is given an ensemble, then cells of it, and answers with
//! their rows; or a filter, then numbers of samples, and answers with these.
//!
//! | from the page | from the worker |
//! |---|---|
//! | | `["ready"]` |
//! | `["ensemble", job, ensemble, record]` | `["failed", job, reason]` where it cannot be used |
//! | `["cells", job, Uint32Array]` | `["rows", job, Uint32Array, Float64Array]` |
//! | `["filter", number, scenario, place, record]` | `["failed", number, reason]` where it cannot be used |
//! | `["samples", number, count]` | `["samples", number, Float64Array]` |
//! | `["forget", number]` | |
//!
//! A job is a number, an ensemble JSON. `record` is null, or `[dt, input, [key, column], …]` with a `Float64Array` for each column. Samples are
//! the numbers of a tape. Rows and samples are handed over, not copied.

#![cfg(target_arch = "wasm32")]

mod filter;
mod message;
mod record;
mod scope;

pub use filter::{Filter, filter_message, tape};
pub use message::{cells, runner};
pub use record::{filtered, in_message, measured};
pub use scope::{Words, answer, hear, tell};
