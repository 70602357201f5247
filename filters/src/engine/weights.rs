//! Measurements against the state after an update, and their weights by a rule, lane by lane.

use super::columns::divide;
use super::number::{Mask, Number};
use crate::engine::robust::{FIRST_LEVEL, Misfit, Robust, SETTLED, usual_after};

#[derive(Clone, Copy, Debug)]
pub(crate) struct Innovations<'a, T> {
    /// The place of each measurement's sensor among all sensors.
    pub(crate) sensors: &'a [usize],
    /// e, m numbers.
    pub(crate) innovation: &'a [T],
    /// S, m × m, and its [factor](super::columns::factor).
    pub(crate) innovation_cov: &'a [T],
    pub(crate) factor: &'a [T],
    pub(crate) variances: &'a [T],
}

/// For each measurement, the residual of the linearised sensor and the variance that the state's own uncertainty gives it.
///
/// ```text
/// ε = R S⁻¹ e,  H P⁺ Hᵀ = R - R S⁻¹ R
/// ```
#[derive(Clone, Debug)]
pub(crate) struct Residuals<T> {
    each: Vec<[T; 2]>,
    inverse: Vec<T>,
}

impl<T> Default for Residuals<T> {
    fn default() -> Self {
        Self { each: Vec::new(), inverse: Vec::new() }
    }
}

impl<T: Number> Residuals<T> {
    pub(crate) fn of(&mut self, update: &Innovations<'_, T>) -> &[[T; 2]] {
        let Self { each, inverse } = self;
        let Innovations { innovation, factor, variances, .. } = *update;
        let m = innovation.len();
        inverse.clear();
        inverse.extend((0..m * m).map(|at| T::of(if at % (m + 1) == 0 { 1.0 } else { 0.0 })));
        divide(factor, m, inverse, m);
        each.clear();
        for (row, &r) in variances.iter().enumerate() {
            let mut white = T::of(0.0);
            for (k, &e) in innovation.iter().enumerate() {
                white = white + inverse[k * m + row] * e;
            }
            each.push([r * white, (r - r * r * inverse[row * m + row]).max(T::of(0.0))]);
        }
        each
    }
}

#[derive(Clone, Debug)]
pub(crate) struct Weights<T> {
    pub(super) rule: Robust,
    /// Of each sensor: the measurement, NaN where its weight is zero, and R over the weight.
    pub(super) measured: Vec<T>,
    pub(super) variances: Vec<T>,
    /// The weight of each sensor in the last update; NaN for a sensor without a measurement.
    pub(super) weights: Vec<T>,
    /// Of each sensor: `e² / S` before any weight, and the usual one, which the next sample begins with.
    predicted: Vec<T>,
    pub(super) usual: Vec<T>,
    residuals: Residuals<T>,
}

impl<T: Number> Weights<T> {
    pub(crate) fn new(rule: Robust, sensors: usize) -> Self {
        let numbers = |number: f64| vec![T::of(number); sensors];
        Self {
            rule,
            measured: numbers(f64::NAN),
            variances: numbers(1.0),
            weights: numbers(f64::NAN),
            predicted: numbers(0.0),
            usual: numbers(FIRST_LEVEL),
            residuals: Residuals::default(),
        }
    }

    pub(crate) fn clear(&mut self) {
        self.weights.fill(T::of(f64::NAN));
    }

    /// By the first update, in which each measurement counts as its R says. `variances` and `measured` are of all sensors.
    pub(crate) fn begin(&mut self, update: &Innovations<'_, T>, variances: &[T], measured: &[T]) {
        self.clear();
        self.measured.fill(T::of(f64::NAN));
        self.variances.copy_from_slice(variances);
        let m = update.sensors.len();
        for (row, &sensor) in update.sensors.iter().enumerate() {
            let (value, e, usual) = (measured[sensor], update.innovation[row], self.usual[sensor]);
            let (is_there, predicted) = (value.is_number(), e * e / update.innovation_cov[row * m + row]);
            let next = T::from_lanes(|lane| usual_after(usual.lane(lane), predicted.lane(lane)));
            self.measured[sensor] = value;
            self.weights[sensor] = T::select(is_there, T::of(1.0), T::of(f64::NAN));
            self.predicted[sensor] = predicted;
            self.usual[sensor] = T::select(is_there, next, usual);
        }
    }

    /// Settled lanes keep theirs. `unweighed` is the diagonal of R of all sensors. Returns the lanes with a changed weight.
    pub(crate) fn weigh(&mut self, update: &Innovations<'_, T>, unweighed: &[T], settled: T::Mask) -> T::Mask {
        let Self { rule, measured, variances, weights, predicted, usual, residuals } = self;
        let mut changed = T::Mask::of(false);
        for (&sensor, &[residual, uncertainty]) in update.sensors.iter().zip(residuals.of(update)) {
            let r = unweighed[sensor];
            let (residual, uncertainty) = (residual * residual / r, uncertainty / r);
            let is_weighed = measured[sensor].is_number() & !settled;
            let weight = T::from_lanes(|lane| {
                let misfit = Misfit {
                    predicted: predicted[sensor].lane(lane),
                    residual: residual.lane(lane),
                    uncertainty: uncertainty.lane(lane),
                };
                if is_weighed.lane(lane) { rule.weight(misfit, usual[sensor].lane(lane)) } else { f64::NAN }
            });
            // A sensor without noise has no misfit to weigh by.
            let is_weighed = is_weighed & weight.is_finite() & T::of(0.0).lt(r);
            let old = weights[sensor];
            changed = changed | (is_weighed & (old * SETTLED).lt((weight - old).abs()));
            weights[sensor] = T::select(is_weighed, weight, old);
        }
        for &sensor in update.sensors {
            let (weight, nan) = (weights[sensor], T::of(f64::NAN));
            variances[sensor] = T::select(changed, unweighed[sensor] / weight, variances[sensor]);
            measured[sensor] = T::select(changed & weight.le(T::of(0.0)), nan, measured[sensor]);
        }
        changed
    }
}
