//! The engine, its filters of scenarios and its runs over records.

pub use crate::mathematics::engine::builder::{Builder, Notes};
pub use crate::mathematics::engine::design::{Design, Method};
pub use crate::mathematics::engine::lanes::Lanes;
pub use crate::mathematics::engine::level::{Baseline, Known, Level};
pub use crate::mathematics::engine::list::{Node, Operation};
pub use crate::mathematics::engine::number::Function;
#[cfg(target_arch = "wasm32")]
pub use crate::mathematics::engine::pair::LanePair;
pub use crate::numbers::score::lanes::{Run, outcomes};
pub use crate::samples::estimator::setup::Setup;
