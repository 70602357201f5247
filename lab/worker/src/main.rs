//! The laboratory in a browser's worker: it is given an ensemble, then cells of it, and answers with their rows.
//!
//! | from the page | from the worker |
//! |---|---|
//! | | `["ready"]` |
//! | `["ensemble", job, ensemble, record]` | `["failed", job, reason]` where it cannot be used |
//! | `["cells", job, Uint32Array]` | `["rows", job, Uint32Array, Float64Array]` |
//! | `["graphics", software]` | `["graphics", name]`, or `["no graphics", reason]` |
//!
//! A worker that has been asked for the graphics processor, and has answered with its name, computes there, in single precision.
//! `software` is true where a program in its place will do. It answers `["refused", job]` to cells of an ensemble that is not
//! served there, `["lost", job, reason]` when the processor fails, and nothing to cells of a job that is not the last one.
//!
//! A job is a number, an ensemble JSON. `record` is null, or `[dt, input, [key, column], …]` with a `Float64Array` for each column. Rows are
//! handed over, not copied.

#[cfg(target_arch = "wasm32")]
mod graphics;
#[cfg(target_arch = "wasm32")]
mod message;
#[cfg(target_arch = "wasm32")]
mod serve;

fn main() {
    #[cfg(target_arch = "wasm32")]
    serve::serve();
}
