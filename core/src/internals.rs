//! Parts that the crates and benchmarks of this workspace take from inside: for runs side by side, for programs of graphics
//! processors, and for small pages. They are not the library: any of them may change or go at any time.

pub mod engine;

pub use crate::data::hash::short_hash;
pub use crate::mathematics::gaussian_likelihood::{LogSum, ln_determinant, log_likelihood};
pub use crate::mathematics::lists::sort_numbers;
pub use crate::mathematics::model::Reading;
pub use crate::numbers::score::ChannelSums;
