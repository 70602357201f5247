//! Parts that the tests take from inside. They are not the library: any of them may change or go at any time.

pub use crate::cause::{Agreement, Readings, change_point, still_part};
pub use crate::periodogram::Periodogram;
pub use crate::words::{percent, percent_to_a_tenth, plain, seconds, short};
