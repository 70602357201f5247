//! What tests that drive the app from outside read: the state of the screen as data, and where controls are.

mod places;
mod screen;

pub(crate) use places::remember;
pub use screen::ScreenState;
