//! The noise of the truth, as the settings of a filter state it.

use super::{Scenario, Values};
use crate::{Quantity, Signal};

impl Scenario {
    /// The noise that a filter would be told by someone who knows the truth: that of the sensors
    /// ([`Self::true_sensor_std`]), what the disturbance adds in a step, and the root mean square change of the parameters per step.
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

    /// The standard deviations of the sensors' noise, as a filter can use them: their own, and what the disturbance adds to
    /// the reading of a sensor that feels it, such as an accelerometer.
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

/// The least standard deviation that a filter is told of a sensor, in the usual noise of the quantity. A sensor may be
/// perfect, but a filter that is told so has a singular innovation covariance sooner or later.
const LEAST_NOISE: f64 = 1e-9;

pub(super) fn usable_std(quantity: Quantity, noise_std: f64) -> f64 {
    noise_std.max(LEAST_NOISE * quantity.aspect().info().usual_noise)
}
