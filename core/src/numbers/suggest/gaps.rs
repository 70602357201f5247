//! Readings that are lost, filled by a filter for the spectra: windows then need not avoid them.

use super::spectra::stride;
use super::{Suggestion, motion_sensor};
use crate::{Record, Run, Scenario};

/// Limits the samples of a record that is filled; longer ones have windows enough between their gaps.
const MOST: usize = 1 << 18;
/// The share of the readings that must be there.
const THERE: f64 = 0.75;
/// The process noise of the filter, as a share of the motion's size a step.
const SHARE: f64 = 1e-3;
/// Limits the innovations of a filter with usable predictions, as a share of the readings' size.
const KNOWN: f64 = 0.5;

/// The places of a record's lost readings, sensor by sensor.
#[derive(Clone, Debug)]
pub(super) struct Lost(Vec<Vec<usize>>);

impl Lost {
    /// The gaps of a record that can be filled. `None` if nothing is lost, or too much.
    pub(super) fn of(record: &Record) -> Option<Self> {
        let columns = (0..record.sensors().len()).map(|sensor| record.measured(sensor));
        let lost = columns.map(|column| {
            let lost: Vec<usize> = (0..column.len()).filter(|&k| column[k].is_nan()).collect();
            let is_small = stride(column) == 1 && lost.len() as f64 <= (1.0 - THERE) * column.len() as f64;
            is_small.then_some(lost)
        });
        let lost = lost.collect::<Option<Vec<_>>>()?;
        (record.len() <= MOST && lost.iter().any(|lost| !lost.is_empty())).then_some(Self(lost))
    }

    /// The share of a sensor's readings that are not lost.
    pub(super) fn there(&self, sensor: usize, samples: usize) -> f64 {
        let lost = self.0.get(sensor).map_or(0, Vec::len);
        1.0 - lost as f64 / samples.max(1) as f64
    }

    /// Sets the lost readings to NaN again.
    pub(super) fn lose(&self, record: &mut Record) {
        for (sensor, lost) in self.0.iter().enumerate() {
            lost.iter().for_each(|&k| record.measured_mut(sensor)[k] = f64::NAN);
        }
    }

    /// The raw record with each lost reading replaced by the prediction of the first filter in a run over the
    /// conditioned record. `None` if that filter does not follow the motion.
    pub(super) fn filled(&self, run: &Run, raw: &Record) -> Option<Record> {
        let (scenario, record) = (run.scenario(), run.record());
        let (settings, estimates) = (scenario.filters.first()?, run.estimates().first()?);
        if estimates.stop().is_some() || estimates.len() < record.len() {
            return None;
        }
        let (quantity, measured) = motion_sensor(record)?;
        let place = scenario.sensors.iter().position(|sensor| sensor.measures == quantity)?;
        let half = estimates.len() / 2..estimates.len();
        let square = |values: &mut dyn Iterator<Item = f64>| -> f64 {
            values.filter(|value| !value.is_nan()).map(|value| value * value).sum()
        };
        let innovations = square(&mut half.clone().map(|k| estimates.innovation(k)[place]));
        let (mean, _) = super::moments(measured);
        if innovations >= KNOWN * KNOWN * square(&mut half.map(|k| measured[k] - mean)) {
            return None;
        }
        let model = settings.model(scenario.plant.kind, scenario.input);
        let mut filled = raw.clone();
        for (sensor, lost) in self.0.iter().enumerate().filter(|(_, lost)| !lost.is_empty()) {
            let reading = model.reading(raw.sensors()[sensor])?;
            // The conditioned record may lack a mean.
            let there = (0..raw.len()).find(|&k| !raw.measured(sensor)[k].is_nan())?;
            let offset = raw.measured(sensor)[there] - record.measured(sensor)[there];
            for &k in lost {
                let (state, _) = model.to_state(estimates.mean(k));
                let force = record.delayed_force(k, settings.input_delay);
                let expected = model.read(&reading, state.as_slice(), force) + offset;
                filled.measured_mut(sensor)[k] = if expected.is_finite() { expected } else { f64::NAN };
            }
        }
        Some(filled)
    }
}

impl Suggestion {
    /// The scenario of a filter that fills gaps.
    pub(super) fn filling(&self) -> Scenario {
        self.with_share(SHARE)
    }

    /// Whether such a filter can know the motion.
    pub(super) fn can_fill(&self) -> bool {
        self.is_guessed && self.has_frequency()
    }
}
