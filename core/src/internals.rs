//! Parts that the crates and benchmarks of this workspace take from inside: for runs side by side, for programs of graphics
//! processors, and for small pages. They are not the library: any of them may change or go at any time.

pub use crate::data::sorting::{sort_numbers, sort_short_by, sort_short_by_key};
pub use crate::mathematics::gaussian_likelihood::{ln_determinant, log_likelihood};
pub use crate::mathematics::integrate::{INVERSE_FACTORIAL, doublings};
pub use crate::mathematics::kernel::propagation::SERIES;
pub use crate::mathematics::log_sum::LogSum;
pub use crate::mathematics::model::Reading;
pub use crate::numbers::score::outcome::ChannelSums;

/// The engine, its filters of scenarios and its runs.
pub mod engine {
    pub use crate::mathematics::engine::builder::Builder;
    pub use crate::mathematics::engine::design::{Design, Method};
    pub use crate::mathematics::engine::function::Function;
    pub use crate::mathematics::engine::lanes::Lanes;
    pub use crate::mathematics::engine::level::{Baseline, Known, Level};
    pub use crate::mathematics::engine::list::{Node, Operation};
    pub use crate::mathematics::engine::notes::Notes;
    pub use crate::numbers::score::lanes::{Run, outcomes};
    pub use crate::samples::estimator::setup::Setup;
}

/// The kernels, and the filters of scenarios that are oscillators'.
pub mod kernel {
    pub use crate::mathematics::kernel::gaussian::{Gaussian, Matrix, Vector};
    pub use crate::mathematics::kernel::model::{Model, Output};
    pub use crate::mathematics::kernel::plant::bouc_wen::BoucWen;
    pub use crate::mathematics::kernel::plant::duffing::Duffing;
    pub use crate::mathematics::kernel::plant::sdof::Sdof;
    pub use crate::mathematics::kernel::plant::shear_chain::ShearChain;
    pub use crate::mathematics::kernel::{
        Belief, Correction, Filter, Linearised, MAX_SENSORS, Noise, SigmaPoints, SquareRoot,
    };
    pub use crate::samples::estimator::abreast::{Method, Oscillator, OscillatorFilter};
}
