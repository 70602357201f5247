//! Free runs: an identified model over a record, without using its measurements.

mod running;

use std::ops::Range;

use kalmanscope_filters::{Channel, Quantity, Reading};
use kalmanscope_records::Record;

use crate::{Estimates, FilterSettings, Model, Scenario};

pub use running::Running;

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
        Running::new(self.clone(), record, part)
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
