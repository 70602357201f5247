//! Free runs: an identified model alone over a record, without a look at its measurements.

use std::ops::Range;

use crate::linalg::{Matrix, Vector};
use crate::model::{Hold, Model, Reading};
use crate::simulate::response::Response;
use crate::{Channel, Estimates, FilterSettings, Quantity, Record, Scenario};

/// A model with all its parameters known, as a filter has identified it.
///
/// An unknown force is no part of it, and its parameters do not decay.
#[derive(Clone, Debug)]
pub struct Identified {
    model: Model,
    /// One value for each channel of the model, in the channel's unit.
    values: Vec<f64>,
    input_delay: i32,
}

/// The free run of a model over a part of a record.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeRun {
    /// The samples of the part.
    pub part: Range<usize>,
    /// The samples at the beginning from which the motion was fitted; they do not count in the fits.
    pub fitted: usize,
    /// The predicted readings of each of the record's sensors over the part; NaN where the model has none or has run
    /// away.
    pub predicted: Vec<Vec<f64>>,
    /// The fit to each sensor's measurements; `None` where there is nothing to compare.
    pub fits: Vec<Option<Fit>>,
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

/// The readings from which the motion at the beginning is fitted.
const BEGINNING: usize = 50;

/// Limits the iterations of that fit; for a linear plant the first is exact.
const ITERATIONS: usize = 8;

impl Identified {
    /// The model as a filter knows it at sample `k` of those that are kept.
    pub fn at(scenario: &Scenario, settings: &FilterSettings, estimates: &Estimates, k: usize) -> Self {
        Self::new(scenario, settings, estimates.mean(k).to_vec())
    }

    /// The model with the mean of a filter's estimates over some samples, which are not empty.
    pub fn over(scenario: &Scenario, settings: &FilterSettings, estimates: &Estimates, samples: Range<usize>) -> Self {
        let mut values = vec![0.0; estimates.channels().len()];
        let share = 1.0 / samples.len().max(1) as f64;
        for k in samples {
            values.iter_mut().zip(estimates.mean(k)).for_each(|(sum, value)| *sum += share * value);
        }
        Self::new(scenario, settings, values)
    }

    fn new(scenario: &Scenario, settings: &FilterSettings, mut values: Vec<f64>) -> Self {
        let model = settings.model(scenario.plant.kind, scenario.input).decaying(0.0);
        if let Some(place) = model.place(Channel::UNKNOWN_FORCE) {
            values[place] = 0.0;
        }
        Self { model, values, input_delay: settings.input_delay }
    }

    /// The channels of the model with their values, in the channels' units; those of the motion say nothing.
    pub fn values(&self) -> impl Iterator<Item = (Channel, f64)> {
        self.model.channels().iter().copied().zip(self.values.iter().copied())
    }

    /// Runs over the samples of `part`. The motion at the beginning is fitted to the first fifty readings by least
    /// squares; from then on the measurements are not used.
    ///
    /// Source of the fit: Nocedal and Wright (2006), *Numerical Optimization*, section 10.3 (Gauss and Newton).
    pub fn run(&self, record: &Record, part: Range<usize>) -> FreeRun {
        let part = part.start..part.end.min(record.len());
        let readings: Vec<Option<Reading>> = record.sensors().iter().map(|&q| self.model.reading(q)).collect();
        let beginning = self.beginning(record, &part, &readings);
        let motion = self.first_motion(record, &beginning, &readings);
        let mut predicted = vec![Vec::with_capacity(part.len()); readings.len()];
        self.simulate(&motion, record, &part, |k, state| {
            for (column, reading) in predicted.iter_mut().zip(&readings) {
                column.push(self.read(reading.as_ref(), state, record, k));
            }
        });
        predicted.iter_mut().for_each(|column| column.resize(part.len(), f64::NAN));
        let fits = (0..readings.len()).map(|sensor| {
            let measured = &record.measured(sensor)[part.clone()];
            readings[sensor].as_ref()?;
            fit(&measured[beginning.len()..], &predicted[sensor][beginning.len()..])
        });
        FreeRun { fits: fits.collect(), fitted: beginning.len(), predicted, part }
    }

    /// The first samples, which have [`BEGINNING`] readings, but not more than half of the part.
    fn beginning(&self, record: &Record, part: &Range<usize>, readings: &[Option<Reading>]) -> Range<usize> {
        let mut count = 0;
        let has = |k: usize, sensor: usize| readings[sensor].is_some() && !record.measured(sensor)[k].is_nan();
        let end = part.clone().find(|&k| {
            count += (0..readings.len()).filter(|&sensor| has(k, sensor)).count();
            count >= BEGINNING
        });
        part.start..end.map_or(part.end, |end| end + 1).min(part.start + part.len() / 2)
    }

    /// The motion at the first sample that fits the readings at the beginning best.
    fn first_motion(&self, record: &Record, part: &Range<usize>, readings: &[Option<Reading>]) -> Vec<f64> {
        let motion = self.model.motion();
        let mut best = vec![0.0; motion];
        let residual = |start: &[f64]| {
            let mut residual = Vec::new();
            self.simulate(start, record, part, |k, state| {
                for (sensor, reading) in readings.iter().enumerate() {
                    let error = record.measured(sensor)[k] - self.read(reading.as_ref(), state, record, k);
                    residual.push(if error.is_nan() { 0.0 } else { error / self.scale(record, sensor, part) });
                }
            });
            residual.resize(part.len() * readings.len(), 0.0);
            Vector::from_vec(residual)
        };
        let mut error = residual(&best);
        for _ in 0..ITERATIONS {
            let mut jacobian = Matrix::zeros(error.len(), motion);
            for i in 0..motion {
                let step = 1e-6 * (1e-3 + best[i].abs());
                let mut moved = best.clone();
                moved[i] += step;
                jacobian.set_column(i, &((&error - residual(&moved)) / step));
            }
            // Directions that the readings do not show stay as they are.
            let svd = jacobian.svd(true, true);
            let least = 1e-9 * svd.singular_values.max();
            let Ok(change) = svd.solve(&error, least.max(f64::MIN_POSITIVE)) else { break };
            let moved: Vec<f64> = best.iter().zip(change.iter()).map(|(value, change)| value + change).collect();
            let after = residual(&moved);
            // A motion that runs away has no error that is a number.
            if after.norm_squared().is_nan() || after.norm_squared() >= error.norm_squared() {
                break;
            }
            let is_done = after.norm_squared() > (1.0 - 1e-9) * error.norm_squared();
            (best, error) = (moved, after);
            if is_done {
                break;
            }
        }
        best
    }

