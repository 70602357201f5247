//! Parts that the crates and benchmarks of this workspace take from inside: for runs side by side, for programs of graphics
//! processors, and for small pages. They are not the library: any of them may change or go at any time.

pub mod engine;

pub use crate::data::hash::short_hash;
pub use crate::data::resample::finer;
pub use crate::data::scenario::cost;
pub use crate::mathematics::catalogue::KnownPlants;
pub use crate::mathematics::fourier::Transform;
pub use crate::mathematics::gaussian_likelihood::{LogSum, ln_determinant, log_likelihood};
pub use crate::mathematics::lists::sort_numbers;
pub use crate::mathematics::lists::{mapped, numbers, places, sort_items, sorted_places};
pub use crate::mathematics::model::Reading;
pub use crate::numbers::score::ChannelSums;
pub use crate::samples::estimator::FilterContext;
pub use crate::samples::run::{Bank, revision::Revision};
pub use crate::samples::smoother::{FixedInterval, Forward, Smoother};
pub use crate::samples::waste::{Piecewise, Spare, Waste};
