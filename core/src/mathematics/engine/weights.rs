//! The weights of measurements by a rule, lane by lane.

use super::number::{Mask, Number};
use super::residuals::{Innovations, Residuals};
use crate::mathematics::filter::robust::{FIRST_LEVEL, Misfit, Robust, SETTLED, usual_after};

/// A rule with its memory.
#[derive(Clone, Debug)]
pub(crate) struct Weights<T> {
    rule: Robust,
    /// Of each sensor: the measurement, NaN where its weight is zero, and R over the weight.
    measured: Vec<T>,
    variances: Vec<T>,
    weights: Vec<T>,
    /// Of each sensor: `e² / S` before any weight, and the usual one.
    predicted: Vec<T>,
    usual: Vec<T>,
    residuals: Residuals<T>,
}

impl<T: Number> Weights<T> {
    /// The memory for a rule over some sensors.
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

    /// The most updates by one sample with new weights.
    pub(crate) fn passes(&self) -> usize {
        self.rule.info().passes
    }

    /// The measurements, and the diagonal of R, of all sensors, weighed.
    pub(crate) fn weighed(&self) -> [&[T]; 2] {
        [&self.measured, &self.variances]
    }

    /// The weight of each sensor in the last update; NaN for a sensor without a measurement.
    pub(crate) fn each(&self) -> &[T] {
        &self.weights
    }

    /// Whether a sensor still measures, with whatever weight.
    pub(crate) fn is_there(&self, sensor: usize) -> T::Mask {
        self.measured[sensor].is_number()
    }

    /// The usual misfits, which the next sample goes on from.
    pub(crate) fn usual(&self) -> &[T] {
        &self.usual
    }

    /// Goes back to the usual misfits of an earlier sample.
    pub(crate) fn set_usual(&mut self, usual: &[T]) {
        self.usual.copy_from_slice(usual);
    }

    /// Forgets the weights of the last update.
    pub(crate) fn clear(&mut self) {
        self.weights.fill(T::of(f64::NAN));
    }

    /// Takes in the first update by a sample, in which every measurement counts as its R says. `variances` and `measured` are those
    /// of all sensors.
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

    /// Takes the weights that follow from the last update, but for lanes that have settled. `unweighed` is the diagonal of R of all
    /// sensors. Returns the lanes in which a weight has changed.
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
