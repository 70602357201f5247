//! The laboratory's graphics processor in a browser's worker, in single precision: a worker as others, with these messages
//! more.
//!
//! | from the page | from the worker |
//! |---|---|
//! | `["graphics", software]` | `["graphics", name]`, or `["no graphics", reason]` |
//! | `["cells", …]` | `["refused", job]` where the ensemble is not served, `["lost", job, reason]` when the processor fails |
//!
//! `software` is true where a program in its place will do. Cells are not served before the processor is there. Those that it
//! does not serve are missing in the rows, and cells of a job that is not the last one are not answered.

#[cfg(target_arch = "wasm32")]
mod graphics;

fn main() {
    #[cfg(target_arch = "wasm32")]
    graphics::serve();
}
