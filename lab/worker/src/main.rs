//! The laboratory in a browser's worker: it is given an ensemble, then cells of it, and answers with their rows.
//!
//! | from the page | from the worker |
//! |---|---|
//! | | `["ready"]` |
//! | `["ensemble", job, ensemble, record]` | `["failed", job, reason]` where it cannot be used |
//! | `["cells", job, Uint32Array]` | `["rows", job, Uint32Array, Float64Array]` |
//!
//! A job is a number, an ensemble JSON. `record` is null, or `[dt, input, [key, column], …]` with a `Float64Array` for each column. Rows are
//! handed over, not copied.

#[cfg(target_arch = "wasm32")]
mod message;
#[cfg(target_arch = "wasm32")]
mod serve;

fn main() {
    #[cfg(target_arch = "wasm32")]
    serve::serve();
}
