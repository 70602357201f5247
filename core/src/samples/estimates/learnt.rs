//! What a filter has learnt of noise, and how it weighs readings.

use super::Estimates;

impl Estimates {
    /// Whether the filter weighs its readings.
    pub fn weighs(&self) -> bool {
        self.weighs
    }

    /// Whether the filter learns R.
    pub fn learns_sensor_noise(&self) -> bool {
        self.learns
    }

    /// The standard deviation of a sensor's noise that the filter has learnt by sample `k`, in the sensor's unit, and the standard
    /// deviation of that number: `√R` and `√var R / (2 √R)`. `None` for a filter that does not learn R.
    pub fn sensor_noise(&self, k: usize, sensor: usize) -> Option<[f64; 2]> {
        let m = self.sensors.len();
        let of_sample = self.learnt.get(2 * m * k..2 * m * (k + 1))?;
        let [std, spread] = [*of_sample.get(sensor)?, of_sample[m + sensor]].map(f64::sqrt);
        Some([std, if std > 0.0 { spread / (2.0 * std) } else { 0.0 }])
    }

    /// Whether the filter tells how large Q is ([`FilterSettings::process_scales`](crate::FilterSettings::process_scales)).
    pub fn tells_process_scale(&self) -> bool {
        self.scales
    }

    /// Mean and standard deviation of ln s at sample `k`, where s is the factor between √Q and the √Q of the settings. `None` for a filter
    /// with one scale of Q.
    pub fn process_scale(&self, k: usize) -> Option<[f64; 2]> {
        let &[mean, std] = self.process_scale.get(2 * k..2 * (k + 1))? else { return None };
        Some([mean, std])
    }

    /// The weight of each sensor's reading at sample `k`, from 0 for none to about 1, and NaN where it measured nothing; empty for a
    /// filter that weighs none.
    pub fn weights(&self, k: usize) -> &[f64] {
        let m = self.sensors.len();
        self.weights.get(k * m..(k + 1) * m).unwrap_or(&[])
    }
}
