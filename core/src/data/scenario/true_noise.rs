//! The true noise of a scenario, as the settings of a filter express it.

use super::{FilterSettings, Scenario, Values};
use crate::{Channel, Quantity, Signal};

impl Scenario {
    /// The true noise, for a filter's settings: that of the sensors ([`Self::true_sensor_std`]), the effect of the
    /// disturbance in one step, and the root mean square change of the parameters per step.
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

    /// [`Self::true_noise`] for this filter. One that knows of a white force has the disturbance there, and neither in R nor
    /// in the motion.
    pub fn true_noise_for(&self, filter: &FilterSettings) -> (Vec<f64>, Values) {
        let (sensor_std, mut process_std) = self.true_noise();
        if !filter.augment.contains(&Channel::WHITE_FORCE) {
            return (sensor_std, process_std);
        }
        for &channel in self.plant.kind.channels().iter().filter(|channel| !channel.is_parameter()) {
            process_std[channel] = 0.0;
        }
        process_std[Channel::WHITE_FORCE] = self.plant.disturbance_std;
        (self.sensors.iter().map(|s| usable_std(s.measures, s.noise_std)).collect(), process_std)
    }

    /// The standard deviations of the sensors' noise for a filter's settings: the sensor's own noise, and the effect of
    /// the disturbance on its reading, such as that of an accelerometer.
    ///
    /// ```text
    /// R = noise² + (∂h/∂F)² disturbance²
    /// ```
    pub fn true_sensor_std(&self) -> Vec<f64> {
        let model = self.plant.model(self.input);
        let at_rest = vec![0.0; model.size()];
        let felt = |quantity: Quantity| {
            let reading = model.reading(quantity);
            let under = |disturbance| {
                reading.as_ref().map_or(0.0, |reading| model.read_disturbed(reading, &at_rest, 0.0, disturbance))
            };
            (under(1.0) - under(0.0)) * self.plant.disturbance_std
        };
        self.sensors.iter().map(|s| usable_std(s.measures, libm::hypot(s.noise_std, felt(s.measures)))).collect()
    }

    /// The root mean square change of a signal from one sample to the next.
    fn change_per_step(&self, signal: Signal) -> f64 {
        let steps = self.samples() - 1;
        let change = |k: usize| signal.at((k + 1) as f64 * self.dt) - signal.at(k as f64 * self.dt);
        let square: f64 = (0..steps).map(|k| change(k) * change(k)).sum();
        (square / steps.max(1) as f64).sqrt()
    }
}

/// Limits the standard deviation that a filter assumes of a sensor from below, relative to the usual noise of the
/// quantity. A sensor may be perfect, but a filter with R = 0 soon has a singular innovation covariance.
const LEAST_NOISE: f64 = 1e-9;

pub(super) fn usable_std(quantity: Quantity, noise_std: f64) -> f64 {
    noise_std.max(LEAST_NOISE * quantity.aspect().info().usual_noise)
}
