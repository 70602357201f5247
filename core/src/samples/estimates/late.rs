//! The readings of a filter that takes its sensors to be late.

use crate::Record;
use crate::record::Delays;

use super::Estimates;

impl Estimates {
    /// Empty estimates over readings that are `dt` \[s\] apart, or have times of their own: `apart` tells for each sensor how many
    /// samples lie between two of them then. `option` is what makes the filter count in samples.
    pub(crate) fn over(self, apart: Option<&[usize]>, dt: f64, option: Option<&'static str>) -> Self {
        let has_parts = self.delays(dt).sensors.iter().any(|steps| libm::trunc(*steps) != *steps);
        let monitor = match (apart, option) {
            (Some(apart), option) => self.monitor.with_clocks(apart, option),
            (None, Some(option)) if has_parts => self.monitor.with_rounded_delays(option),
            (None, _) => self.monitor,
        };
        Self { monitor, ..self }
    }

    /// The readings of a sensor, by its place among the filter's, as the filter has them: where it takes the sensor to be late, each
    /// sample has the one that tells of it, to the nearest sample. `None` where the record has no such sensor.
    pub fn measured<'a>(&self, record: &'a Record, place: usize) -> Option<impl Fn(usize) -> f64 + Copy + 'a> {
        let quantity = self.sensors.get(place)?;
        let column = record.sensors().iter().position(|own| own == quantity)?;
        let late = self.delays(record.dt()).of(place);
        Some(move |k| record.late_reading(column, k, late))
    }

    /// The delays of the sensors, with `dt` \[s\] between samples.
    fn delays(&self, dt: f64) -> Delays {
        Delays::new(0, self.sensor_delay.iter().map(|late| late / dt))
    }
}
