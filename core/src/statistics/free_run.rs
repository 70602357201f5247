//! Free runs: an identified model over a record, without using its measurements.

use std::ops::Range;

use kalmanscope_filters::linalg::{Ldl, Matrix, Vector};
use kalmanscope_filters::lists::{mapped, numbers};
use kalmanscope_filters::{Channel, Hold, Quantity, Reading};
use kalmanscope_records::Record;
use kalmanscope_records::task::{at_once, pause};

use crate::run::forces::Forces;
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
        at_once(self.run_in_pieces(record, part, |_| ()))
    }

    /// The same with pauses, about every millisecond. `progress` gets the share that is done.
    pub async fn run_in_pieces(&self, record: &Record, part: Range<usize>, progress: impl Fn(f64)) -> FreeRun {
        let end = part.end.min(record.len());
        let part = part.start.min(end)..end;
        let readings: Vec<Option<Reading>> = mapped(record.sensors(), &|&q| self.model.reading(q));
        let mut bounds: Vec<usize> = mapped(&self.plucks, &|time| after(record, *time));
        bounds.retain(|bound| *bound > part.start && *bound < part.end);
        bounds.insert(0, part.start);
        bounds.push(part.end);
        let mut predicted = vec![Vec::with_capacity(part.len()); readings.len()];
        let mut beginnings = Vec::new();
        for leg in bounds.windows(2).map(|ends| ends[0]..ends[1]) {
            let (beginning, motion) = self.beginning(record, &leg, &readings).await;
            let read = |k: usize, state: &[f64]| {
                progress((k - part.start) as f64 / part.len() as f64);
                for (column, reading) in predicted.iter_mut().zip(&readings) {
                    column.push(self.read(reading.as_ref(), state, record, k));
                }
            };
            self.follow(record, leg.clone(), &motion, read).await;
            predicted.iter_mut().for_each(|column| column.resize(leg.end - part.start, f64::NAN));
            beginnings.push(beginning);
        }
        let fitted = beginnings[0].len();
        let fits = (0..readings.len()).map(|sensor| {
            readings[sensor].as_ref()?;
            let mut measured: Vec<f64> = part.clone().map(|k| self.measured(record, sensor, k)).collect();
            for samples in &beginnings {
                measured[samples.start - part.start..samples.end - part.start].fill(f64::NAN);
            }
            fit(&measured[fitted..], &predicted[sensor][fitted..])
        });
        FreeRun { fits: fits.collect(), fitted, predicted, part }
    }

    fn read(&self, reading: Option<&Reading>, state: &[f64], record: &Record, k: usize) -> f64 {
        let mut forces = Forces::of(self.model.channels(), record.forced(), record.hold());
        forces.take(record, k, self.input_delay);
        let force = record.delayed_force(k, self.input_delay);
        reading.map_or(f64::NAN, |reading| self.model.read(reading, state, forces.now(force)))
    }

    /// The first samples of a leg, which have [`BEGINNING`] readings, but not more than half of it, and the motion fitted to them.
    async fn beginning(
        &self,
        record: &Record,
        leg: &Range<usize>,
        readings: &[Option<Reading>],
    ) -> (Range<usize>, Vec<f64>) {
        let has = |sensor: usize, k: usize| readings[sensor].is_some() && !record.measured(sensor)[k].is_nan();
        let count = |k: usize| (0..readings.len()).filter(|&sensor| has(sensor, k)).count();
        let mut so_far = 0;
        let end = leg.clone().find(|&k| {
            so_far += count(k);
            so_far >= BEGINNING
        });
        let part = leg.start..end.map_or(leg.end, |end| end + 1).min(leg.start + leg.len() / 2);
        // A size of each sensor's readings, so that those of all sensors count alike.
        let scales = numbers(readings.len(), &|sensor| scale(&record.measured(sensor)[part.clone()]));
        let (rows, mut motion) = (part.clone().map(count).sum(), vec![0.0; self.model.motion()]);
        if rows == 0 || motion.is_empty() {
            return (part, motion);
        }
        let errors = async |motion: &[f64]| {
            let mut errors = Vec::with_capacity(rows);
            let compare = |k: usize, state: &[f64]| {
                for (sensor, reading) in readings.iter().enumerate().filter(|(sensor, _)| has(*sensor, k)) {
                    let error = self.measured(record, sensor, k) - self.read(reading.as_ref(), state, record, k);
                    errors.push(if error.is_nan() { 0.0 } else { error / scales[sensor] });
                }
            };
            self.follow(record, part.clone(), motion, compare).await;
            errors.resize(rows, 0.0);
            Vector::from_vec(errors)
        };
        let mut error = errors(&motion).await;
        for _ in 0..ITERATIONS {
            let mut columns = Vec::with_capacity(motion.len());
            for place in 0..motion.len() {
                let (mut moved, step) = (motion.clone(), 1e-6 * (1e-3 + motion[place].abs()));
                moved[place] += step;
                columns.push((&error - errors(&moved).await) / step);
            }
            let Some(change) = change(&columns, &error) else { break };
            let next: Vec<f64> = motion.iter().zip(change.iter()).map(|(value, change)| value + change).collect();
            let after = errors(&next).await;
            let (before, now) = (error.norm_squared(), after.norm_squared());
            if now.is_nan() || now >= before {
                break;
            }
            (motion, error) = (next, after);
            if now > (1.0 - 1e-9) * before {
                break;
            }
        }
        (part, motion)
    }

    /// Takes the state at each of some samples, from a motion at the first one on. A model that has run away is done.
    async fn follow(
        &self,
        record: &Record,
        samples: Range<usize>,
        motion: &[f64],
        mut take: impl FnMut(usize, &[f64]),
    ) {
        let mut values = self.values.clone();
        values[..motion.len()].copy_from_slice(motion);
        let mut response = Response::new(self.model.to_state(&values).0.iter().copied());
        let force = |k: usize| record.delayed_force(k, self.input_delay);
        let mut on_masses = Forces::of(self.model.channels(), record.forced(), record.hold());
        pause().await;
        let (mut begin, mut end) = (samples.start, HALVED);
        for k in samples {
            if !response.state.iter().all(|value| value.is_finite()) {
                return;
            }
            take(k, response.state.as_slice());
            let forces = [k, if record.hold() == Hold::Zero { k } else { k + 1 }].map(force);
            on_masses.take(record, k + 1, self.input_delay);
            loop {
                let most = end - response.halved;
                let inputs = on_masses.over(forces);
                let Ok(is_there) = response.advance(&self.model, inputs, 0.0, record.dt(), most) else { return };
                // About a millisecond, since a step that is halved takes time.
                if k - begin >= CHUNK || response.halved >= end {
                    (begin, end) = (k, response.halved + HALVED);
                    pause().await;
                }
                if is_there {
                    break;
                }
            }
        }
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

fn after(record: &Record, time: f64) -> usize {
    let k = libm::ceil((time - record.time(0)) / record.dt()).clamp(0.0, record.len() as f64) as usize;
    if k < record.len() && record.time(k) <= time { k + 1 } else { k }
}

const BEGINNING: usize = 50;

/// Limits the iterations of the fit; for a linear plant the first is exact.
const ITERATIONS: usize = 8;

fn change(columns: &[Vector], error: &Vector) -> Option<Vector> {
    let jacobian = Matrix::from_columns(columns);
    if !jacobian.norm_squared().is_finite() || !error.norm_squared().is_finite() {
        return None;
    }
    // A component whose effect on the readings is none, or that of components before it, stays as it is.
    let (normal, right) = (jacobian.tr_mul(&jacobian), jacobian.tr_mul(error));
    let change = Ldl::semidefinite(&normal).divide(&Matrix::from_row_slice(1, right.len(), right.as_slice()));
    Some(Vector::from_column_slice(change.as_slice()))
}

fn scale(measured: &[f64]) -> f64 {
    let values = measured.iter().filter(|value| !value.is_nan());
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value * value, count + 1.0));
    let rms = libm::sqrt(sum / f64::max(count, 1.0));
    if rms > 0.0 { rms } else { 1.0 }
}

/// The samples between two checks of the clock: at most about a millisecond.
const CHUNK: usize = 64;

#[cfg(test)]
mod tests {
    use kalmanscope_records::{Task as _, Work};

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
        let mut beginning = Work::new(|_| async move {
            let readings: Vec<Option<Reading>> = mapped(record.sensors(), &|&q| model.model.reading(q));
            model.beginning(&record, &(0..record.len()), &readings).await
        });
        let mut pieces = 0;
        while !beginning.advance(&mut || false) {
            pieces += 1;
        }
        // Each error of ten samples halves steps ten thousand times.
        assert!(pieces > 50, "{pieces}");
    }
}
