//! The cost of a frame without a screen: the median of simple cases, and the longest frame of the heaviest one.

mod clock;
mod longest;
#[path = "../../tests/ui/memory.rs"]
mod memory;
mod screen;
mod typical;

/// `cargo bench --bench frame -- WORD` runs the cases that have the word in their names.
fn main() {
    let wanted = std::env::args().nth(1).filter(|arg| !arg.starts_with('-')).unwrap_or_default();
    typical::run(&wanted);
    longest::run(&wanted);
}
