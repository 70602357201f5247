//! The engine, its filters of scenarios and its runs over records.

pub use crate::run::estimator::setup::Setup;
pub use crate::statistics::score::lanes::{SetupRun, outcomes};
pub use kalmanscope_filters::engine::builder::{Builder, Notes};
pub use kalmanscope_filters::engine::design::Method;
pub use kalmanscope_filters::engine::lanes::Lanes;
pub use kalmanscope_filters::engine::level::{Baseline, Known, Level};
pub use kalmanscope_filters::engine::list::{Node, Operation};
pub use kalmanscope_filters::engine::number::Function;
#[cfg(target_arch = "wasm32")]
pub use kalmanscope_filters::engine::pair::LanePair;

/// A design of filters over a plant.
pub type Design = kalmanscope_filters::engine::design::Design<crate::plant::dynamics::EnginePlant>;
