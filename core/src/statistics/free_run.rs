//! Free runs: an identified model over a record, without using its measurements.

use std::ops::Range;

use kalmanscope_filters::linalg::{Ldl, Matrix, Vector};
use kalmanscope_filters::lists::{mapped, numbers};
use kalmanscope_filters::{Channel, Hold, Quantity, Reading};
use kalmanscope_records::Record;

use crate::run::simulate::response::{HALVED, Response};
use crate::{Estimates, FilterSettings, Model, Scenario};

/// A model with all its parameters known, as a filter has identified it.
///
/// An unknown or a white force is no part of it, and its parameters do not decay.
#[derive(Clone, Debug)]
pub struct Identified {
    model: Model,
    /// One value for each channel of the model, in the channel's unit.
    values: Vec<f64>,
    input_delay: i32,
    /// The sensors that the filter takes to be late, with the time \[s\].
    late: Vec<(Quantity, f64)>,
    /// The times at which its motion begins again \[s\].
    plucks: Vec<f64>,
}

/// The free run of a model over a part of a record.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeRun {
    /// The samples of the part.
    pub part: Range<usize>,
    /// The samples at the beginning from which the motion was fitted; they do not count in the fits, and those after a pluck neither.
    pub fitted: usize,
    /// The predicted readings of each of the record's sensors over the part; NaN where the model lacks one or has run away.
    pub predicted: Vec<Vec<f64>>,
    /// The fit to each sensor's measurements. `None` if there is nothing to compare.
    pub fits: Vec<Option<Fit>>,
}

impl Identified {
    /// The model as a filter knows it at sample `k` of those that are kept.
    pub fn at(scenario: &Scenario, settings: &FilterSettings, estimates: &Estimates, k: usize) -> Self {
        Self::over(scenario, settings, estimates, k..k + 1)
    }

    /// The model with the mean of a filter's estimates over some samples, which are not empty.
    pub fn over(scenario: &Scenario, settings: &FilterSettings, estimates: &Estimates, samples: Range<usize>) -> Self {
        let mut values = vec![0.0; estimates.channels().len()];
        let share = 1.0 / samples.len().max(1) as f64;
        for k in samples {
            values.iter_mut().zip(estimates.mean(k)).for_each(|(sum, value)| *sum += share * value);
        }
        let model = settings.model(&scenario.plant.kind, scenario.input).decaying(0.0);
        for place in [Channel::UNKNOWN_FORCE, Channel::WHITE_FORCE].into_iter().filter_map(|force| model.place(force)) {
            values[place] = 0.0;
        }
        let quantities = scenario.sensors.iter().map(|sensor| sensor.measures);
        let late = quantities.zip(settings.sensor_delay.iter().copied()).collect();
        Self { model, values, input_delay: settings.input_delay, late, plucks: settings.plucks.clone() }
    }

    fn measured(&self, record: &Record, sensor: usize, k: usize) -> f64 {
        let quantity = record.sensors()[sensor];
        let late = self.late.iter().find(|(own, _)| *own == quantity).map_or(0.0, |(_, late)| late / record.dt());
        record.late_reading(sensor, k, late)
    }

    /// Runs over the samples of `part`; its beginning, and that after a pluck, is fitted to the next fifty readings.
    ///
    /// Source of the fit: Nocedal and Wright (2006), *Numerical Optimization*, section 10.3 (Gauss and Newton).
    pub fn run(&self, record: &Record, part: Range<usize>) -> FreeRun {
        let mut running = self.running(record, part);
        running.advance(record, &mut || true);
        running.finish(record)
    }

    /// The same, before its first piece.
    pub fn running(&self, record: &Record, part: Range<usize>) -> Running {
        let identified = self.clone();
        let end = part.end.min(record.len());
        let part = part.start.min(end)..end;
        let readings: Vec<Option<Reading>> = mapped(record.sensors(), &|&q| identified.model.reading(q));
        let mut ends: Vec<usize> = mapped(&identified.plucks, &|time| after(record, *time));
        ends.retain(|end| *end > part.start && *end < part.end);
        ends.push(part.end);
        ends.reverse();
        let first = part.start..ends.last().copied().unwrap_or(part.end);
        let beginning = StartState::new(&identified, record, &first, &readings);
        let predicted = vec![Vec::with_capacity(part.len()); readings.len()];
        Running { identified, part, readings, ends, beginning, fitted: Vec::new(), course: None, predicted, done: 0 }
    }

