//! The true noise of a scenario, as the settings of a filter express it.

use std::f64::consts::TAU;
use std::ops::Range;

use kalmanscope_filters::lists::mapped;
use kalmanscope_filters::{Channel, Quantity};

use super::{FilterSettings, Scenario, Values};
use crate::Signal;
use crate::signal::{Ramp, Sine, Step};

impl Scenario {
    /// The true noise: that of the sensors, the effect of the disturbance in one step, and the parameters' change per step.
    pub fn true_noise(&self) -> (Vec<f64>, Values) {
        let sensor_std = self.true_sensor_std();
        let d = self.plant.disturbance_std;
        let mut process_std = Values::ZERO;
        for &channel in self.plant.model(self.input).channels() {
            if let Some(signal) = self.plant.parameter(channel) {
                process_std[channel] = self.change_per_step(signal);
            } else if let Some(velocity) = channel.rate() {
                process_std[channel] = d * self.dt * self.dt / 2.0;
                process_std[velocity] = d * self.dt;
            }
        }
        (sensor_std, process_std)
    }

    /// [`Self::true_noise`] for this filter: if it knows of a white force, the disturbance is there and nowhere else.
    pub fn true_noise_for(&self, filter: &FilterSettings) -> (Vec<f64>, Values) {
        let (sensor_std, mut process_std) = self.true_noise();
        if !filter.augment.contains(&Channel::WHITE_FORCE) {
            return (sensor_std, process_std);
        }
        for &channel in self.plant.kind.channels().iter().filter(|channel| !channel.is_parameter()) {
            process_std[channel] = 0.0;
        }
        process_std[Channel::WHITE_FORCE] = self.plant.disturbance_std;
        (mapped(&self.sensors, &|s| usable_std(s.measures, s.noise_std)), process_std)
    }

    /// The factor between the true √Q and that of this filter, by σ of velocities. `None` where there is no single one.
    pub fn true_process_scale(&self, filter: &FilterSettings) -> Option<f64> {
        let (_, truth) = self.true_noise_for(filter);
        let channels = self.plant.kind.channels();
        let velocities: Vec<Channel> = channels.iter().filter_map(|channel| channel.rate()).collect();
        let mut scales = velocities.iter().map(|&velocity| truth[velocity] / filter.process_std[velocity]);
        let first = scales.next().filter(|scale| scale.is_finite() && *scale > 0.0)?;
        let mut others = channels.iter().filter(|channel| !velocities.contains(channel) && !filter.knows(**channel));
        let is_in_proportion = scales.all(|scale| (scale / first - 1.0).abs() < ALIKE)
            && others.all(|&channel| first * filter.process_std[channel] <= (1.0 + ALIKE) * truth[channel]);
        is_in_proportion.then_some(first)
    }

    /// The std of the sensors' noise for a filter: their own, and the effect of the disturbance on their readings.
    ///
    /// ```text
    /// R = noise² + (∂h/∂F)² disturbance²
    /// ```
    pub fn true_sensor_std(&self) -> Vec<f64> {
        let model = self.plant.model(self.input);
        let gain = |quantity| self.plant.parameter(Quantity::gain(quantity)).map_or(1.0, |gain| gain.at(0.0));
        let at_rest = model.at_rest(gain);
        let felt = |quantity: Quantity| {
            let reading = model.reading(quantity);
            let under = |disturbance| {
                reading.as_ref().map_or(0.0, |reading| model.read_disturbed(reading, &at_rest, 0.0.into(), disturbance))
            };
            (under(1.0) - under(0.0)) * self.plant.disturbance_std
        };
        mapped(&self.sensors, &|s| usable_std(s.measures, libm::hypot(s.noise_std, felt(s.measures))))
    }

