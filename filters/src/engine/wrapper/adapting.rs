//! Noise that a filter learns from its own innovations.

use serde::{Deserialize, Serialize};

use super::{Learnt, Readings, Recursion, Span, Wrapper};
use crate::engine::dynamics::Dynamics;
use crate::engine::filter::GaussianFilter;
use crate::engine::number::Number;
use crate::engine::update::UpdateResult;
use crate::engine::weights::{Innovations, Residuals};
use crate::lists::mapped;

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
/// `ε²` has the variance `2 (s R)²` where `s = R S⁻¹`, and R comes back in ε, which slows the forgetting down:
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
        // About 200 samples of memory: R of a sensor then varies by 7 % by chance, √(2 (1 - a) / (1 + a)).
        Self { sensor_noise: false, process_noise: false, forgetting: 0.995, training: 0.0 }
    }
}

impl Adaptation {
    /// R of a sensor and the variance of that R, after a measurement with this residual ε and `H P⁺ Hᵀ`.
    pub(crate) fn learn<T: Number>(&self, [r, variance]: [T; 2], [residual, uncertainty]: [T; 2]) -> [T; 2] {
        let (keep, share) = (self.forgetting, 1.0 - self.forgetting);
        let of_sensor = r - uncertainty;
        // R may have vanished, and 0 / 0 would stay in its variance from then on.
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

/// A filter that learns R, Q or both, as [`Adaptation`] has it.
#[derive(Clone, Debug)]
pub struct Adapting<T> {
    pub(crate) adaptation: Adaptation,
    pub(crate) uncertainty: Vec<T>,
    /// K e
    shift: Vec<T>,
    residuals: Residuals<T>,
    /// The sample, and the time between samples \[s\].
    pub(crate) sample: usize,
    dt: f64,
}

impl<T: Number, P: Dynamics> Wrapper<T, P> for Adapting<T> {
    fn predict(&mut self, inner: &mut dyn Recursion<T, P>, span: Span<'_, T>) {
        self.sample += 1;
        inner.predict(span);
    }

    fn update(&mut self, inner: &mut dyn Recursion<T, P>, readings: Readings<'_, T>) -> UpdateResult<T> {
        let result = inner.update(readings);
        if self.learns_now() {
            let GaussianFilter { noise, update, design, .. } = inner.filter();
            let (innovations, [.., gain]) = (update.innovations(), update.parts());
            let white = design.white.map(|(place, _)| place);
            if self.adaptation.process_noise {
                let has_measured = T::of(0.0).lt(result.measured);
                self.adapt_process(&innovations, gain, has_measured, (&mut noise.matrix, white));
            }
            if self.adaptation.sensor_noise {
                self.adapt_sensors(&innovations, readings.measured, &mut noise.sensors);
            }
        }
        result
    }

    fn report<'a>(&'a self, learnt: &mut Learnt<'a, T>) {
        learnt.uncertainty = Some(&self.uncertainty);
    }
}

impl<T: Number> Adapting<T> {
    /// Where Q is learnt, it becomes a whole matrix.
    pub fn of<P: Dynamics>(
        adaptation: Adaptation,
        filter: &mut GaussianFilter<T, P>,
    ) -> Option<Box<dyn Wrapper<T, P>>> {
        if adaptation.process_noise {
            filter.fill_process_noise();
        }
        let (n, dt) = (filter.belief.size(), filter.design.dt);
        adaptation.is_on().then(|| Box::new(Self::new(adaptation, n, &filter.noise.sensors, dt)) as _)
    }

    pub(crate) fn new(adaptation: Adaptation, n: usize, sensors: &[T], dt: f64) -> Self {
        let uncertainty = mapped(sensors, &|r| adaptation.initial_uncertainty(*r));
        Self { adaptation, uncertainty, shift: vec![T::of(0.0); n], residuals: Residuals::default(), sample: 0, dt }
    }

    pub(crate) fn learns_now(&self) -> bool {
        self.adaptation.is_on() && self.adaptation.learns_at(self.sample, self.dt)
    }

    /// Adapts the lower triangle of Q, n × n, without a white force, by an update with the gain K, n × m.
    pub(crate) fn adapt_process(
        &mut self,
        update: &Innovations<'_, T>,
        gain: &[T],
        has_measured: T::Mask,
        (process, white): (&mut [T], Option<usize>),
    ) {
        let Self { adaptation, shift, .. } = self;
        let (n, keep) = (shift.len(), adaptation.forgetting);
        shift.fill(T::of(0.0));
        for (&e, gain) in update.innovation.iter().zip(gain.chunks_exact(n)) {
            for i in 0..n {
                shift[i] = shift[i] + gain[i] * e;
            }
        }
        for j in 0..n {
            for i in j..n {
                let old = process[j * n + i];
                let learnt = shift[i] * (shift[j] * (1.0 - keep)) + old * keep;
                let is_kept = white == Some(i) || white == Some(j);
                process[j * n + i] = if is_kept { old } else { T::select(has_measured, learnt, old) };
            }
        }
    }

    pub(crate) fn adapt_sensors(&mut self, update: &Innovations<'_, T>, measured: &[T], sensors: &mut [T]) {
        let Self { adaptation, residuals, uncertainty, .. } = self;
        for (&sensor, &residual) in update.sensors.iter().zip(residuals.of(update)) {
            let old = [sensors[sensor], uncertainty[sensor]];
            let [r, variance] = adaptation.learn(old, residual);
            let is_there = measured[sensor].is_number();
            sensors[sensor] = T::select(is_there, r, old[0]);
            uncertainty[sensor] = T::select(is_there, variance, old[1]);
        }
    }
}
