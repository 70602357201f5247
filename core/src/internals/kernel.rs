//! The kernels, and those filters of scenarios that are oscillators'.

pub use crate::mathematics::kernel::gaussian::{Gaussian, Matrix, Vector};
pub use crate::mathematics::kernel::model::{Model, Output};
pub use crate::mathematics::kernel::plant::bouc_wen::BoucWen;
pub use crate::mathematics::kernel::plant::duffing::Duffing;
pub use crate::mathematics::kernel::plant::sdof::Sdof;
pub use crate::mathematics::kernel::plant::shear_chain::ShearChain;
pub use crate::mathematics::kernel::{Belief, Correction, Filter, Linearised, MAX_SENSORS, Noise, SigmaPoints};
pub use crate::samples::estimator::abreast::{Method, Oscillator, OscillatorFilter};
