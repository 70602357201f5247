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
        let sensor = |row: usize| observation.active[row].sensor;
        let innovation = Vector::<M>::from_fn(|row, _| correction.innovation[sensor(row)]);
        if self.process_noise {
            let gain = Matrix::<N, M>::from_fn(|i, row| correction.gain[sensor(row)][i]);
            let shift = gain * innovation;
            noise.process = noise.process * keep + shift * shift.transpose() * (1.0 - keep);
        }
        if self.sensor_noise {
            let cov = Matrix::<M, M>::from_fn(|i, j| correction.innovation_cov[sensor(i)][sensor(j)]);
            let Some(inverse) = Factor::new(&cov).map(|factor| factor.divide(&Matrix::<M, M>::identity())) else {
                return;
            };
            let white = inverse * innovation;
            for (row, active) in observation.active.iter().enumerate() {
                let r = active.variance;
                let residual = r * white[row];
                let seen = r - r * r * inverse[(row, row)];
                noise.sensors[active.sensor] = keep * r + (1.0 - keep) * (residual * residual + seen.max(0.0));
            }
        }
    }
}
