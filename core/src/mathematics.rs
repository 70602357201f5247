//! Plants, sensors and filters: the state of a plant, its motion, the readings of sensors, and the filters that estimate it.
//! Nothing here knows a scenario, a record or a run.

pub(crate) mod catalogue;
pub mod channel;
pub(crate) mod engine;
pub mod equation;
pub mod filter;
pub(crate) mod filter_error;
pub(crate) mod fourier;
pub(crate) mod gaussian_likelihood;
pub(crate) mod least_squares;
pub(crate) mod linalg;
pub(crate) mod lists;
pub(crate) mod model;
pub(crate) mod noise_scale;
pub mod plant;
pub(crate) mod quantity;
pub(crate) mod random;
pub(crate) mod registry;
pub(crate) mod truncated_normal;
