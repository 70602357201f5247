//! The conversation between a page and one of its workers: the worker is given an ensemble, then cells of it, and
//! answers with their rows; or an errand (a filter or the import of a record), then numbers of portions, and answers
//! with the parts that are done.
//!
//! | from the page | from the worker |
//! |---|---|
//! | | `["ready"]` |
//! | `["ensemble", job, ensemble, record]` | `["failed", job, reason]` where it cannot be used |
//! | `["cells", job, Uint32Array]` | `["rows", job, Uint32Array, Float64Array, time]` |
//! | `["filter", number, scenario, record, place]` | `["failed", number, reason]` where it cannot be used |
//! | `["file", number, Uint8Array]` | |
//! | `["suggest", number, scenario, record]` | `["failed", number, reason]` where it cannot be used |
//! | `["more", number, count]` | `["part", number, part, time]` |
//! | `["forget", number]` | |
//!
//! A job is a number, an ensemble JSON. `record` is null, or `[dt, input, [key, column], …]` with a `Float64Array` for
//! each column. A part of a filter is a `Float64Array`, the numbers of a tape. A part of a file or of start values is
//! the share that is done. The last part is the outcome: for a file `[hash, table, column, …]` or a text with the
//! reason why it cannot be read, for start values JSON. Columns of numbers are handed over, not copied. The time is
//! that of the computation \[ms\].

#![cfg(target_arch = "wasm32")]

mod errand;
mod file;
mod filter;
mod message;
mod record;
mod scope;
mod slices;
mod suggestion;
mod work;

pub use errand::Errand;
pub use file::{file_message, loaded};
pub use filter::{filter_message, tape};
pub use message::{cells, runner};
pub use record::{filtered, in_message, measured};
pub use scope::{Watch, Words, answer, hear, tell};
pub use suggestion::{suggest_message, suggestion};
