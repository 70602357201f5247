//! Constant parts of input and readings.

use super::{Suggestion, moments};
use crate::data::import::Offset;
use crate::{Channel, Record};

/// A mean of the input counts as an offset if it is this many times its standard error.
const CERTAIN: f64 = 4.0;

/// A mean of a sensor's readings is an offset if it is larger than this share of their spread.
const OFFSET: f64 = 0.5;

impl Suggestion {
    /// A constant part of input and displacement says nothing about the motion, but bends every estimate.
    pub(super) fn remove_means(&mut self, record: &mut Record) {
        if self.scenario.record.is_none() {
            self.expect_means(record);
            return;
        }
        let Some(mapping) = &mut self.scenario.record else { return };
        let mut removed = Vec::new();
        let (mean, std) = moments(record.input());
        // A random force has a small mean too, and its effect on the displacement is motion.
        let chance = std / libm::sqrt(record.len().max(1) as f64);
        if let Some(input) = mapping.input.as_mut().filter(|input| input.offset == Offset::default())
            && mean.abs() > CERTAIN * chance
        {
            input.offset = Offset::MEAN;
            record.change_input(|value| value - mean);
            removed.push("the input".to_owned());
        }
        for sensor in 0..record.sensors().len() {
            let quantity = record.sensors()[sensor];
            let (mean, std) = moments(record.measured(sensor));
            let Some(column) = mapping.sensors.get_mut(&quantity) else { continue };
            if column.offset == Offset::default() && (!removed.is_empty() || mean.abs() > OFFSET * std) {
                column.offset = Offset::MEAN;
                record.change_measured(sensor, |value| value - mean);
                removed.push(format!("the {}", quantity.name()));
            }
        }
        if !removed.is_empty() {
            let what = removed.join(" and ");
            self.reasons.push(format!("the mean of {what} is removed: a constant part is no motion"));
        }
    }

    /// The same for a record without a mapping, which stays unchanged: instead the filters get the offsets as known
    /// constants.
    fn expect_means(&mut self, record: &mut Record) {
        let mut expected = Vec::new();
        let (mean, std) = moments(record.input());
        let chance = std / libm::sqrt(record.len().max(1) as f64);
        if std > 0.0 && mean.abs() > CERTAIN * chance {
            record.change_input(|value| value - mean);
            expected.push((Channel::INPUT_OFFSET, -mean, "the input".to_owned()));
        }
        for sensor in 0..record.sensors().len() {
            let quantity = record.sensors()[sensor];
            let (mean, std) = moments(record.measured(sensor));
            let is_sensor = self.scenario.sensors.iter().any(|one| one.measures == quantity);
            if is_sensor && (!expected.is_empty() || mean.abs() > OFFSET * std) {
                record.change_measured(sensor, |value| value - mean);
                expected.push((quantity.bias(), mean, format!("the {}", quantity.name())));
            }
        }
        for filter in self.filters() {
            for &(channel, mean, _) in &expected {
                if !filter.augment.contains(&channel) {
                    filter.augment.push(channel);
                }
                filter.initial_mean[channel] = mean;
                (filter.initial_std[channel], filter.process_std[channel]) = (0.0, 0.0);
            }
        }
        if !expected.is_empty() {
            let what: Vec<String> = expected.into_iter().map(|(.., what)| what).collect();
            let what = what.join(" and ");
            self.reasons
                .push(format!("the filters take the mean of {what} for an offset: a constant part is no motion"));
        }
    }
}
