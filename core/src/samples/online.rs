//! One filter of a scenario over samples that come in one by one.

use crate::samples::sink::Sink;
use crate::{Pass, Record, RunError, Scenario};

/// A [`Pass`] over a record that grows: a sample comes in, an estimate goes out, with the bits of a pass over the whole record.
///
/// Samples follow each other after dt; of one that is lost, the readings are NaN. Clocks with gaps, and sensors with clocks of their
/// own, are for [`EventFilter`](crate::EventFilter). Where the input or a sensor is late by d samples, the estimate of a sample comes
/// with the d-th after it.
pub struct OnlineFilter {
    pass: Pass,
    /// The samples that the filter has yet to read, and some before them.
    record: Record,
    /// The samples after the one that it filters, and before it, that it reads.
    reach: [usize; 2],
}

/// Forgets samples only when there are this many, since forgetting moves all others.
const FORGET: usize = 64;

impl OnlineFilter {
    /// The filter at `place` of a scenario, before its first sample.
    ///
    /// # Errors
    /// Those of [`Pass::new`].
    pub fn new(scenario: &Scenario, place: usize) -> Result<Self, RunError> {
        let sensors = scenario.measured();
        let record = Record::empty(scenario.dt, scenario.input, scenario.hold, sensors, Vec::new());
        let pass = Pass::new(scenario, place, &record)?;
        let delays = scenario.filters[place].delays(scenario.dt);
        Ok(Self { pass, record, reach: [delays.lookahead(), delays.reach()] })
    }

    /// The pass, which says how many samples are done, and where and why the filter has stopped.
    pub fn pass(&self) -> &Pass {
        &self.pass
    }

    /// Takes in the input \[m/s²\] in the scenario's meaning, and a reading for each of its sensors in the unit of its quantity, NaN
    /// where one is missing.
    ///
    /// # Panics
    /// Panics where there is not one reading for each sensor.
    pub fn step(&mut self, input: f64, readings: &[f64], sink: &mut dyn Sink) {
        let Self { pass, record, reach: [after, before] } = self;
        assert_eq!(readings.len(), record.sensors().len(), "a reading for each sensor");
        record.push(input, readings.iter().copied(), []);
        pass.follow(record, (record.forgotten() + record.len()).saturating_sub(*after), sink);
        let read = pass.done().saturating_sub(record.forgotten() + *before + 1);
        if read >= FORGET {
            record.forget(read);
        }
    }

    /// Computes the last samples as a record does at its end, where the last input holds from then on.
    pub fn finish(&mut self, sink: &mut dyn Sink) {
        self.pass.follow(&self.record, usize::MAX, sink);
    }
}
