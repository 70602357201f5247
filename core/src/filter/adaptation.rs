//! Noise that a filter learns from its own innovations.

use serde::{Deserialize, Serialize};

use super::{Correction, Noise, Observation};
use crate::gaussian::{Factor, Matrix, Vector};

/// Estimates R, Q or both while filtering, with exponential forgetting.
///
/// ```text
/// ε = R S⁻¹ e                          the residual z - h(y), for sensors linear in the state
/// R ← a R + (1 - a) diag(ε εᵀ + H P Hᵀ),  H P Hᵀ = R - R S⁻¹ R
/// Q ← a Q + (1 - a) K e eᵀ Kᵀ
/// ```
///
/// with P after the update. R stays diagonal, as the sensors are independent. A sensor that is missing keeps its variance.
///
/// Source: Akhlaghi, Zhou and Huang (2017), Adaptive adjustment of noise covariance in Kalman filter for dynamic state
/// estimation, equations 10 and 15.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Adaptation {
    /// Whether R is estimated.
    pub sensor_noise: bool,
    /// Whether Q is estimated.
    pub process_noise: bool,
    /// a, in (0, 1): how much of the last estimate stays.
    pub forgetting: f64,
}

impl Default for Adaptation {
    /// R and Q stay as they are.
    fn default() -> Self {
        Self { sensor_noise: false, process_noise: false, forgetting: 0.995 }
    }
}

impl Adaptation {
    pub(super) fn is_on(&self) -> bool {
        self.sensor_noise || self.process_noise
    }

    pub(super) fn adapt<const N: usize, const M: usize>(
        &self,
        observation: &Observation<M>,
        correction: &Correction<N>,
        noise: &mut Noise<N>,
    ) {
        let keep = self.forgetting;
        let measured = observation.measured();
        let innovation = |sensor: usize| correction.innovation[sensor];
        if self.process_noise {
            let mut shift = Vector::<N>::zeros();
            for active in measured {
                shift += Vector::from(correction.gain[active.sensor]) * innovation(active.sensor);
            }
            noise.process = noise.process * keep + shift * shift.transpose() * (1.0 - keep);
        }
        if self.sensor_noise {
            // Sensors without a measurement have a row of their own.
            let mut cov = Matrix::<M, M>::identity();
            let mut innovations = Vector::<M>::zeros();
            for (i, row) in measured.iter().enumerate() {
                innovations[i] = innovation(row.sensor);
                for (j, column) in measured.iter().enumerate() {
                    cov[(i, j)] = correction.innovation_cov[row.sensor][column.sensor];
                }
            }
            let Some(inverse) = Factor::new(&cov).map(|factor| factor.divide(&Matrix::<M, M>::identity())) else {
                return;
            };
            let white = inverse * innovations;
            for (row, active) in measured.iter().enumerate() {
                let r = active.variance;
                let residual = r * white[row];
                let seen = r - r * r * inverse[(row, row)];
                noise.sensors[active.sensor] = keep * r + (1.0 - keep) * (residual * residual + seen.max(0.0));
            }
        }
    }
}