    fn read(&self, reading: Option<&Reading>, state: &[f64], record: &Record, k: usize) -> f64 {
        let force = record.delayed_force(k, self.input_delay);
        reading.map_or(f64::NAN, |reading| self.model.read(reading, state, force))
    }
}

impl FreeRun {
    /// The fit to a quantity's measurements.
    pub fn fit(&self, record: &Record, quantity: Quantity) -> Option<Fit> {
        let place = quantity.place_in(record.sensors())?;
        self.fits[place]
    }
}

/// The agreement of predictions with measurements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// Root of the mean square error, in the sensor's unit; infinite where the model has run away.
    pub rms: f64,
    /// `100 (1 - |z - ẑ| / |z - mean z|)` \[%\]: 100 for no error, 0 for a model that is no better than the mean.
    ///
    /// Source: Ljung (1999), *System Identification: Theory for the User*, section 16.4.
    pub percent: f64,
    /// The number of measurements that were compared.
    pub readings: usize,
}

/// The agreement of predictions with measurements. Missing measurements do not count.
pub fn fit(measured: &[f64], predicted: &[f64]) -> Option<Fit> {
    let pairs = || measured.iter().zip(predicted).filter(|(measured, _)| !measured.is_nan());
    let readings = pairs().count();
    if readings == 0 {
        return None;
    }
    let mean = pairs().map(|(measured, _)| measured).sum::<f64>() / readings as f64;
    let (mut error, mut spread) = (0.0, 0.0);
    for (measured, predicted) in pairs() {
        error += (measured - predicted) * (measured - predicted);
        spread += (measured - mean) * (measured - mean);
    }
    if error.is_nan() {
        error = f64::INFINITY;
    }
    let percent = if spread > 0.0 { 100.0 * (1.0 - libm::sqrt(error / spread)) } else { f64::NAN };
    Some(Fit { rms: libm::sqrt(error / readings as f64), percent, readings })
}

/// The errors of a filter's predictions one step ahead over a part, if there is something to compare.
pub fn one_step(estimates: &Estimates, record: &Record, sensor: usize, part: Range<usize>) -> Option<Fit> {
    let quantity = *record.sensors().get(sensor)?;
    let place = quantity.place_in(estimates.sensors())?;
    let end = part.end.min(estimates.len()).min(record.len());
    let part = part.start.min(end)..end;
    let all = estimates.measured(record, place)?;
    let measured: Vec<f64> = part.clone().map(all).collect();
    let predicted: Vec<f64> = part.clone().map(|k| all(k) - estimates.innovation(k)[place]).collect();
    let skip = predicted.iter().zip(&measured).take_while(|(p, m)| p.is_nan() && !m.is_nan()).count();
    fit(&measured[skip..], &predicted[skip..])
}

/// A free run under way. The record is the same in all calls; the result does not depend on how the work is divided.
pub struct Running {
    identified: Identified,
    part: Range<usize>,
    readings: Vec<Option<Reading>>,
    /// The samples at which the motion begins again, and the end of the part, in falling order.
    ends: Vec<usize>,
    beginning: StartState,
    fitted: Vec<Range<usize>>,
    course: Option<InputCourse>,
    predicted: Vec<Vec<f64>>,
    done: usize,
}