    /// A size of a sensor's readings, so that those of all sensors count alike.
    fn scale(&self, record: &Record, sensor: usize, part: &Range<usize>) -> f64 {
        let values = record.measured(sensor)[part.clone()].iter().filter(|value| !value.is_nan());
        let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value * value, count + 1.0));
        let rms = libm::sqrt(sum / f64::max(count, 1.0));
        if rms > 0.0 { rms } else { 1.0 }
    }

    fn read(&self, reading: Option<&Reading>, state: &[f64], record: &Record, k: usize) -> f64 {
        let force = record.delayed_force(k, self.input_delay);
        reading.map_or(f64::NAN, |reading| self.model.read(reading, state, force))
    }

    /// Calls `each` with every sample of a part and the state there, as long as it is finite.
    fn simulate(&self, motion: &[f64], record: &Record, part: &Range<usize>, mut each: impl FnMut(usize, &[f64])) {
        let mut values = self.values.clone();
        values[..motion.len()].copy_from_slice(motion);
        let (state, _) = self.model.to_state(&values);
        let mut response = Response::new(state.iter().copied());
        let force = |k: usize| record.delayed_force(k, self.input_delay);
        for k in part.clone() {
            if response.state().iter().any(|value| !value.is_finite()) {
                return;
            }
            each(k, response.state());
            let end = match record.hold() {
                Hold::Zero => k,
                Hold::First => k + 1,
            };
            if response.advance(&self.model, [force(k), force(end)], 0.0, record.dt()).is_err() {
                return;
            }
        }
    }
}

impl FreeRun {
    /// The fit to a quantity's measurements.
    pub fn fit(&self, record: &Record, quantity: Quantity) -> Option<Fit> {
        let place = record.sensors().iter().position(|&sensor| sensor == quantity)?;
        self.fits[place]
    }
}

/// The agreement of predictions with measurements, of which those that are missing do not count.
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

/// The errors of a filter's predictions one step ahead over a part: its innovations against the measurements.
pub fn one_step(estimates: &Estimates, record: &Record, sensor: usize, part: Range<usize>) -> Option<Fit> {
    let quantity = *record.sensors().get(sensor)?;
    let place = estimates.sensors().iter().position(|&own| own == quantity)?;
    let part = part.start..part.end.min(estimates.len());
    let measured = &record.measured(sensor)[part.clone()];
    let predicted: Vec<f64> =
        part.clone().map(|k| record.measured(sensor)[k] - estimates.innovation(k)[place]).collect();
    // The first sample has no prediction.
    let skip = predicted.iter().zip(measured).take_while(|(p, m)| p.is_nan() && !m.is_nan()).count();
    fit(&measured[skip..], &predicted[skip..])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Run;

    fn scenario(text: &str) -> Scenario {
        Scenario::from_toml(text).unwrap()
    }

    #[test]
    fn the_truth_runs_freely_through_its_own_record() {
        for (kind, hold) in [("sdof", "zero"), ("sdof", "first"), ("duffing", "first")] {
            let text = format!(
                "duration = 20.0\nhold = \"{hold}\"\n[plant]\nkind = \"{kind}\"\nnatural_frequency = 6.0\n[plant.initial]\ndisplacement = 0.3\n\
                 [[sensors]]\nmeasures = \"displacement\"\nnoise_std = 0.0\n[[sensors]]\nmeasures = \"acceleration\"\n\
                 noise_std = 0.0\n[[filters]]\nkind = \"ekf\"\nsensor_std = [0.01, 0.1]\n"
            );
            let scenario = scenario(&text);
            let mut run = Run::new(&scenario).unwrap();
            run.finish();
            let truth: Vec<f64> = run.estimates()[0]
                .channels()
                .iter()
                .map(|&channel| run.record().truth(channel).unwrap()[100])
                .collect();
            let free = Identified::new(&scenario, &scenario.filters[0], truth).run(run.record(), 0..run.len());
            for fit in &free.fits {
                let fit = fit.unwrap();
                assert!(fit.percent > 99.999, "{kind} {hold}: {fit:?}");
                assert!(fit.readings > 1900);
            }
        }
    }

    #[test]
    fn fits_are_shares_of_the_spread() {
        let measured = [1.0, -1.0, f64::NAN, 1.0, -1.0];
        let exact = fit(&measured, &[1.0, -1.0, 5.0, 1.0, -1.0]).unwrap();
        assert_eq!((exact.rms, exact.percent, exact.readings), (0.0, 100.0, 4));
        assert_eq!(fit(&measured, &[0.0; 5]).unwrap().percent, 0.0);
        assert_eq!(fit(&measured, &[f64::NAN; 5]).unwrap().rms, f64::INFINITY);
        assert_eq!(fit(&[f64::NAN], &[0.0]), None);
    }
}
