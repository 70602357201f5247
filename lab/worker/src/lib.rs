//! The conversation between a page and one of its workers, which is given tasks, and answers portions of them with parts.
//!
//! | from the page | from the worker |
//! |---|---|
//! | | `["ready"]` |
//! | `["cells", number, ensemble, record]` | `["failed", number, reason]` where it cannot be used |
//! | `["filter", number, scenario, record, place]` | the same |
//! | `["file", number, Uint8Array]` | |
//! | `["suggest", number, scenario, record]` | the same |
//! | `["more", number, portion]` | `["part", number, part]` |
//! | `["forget", number]` | |
//!
//! `number` is that of the task; an ensemble and a scenario are JSON. `record` is null, or `[dt, input, [key, column], …]`
//! with a `Float64Array` for each column.
//!
//! | task | portion | part |
//! |---|---|---|
//! | cells | `Uint32Array` of cells | `[Uint32Array, Float64Array]`: the cells and their rows |
//! | filter | number of samples | `Float64Array`: the numbers of a tape |
//! | file | number of pieces of work | the share that is done; last `[hash, table, column, …]`, or why it cannot be read |
//! | suggest | number of pieces of work | the share that is done; last JSON |
//!
//! Columns of numbers are handed over, not copied.

#![cfg(target_arch = "wasm32")]

mod messages;
mod scope;

pub use messages::{
    cells, cells_message, file_message, filter_message, loaded, portion_of, rows, rows_part, runner, serve,
    suggest_message, suggestion, tape,
};
pub use scope::{Words, answer, fail, hear, tell};
