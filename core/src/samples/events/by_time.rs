//! Readings of sensors that are late, at the times that they tell of.

use super::{EventFilter, SAME};

impl EventFilter {
    /// The readings that tell of this time \[s\], and those of late or early sensors, each with the time that it tells of. What tells of a
    /// time before the first event does not count, as no reading of the first does.
    pub(super) fn by_time(&self, time: f64, readings: &[f64]) -> (Vec<f64>, Vec<(f64, Vec<f64>)>) {
        let (mut own, mut others) = (readings.to_vec(), Vec::new());
        let first = if self.first.is_finite() { self.first } else { time };
        for (place, late) in self.sensor_delay.iter().enumerate().filter(|(_, late)| **late != 0.0) {
            let reading = std::mem::replace(&mut own[place], f64::NAN);
            let then = time - late;
            if !reading.is_nan() && then > first + SAME * self.scenario.dt {
                let mut alone = vec![f64::NAN; readings.len()];
                alone[place] = reading;
                others.push((then, alone));
            }
        }
        (own, others)
    }
}
