//! Probes for tests that drive the app from outside: the state of the screen as data, and the positions of controls.

mod places;
mod screen;

pub use places::place;
pub(crate) use places::remember;
pub use screen::{Latest, ScreenState};
