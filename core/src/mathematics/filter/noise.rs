//! The noise that a filter assumes.

use crate::mathematics::linalg::Matrix;

/// The noise that a filter assumes for model and sensors, and its fading.
#[derive(Clone, Debug, PartialEq)]
pub struct Noise {
    /// Q, the covariance that each step adds, n × n, in the state's units squared.
    pub process: Matrix,
    /// Diagonal of R, in the sensors' order and units squared.
    pub sensors: Vec<f64>,
    /// Fading factor λ ≥ 1 on the predicted covariance.
    pub fading: f64,
}

impl Noise {
    /// Whether every number of Q and R is finite.
    pub(crate) fn is_finite(&self) -> bool {
        self.process.sum().is_finite() && self.sensors.iter().all(|r| r.is_finite())
    }

    /// Replaces the covariance P by `λ P + Q`, symmetric to the last bit. A variance that rounding made negative
    /// becomes zero.
    pub fn spread(&self, cov: &mut Matrix) {
        let Self { process, sensors: _, fading } = self;
        for (cov, process) in cov.as_mut_slice().iter_mut().zip(process.as_slice()) {
            *cov = *cov * fading + process;
        }
        for i in 0..cov.nrows() {
            if cov[(i, i)] < 0.0 {
                cov[(i, i)] = 0.0;
            }
        }
        cov.fill_upper_triangle_with_lower_triangle();
    }
}
