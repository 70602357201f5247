//! The noise that a filter learns from its updates.

use super::Adaptation;
use crate::engine::number::Number;
use crate::engine::weights::{Innovations, Residuals};
use crate::lists::mapped;

#[derive(Clone, Debug)]
pub(crate) struct Learning<T> {
    pub(crate) adaptation: Adaptation,
    pub(crate) uncertainty: Vec<T>,
    /// K e
    shift: Vec<T>,
    residuals: Residuals<T>,
    /// The sample, and the time between samples \[s\].
    pub(crate) sample: usize,
    dt: f64,
}

impl<T: Number> Learning<T> {
    pub(crate) fn learns_now(&self) -> bool {
        self.adaptation.is_on() && self.adaptation.learns_at(self.sample, self.dt)
    }

    pub(crate) fn new(adaptation: Adaptation, n: usize, sensors: &[T], dt: f64) -> Self {
        let uncertainty = mapped(sensors, &|r| adaptation.initial_uncertainty(*r));
        Self { adaptation, uncertainty, shift: vec![T::of(0.0); n], residuals: Residuals::default(), sample: 0, dt }
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