    /// The root mean square change of a signal from one sample to the next. It takes no longer for a longer record.
    fn change_per_step(&self, signal: Signal) -> f64 {
        let steps = self.samples() - 1;
        let change = |k: usize| signal.at((k + 1) as f64 * self.dt) - signal.at(k as f64 * self.dt);
        let sum = |range: Range<usize>| range.map(|k| change(k) * change(k)).sum::<f64>();
        let around = |time: f64| {
            let step = (time / self.dt) as usize;
            [step.saturating_sub(1).min(steps), step.saturating_add(2).min(steps)]
        };
        let squares = match signal {
            Signal::Constant(_) => 0.0,
            Signal::Step(Step { at, .. }) => {
                let [first, end] = around(at);
                sum(first..end)
            }
            Signal::Ramp(Ramp { start, end, .. }) => {
                let ([first, inside], [outside, end]) = (around(start), around(end));
                if outside <= inside {
                    sum(first..end)
                } else {
                    sum(first..inside) + (outside - inside) as f64 * sum(inside..inside + 1) + sum(outside..end)
                }
            }
            Signal::Sine(Sine { amplitude, period, .. }) => {
                // Δ = 2 A sin(θ/2) cos(θ (k + 1/2)), and Σ cos((2k + 1) θ) = sin(2 N θ) / (2 sin θ).
                let (theta, count) = (TAU * self.dt / period, steps as f64);
                let (sin, cos) = (libm::sin(theta), libm::cos(theta));
                let cosines = if sin.abs() < 1e-9 { count * cos } else { libm::sin(2.0 * count * theta) / (2.0 * sin) };
                let largest = 2.0 * amplitude * libm::sin(0.5 * theta);
                largest * largest * 0.5 * (count + cosines).max(0.0)
            }
        };
        (squares / steps.max(1) as f64).sqrt()
    }
}

const ALIKE: f64 = 1e-6;

/// Limits σ of a sensor for a filter from below, relative to its usual noise: with R = 0, S is soon singular.
const LEAST_NOISE: f64 = 1e-9;

pub(super) fn usable_std(quantity: Quantity, noise_std: f64) -> f64 {
    noise_std.max(LEAST_NOISE * quantity.aspect().info().usual_noise)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_change_per_step_is_that_of_all_steps() {
        for (duration, dt) in [(60.0, 0.01), (59.987, 0.013), (5.0, 1.0), (0.03, 0.01)] {
            let scenario = Scenario { duration, dt, ..Scenario::default() };
            for signal in [
                Signal::Constant(5.0),
                Signal::Step(Step { from: 6.0, to: 4.8, at: 30.0 }),
                Signal::Step(Step { from: 6.0, to: 4.8, at: 0.0 }),
                Signal::Step(Step { from: 6.0, to: 4.8, at: 1e300 }),
                Signal::Ramp(Ramp { from: 6.0, to: 4.8, start: 10.0, end: 30.0 }),
                Signal::Ramp(Ramp { from: 6.0, to: 4.8, start: 10.003, end: 10.0171 }),
                Signal::Ramp(Ramp { from: 6.0, to: 4.8, start: 0.0, end: 1e6 }),
                Signal::Ramp(Ramp { from: 6.0, to: 4.8, start: 20.0, end: 20.0 }),
                Signal::Sine(Sine { mean: 6.0, amplitude: 1.0, period: 20.0 }),
                Signal::Sine(Sine { mean: 6.0, amplitude: 1.0, period: 0.0137 }),
                Signal::Sine(Sine { mean: 6.0, amplitude: 1.0, period: 2.0 * dt }),
                Signal::Sine(Sine { mean: 6.0, amplitude: 1.0, period: 1e9 }),
            ] {
                let steps = scenario.samples() - 1;
                let change = |k: usize| signal.at((k + 1) as f64 * dt) - signal.at(k as f64 * dt);
                let squares: f64 = (0..steps).map(|k| change(k) * change(k)).sum();
                let (found, expected) = (scenario.change_per_step(signal), (squares / steps as f64).sqrt());
                assert!(
                    (found - expected).abs() <= 1e-9 * expected + 1e-11,
                    "{signal:?}, {dt}: {found} for {expected}"
                );
            }
        }
    }
}
