//! Parts that the crates and benchmarks of this workspace take from inside; any of them may change or go at any time.

pub use crate::run::Bank;
pub use crate::run::revision::Revision;
pub use crate::run::smoother::Smoother;
pub use crate::run::waste::{Spare, Waste};
pub use crate::scenario::cost;
pub use crate::statistics::score::ChannelSums;
pub use kalmanscope_filters::Reading;
pub use kalmanscope_filters::catalogue::KnownChannels;
pub use kalmanscope_filters::fourier::Transform;
pub use kalmanscope_filters::gaussian_likelihood::log_likelihood;
pub use kalmanscope_filters::lists::{mapped, numbers, places, sort_items, sort_numbers, sorted_places};
pub use kalmanscope_records::hash::short_hash;
pub use kalmanscope_records::task::pause;

/// The engine, its filters of scenarios and its runs over records.
pub mod engine {
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
}