impl Running {
    /// Continues until `while_time`, called after each piece of about a millisecond, is false. Returns whether all is done.
    pub fn advance(&mut self, record: &Record, while_time: &mut dyn FnMut() -> bool) -> bool {
        while self.done < self.part.len() {
            match &self.course {
                Some(_) => self.piece(record),
                None if self.beginning.advance(&self.identified, record, &self.readings) => {
                    self.course = Some(InputCourse::new(&self.identified, &self.beginning.motion));
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
        course.go_on(identified, record, part.start..part.start + leg, done, &mut |k, state| {
            for (column, reading) in predicted.iter_mut().zip(readings.iter()) {
                column.push(identified.read(reading.as_ref(), state, record, k));
            }
        });
        if *done == leg && *done < part.len() {
            ends.pop();
            let next = part.start + leg..ends.last().copied().unwrap_or(part.end);
            *beginning = StartState::new(identified, record, &next, readings);
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

fn after(record: &Record, time: f64) -> usize {
    let k = libm::ceil((time - record.time(0)) / record.dt()).clamp(0.0, record.len() as f64) as usize;
    if k < record.len() && record.time(k) <= time { k + 1 } else { k }
}

const BEGINNING: usize = 50;

/// Limits the iterations of the fit; for a linear plant the first is exact.
const ITERATIONS: usize = 8;

struct StartState {
    part: Range<usize>,
    /// A size of each sensor's readings, so that those of all sensors count alike.
    scales: Vec<f64>,
    motion: Vec<f64>,
    rows: usize,
    error: Option<Vector>,
    columns: Vec<Vector>,
    iterations: usize,
    trial: FitTrial,
}

struct FitTrial {
    motion: Vec<f64>,
    course: InputCourse,
    done: usize,
    errors: Vec<f64>,
}

impl FitTrial {
    fn new(identified: &Identified, motion: Vec<f64>) -> Self {
        Self { course: InputCourse::new(identified, &motion), motion, done: 0, errors: Vec::new() }
    }
}

impl StartState {
    fn new(identified: &Identified, record: &Record, part: &Range<usize>, readings: &[Option<Reading>]) -> Self {
        let part = beginning(record, part, readings);
        let scales = numbers(readings.len(), &|sensor| scale(&record.measured(sensor)[part.clone()]));
        let motion = vec![0.0; identified.model.motion()];
        let there = |sensor: usize| part.clone().filter(move |&k| has(record, readings, k, sensor)).count();
        let rows = (0..readings.len()).map(there).sum();
        let trial = FitTrial::new(identified, motion.clone());
        Self { part, scales, motion, rows, error: None, columns: Vec::new(), iterations: 0, trial }
    }

    fn advance(&mut self, identified: &Identified, record: &Record, readings: &[Option<Reading>]) -> bool {
        if self.rows == 0 || self.motion.is_empty() {
            return true;
        }
        if !self.piece(identified, record, readings) {
            return false;
        }
        let Some(motion) = self.conclude() else { return true };
        self.trial = FitTrial::new(identified, motion);
        false
    }

    fn conclude(&mut self) -> Option<Vec<f64>> {
        let after = Vector::from_vec(std::mem::take(&mut self.trial.errors));
        match self.error.take() {
            None => self.error = Some(after),
            Some(error) if self.columns.len() < self.motion.len() => {
                self.columns.push((&error - after) / self.step());
                self.error = Some(error);
            }
            Some(error) => {
                if after.norm_squared().is_nan() || after.norm_squared() >= error.norm_squared() {
                    return None;
                }
                let is_settled = after.norm_squared() > (1.0 - 1e-9) * error.norm_squared();
                self.motion = std::mem::take(&mut self.trial.motion);
                self.error = Some(after);
                self.columns.clear();
                self.iterations += 1;
                if is_settled || self.iterations >= ITERATIONS {
                    return None;
                }
            }
        }
        let mut motion = self.motion.clone();
        match motion.get_mut(self.columns.len()) {
            Some(component) => *component += self.step(),
            None => {
                let change = self.change()?;
                motion.iter_mut().zip(change.iter()).for_each(|(value, change)| *value += change);
            }
        }
        Some(motion)
    }

    fn step(&self) -> f64 {
        1e-6 * (1e-3 + self.motion.get(self.columns.len()).map_or(0.0, |value| value.abs()))
    }

    fn change(&self) -> Option<Vector> {
        let (jacobian, error) = (Matrix::from_columns(&self.columns), self.error.as_ref()?);
        if !jacobian.norm_squared().is_finite() || !error.norm_squared().is_finite() {
            return None;
        }
        // A component whose effect on the readings is none, or that of components before it, stays as it is.
        let (normal, right) = (jacobian.tr_mul(&jacobian), jacobian.tr_mul(error));
        let change = Ldl::semidefinite(&normal).divide(&Matrix::from_row_slice(1, right.len(), right.as_slice()));
        Some(Vector::from_column_slice(change.as_slice()))
    }

    /// The errors of the trial's next readings, relative to the readings' size. Returns whether they are complete.
    fn piece(&mut self, identified: &Identified, record: &Record, readings: &[Option<Reading>]) -> bool {
        let Self { part, scales, rows, trial: FitTrial { course, done, errors, .. }, .. } = self;
        course.go_on(identified, record, part.clone(), done, &mut |k, state| {
            for (sensor, reading) in readings.iter().enumerate().filter(|(sensor, _)| has(record, readings, k, *sensor))
            {
                let error =
                    identified.measured(record, sensor, k) - identified.read(reading.as_ref(), state, record, k);
                errors.push(if error.is_nan() { 0.0 } else { error / scales[sensor] });
            }
        });
        let is_complete = *done >= part.len();
        if is_complete {
            errors.resize(*rows, 0.0);
        }
        is_complete
    }
}

fn has(record: &Record, readings: &[Option<Reading>], k: usize, sensor: usize) -> bool {
    readings[sensor].is_some() && !record.measured(sensor)[k].is_nan()
}

/// The first samples, which have [`BEGINNING`] readings, but not more than half of the part.
fn beginning(record: &Record, part: &Range<usize>, readings: &[Option<Reading>]) -> Range<usize> {
    let mut count = 0;
    let end = part.clone().find(|&k| {
        count += (0..readings.len()).filter(|&sensor| has(record, readings, k, sensor)).count();
        count >= BEGINNING
    });
    part.start..end.map_or(part.end, |end| end + 1).min(part.start + part.len() / 2)
}

fn scale(measured: &[f64]) -> f64 {
    let values = measured.iter().filter(|value| !value.is_nan());
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value * value, count + 1.0));
    let rms = libm::sqrt(sum / f64::max(count, 1.0));
    if rms > 0.0 { rms } else { 1.0 }
}

/// The samples between two checks of the clock: at most about a millisecond.
const CHUNK: usize = 64;

struct InputCourse {
    response: Response,
    is_new: bool,
    goes_on: bool,
}

impl InputCourse {
    fn new(identified: &Identified, motion: &[f64]) -> Self {
        let mut values = identified.values.clone();
        values[..motion.len()].copy_from_slice(motion);
        let (state, _) = identified.model.to_state(&values);
        Self { response: Response::new(state.iter().copied()), is_new: true, goes_on: true }
    }

    fn state(&self) -> Option<&[f64]> {
        let state = self.response.state.as_slice();
        (self.goes_on && state.iter().all(|value| value.is_finite())).then_some(state)
    }

    /// Continues for about a millisecond, since a step that is halved takes time. A model that has run away is done.
    fn go_on(
        &mut self,
        identified: &Identified,
        record: &Record,
        part: Range<usize>,
        done: &mut usize,
        take: &mut dyn FnMut(usize, &[f64]),
    ) {
        let samples = (*done + CHUNK).min(part.len());
        let end = self.response.halved + HALVED;
        while *done < samples && self.response.halved < end {
            let k = part.start + *done;
            let Some(state) = self.state() else {
                *done = part.len();
                break;
            };
            if self.is_new {
                take(k, state);
            }
            self.is_new = self.advance(identified, record, k, end - self.response.halved);
            *done += usize::from(self.is_new);
        }
    }

    /// Halves steps at most `most` times. Returns whether it has arrived at sample `k + 1`; if not, the next call continues.
    fn advance(&mut self, identified: &Identified, record: &Record, k: usize, most: u64) -> bool {
        let force = |k: usize| record.delayed_force(k, identified.input_delay);
        let end = match record.hold() {
            Hold::Zero => k,
            Hold::First => k + 1,
        };
        let moved = self.response.advance(&identified.model, [force(k), force(end)], 0.0, record.dt(), most);
        self.goes_on = moved.is_ok();
        moved != Ok(false)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Pass;
    use crate::run::simulate::Simulator;

    #[test]
    fn the_fit_of_a_beginning_that_is_hard_to_follow_is_divided() {
        let text = include_str!("../../../tests/hostile/hard-truth.toml").replace("plant = \"sdof\"\n", "");
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
