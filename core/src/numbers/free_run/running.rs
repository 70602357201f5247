//! A free run under way, a piece after the other.

use std::ops::Range;

use super::beginning::{Beginning, CHUNK, Course};
use super::{FreeRun, Identified, fit};
use crate::Record;
use crate::mathematics::lists::mapped;
use crate::mathematics::model::Reading;
use crate::samples::simulate::response::HALVED;

/// A free run under way. The record is the same in all calls; the result does not depend on how the work is divided.
pub struct Running {
    identified: Identified,
    part: Range<usize>,
    readings: Vec<Option<Reading>>,
    /// The samples at which the motion begins anew, and the end of the part, in falling order.
    ends: Vec<usize>,
    beginning: Beginning,
    fitted: Vec<Range<usize>>,
    /// The motion at the next sample, once the motion at the beginning is fitted.
    course: Option<Course>,
    predicted: Vec<Vec<f64>>,
    done: usize,
}

impl Running {
    pub(super) fn new(identified: Identified, record: &Record, part: Range<usize>) -> Self {
        let end = part.end.min(record.len());
        let part = part.start.min(end)..end;
        let readings: Vec<Option<Reading>> = mapped(record.sensors(), &|&q| identified.model.reading(q));
        let mut ends: Vec<usize> = mapped(&identified.plucks, &|time| after(record, *time));
        ends.retain(|end| *end > part.start && *end < part.end);
        ends.push(part.end);
        ends.reverse();
        let first = part.start..ends.last().copied().unwrap_or(part.end);
        let beginning = Beginning::new(&identified, record, &first, &readings);
        let predicted = vec![Vec::with_capacity(part.len()); readings.len()];
        Self { identified, part, readings, ends, beginning, fitted: Vec::new(), course: None, predicted, done: 0 }
    }

    /// Goes on until `while_time` returns false, which is called after each piece of about a millisecond. Returns whether
    /// all samples are done.
    pub fn advance(&mut self, record: &Record, while_time: &mut dyn FnMut() -> bool) -> bool {
        while self.done < self.part.len() {
            match &self.course {
                Some(_) => self.piece(record),
                None if self.beginning.advance(&self.identified, record, &self.readings) => {
                    self.course = Some(Course::new(&self.identified, &self.beginning.motion));
                    self.fitted.push(self.beginning.part.clone());
                }
                None => {}
            }
            if !while_time() {
                break;
            }
        }
        self.done >= self.part.len()
    }

    fn piece(&mut self, record: &Record) {
        let Self { identified, part, readings, ends, beginning, course: at, predicted, done, .. } = self;
        let Some(course) = at else { return };
        let leg = ends.last().map_or(part.len(), |end| end - part.start);
        let samples = (*done + CHUNK).min(leg);
        let end = course.halved() + HALVED;
        while *done < samples && course.halved() < end {
            let k = part.start + *done;
            let Some(state) = course.state() else {
                // The model has run away: no prediction follows, until the motion begins anew.
                *done = leg;
                break;
            };
            for (column, reading) in
                predicted.iter_mut().zip(readings.iter()).filter(|(column, _)| column.len() == *done)
            {
                column.push(identified.read(reading.as_ref(), state, record, k));
            }
            *done += usize::from(course.advance(identified, record, k, end - course.halved()));
        }
        if *done == leg && *done < part.len() {
            ends.pop();
            let next = part.start + leg..ends.last().copied().unwrap_or(part.end);
            *beginning = Beginning::new(identified, record, &next, readings);
            *at = None;
            predicted.iter_mut().for_each(|column| column.resize(leg, f64::NAN));
        }
    }

    /// The share that is done, from 0 to 1.
    pub fn progress(&self) -> f64 {
        self.done as f64 / self.part.len().max(1) as f64
    }

    /// The free run, as far as it is done.
    pub fn finish(self, record: &Record) -> FreeRun {
        let Self { identified, part, readings, fitted: all, mut predicted, .. } = self;
        predicted.iter_mut().for_each(|column| column.resize(part.len(), f64::NAN));
        let fitted = all.first().map_or(0, ExactSizeIterator::len);
        let fits = (0..readings.len()).map(|sensor| {
            readings[sensor].as_ref()?;
            let mut measured: Vec<f64> = part.clone().map(|k| identified.measured(record, sensor, k)).collect();
            for samples in &all {
                measured[samples.start - part.start..samples.end - part.start].fill(f64::NAN);
            }
            fit(&measured[fitted..], &predicted[sensor][fitted..])
        });
        FreeRun { fits: fits.collect(), fitted, predicted, part }
    }
}

/// The first sample after a time \[s\].
fn after(record: &Record, time: f64) -> usize {
    let k = libm::ceil((time - record.time(0)) / record.dt()).clamp(0.0, record.len() as f64) as usize;
    if k < record.len() && record.time(k) <= time { k + 1 } else { k }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::simulate::Simulator;
    use crate::{Pass, Scenario};

    #[test]
    fn the_fit_of_a_beginning_that_is_hard_to_follow_is_divided() {
        let text = include_str!("../../../../tests/hostile/hard-truth.toml").replace("plant = \"sdof\"\n", "");
        let scenario = Scenario { duration: 2.0, ..Scenario::from_toml(&text.replace("\"kf\"", "\"ekf\"")).unwrap() };
        let mut simulator = Simulator::new(&scenario);
        let mut record = simulator.empty_record();
        (0..20).for_each(|_| assert!(simulator.step(&mut record)));
        let mut estimates = Pass::history(&scenario, 0).unwrap();
        Pass::new(&scenario, 0, &record).unwrap().follow(&record, 1, &mut estimates);
        let mut model = Identified::at(&scenario, &scenario.filters[0], &estimates, 0);
        for (place, channel) in estimates.channels().iter().enumerate() {
            model.values[place] = record.truth(*channel).unwrap()[0];
        }
        let mut running = model.running(&record, 0..record.len());
        let mut pieces = 0;
        while running.course.is_none() {
            assert!(!running.advance(&record, &mut || false));
            pieces += 1;
        }
        // Each error of ten samples halves steps ten thousand times.
        assert!(pieces > 50, "{pieces}");
        while !running.advance(&record, &mut || false) {}
        assert_eq!(running.finish(&record), model.run(&record, 0..record.len()));
    }
}
