//! The laboratory's graphics processor in a browser's worker, in single precision, with these additional messages.
//!
//! | from the page | from the worker |
//! |---|---|
//! | `["graphics", software]` | `["graphics", name]`, or `["no graphics", reason]` |
//! | `["more", …]` | `["refused", number]` where the ensemble is not served, `["lost", number, reason]` when the processor fails |
//!
//! `software` is true if a software adapter is accepted. The worker serves no cells before it has found the processor. Cells that the
//! processor does not serve are missing in the rows, and cells of a task before the last one get no answer.

#[cfg(target_arch = "wasm32")]
mod graphics;

fn main() {
    #[cfg(target_arch = "wasm32")]
    graphics::serve();
}
