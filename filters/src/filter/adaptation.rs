//! Noise that a filter learns from its own innovations.

use serde::{Deserialize, Serialize};

use crate::engine::number::Number;

/// Estimates R, Q or both while filtering, with exponential forgetting.
///
/// ```text
/// ε = R S⁻¹ e                          the residual z - h(y⁺)
/// R ← a R + (1 - a) diag(ε εᵀ + H P Hᵀ),  H P Hᵀ = R - R S⁻¹ R
/// Q ← a Q + (1 - a) K e eᵀ Kᵀ
/// ```
///
/// with P after the update. The residual is exact for sensors that are linear in the state. For others, such as
/// accelerometers, it is the residual of the linearised sensor, not `z - h(y⁺)`; these differ by the curvature of h. R
/// stays diagonal, as the sensors are independent. A sensor that is missing keeps its variance.
///
/// R has its own uncertainty. `ε²` has the variance `2 (s R)²` where `s = R S⁻¹`, and R comes back in ε, which slows the
/// forgetting down:
///
/// ```text
/// var R ← c² var R + 2 ((1 - a) s R)²,  c = 1 - (1 - a) s²
/// ```
///
/// It begins with `R²`: that of the settings may be all wrong.
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
    /// a, in (0, 1): the share of the last estimate that stays.
    pub forgetting: f64,
    /// The time for which it learns \[s\]: then it works with what it has learnt. 0 for all of the record.
    pub training: f64,
}

/// Limits the rounding error of times \[s\], which users write in decimals.
const ROUNDING: f64 = 1e-9;

impl Default for Adaptation {
    fn default() -> Self {
        Self { sensor_noise: false, process_noise: false, forgetting: 0.995, training: 0.0 }
    }
}

impl Adaptation {
    /// R of a sensor and the variance of that R, after a measurement with this residual ε and `H P⁺ Hᵀ`.
    pub(crate) fn learn<T: Number>(&self, [r, variance]: [T; 2], [residual, uncertainty]: [T; 2]) -> [T; 2] {
        let (keep, share) = (self.forgetting, 1.0 - self.forgetting);
        let of_sensor = r - uncertainty;
        let s = T::select(T::of(0.0).lt(r), of_sensor / r, T::of(0.0));
        let (stays, noise) = (T::of(1.0) - s * s * share, of_sensor * share);
        let next = r * keep + (residual * residual + uncertainty) * share;
        [next, stays * stays * variance + noise * noise * 2.0]
    }

    /// The variance of R before the first measurement; zero where R is not learnt.
    pub fn initial_uncertainty<T: Number>(&self, r: T) -> T {
        if self.sensor_noise { r * r } else { T::of(0.0) }
    }

    /// Whether it still learns from the sample at a place, counted from 0, with `dt` \[s\] between samples.
    pub fn learns_at(&self, sample: usize, dt: f64) -> bool {
        self.training == 0.0 || sample as f64 * dt <= self.training * (1.0 + ROUNDING)
    }

    /// Whether anything is learnt.
    pub fn is_on(&self) -> bool {
        self.sensor_noise || self.process_noise
    }
}
