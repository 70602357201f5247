//! Free runs: an identified model over a record, without using its measurements.

mod running;

use std::ops::Range;

use kalmanscope_filters::model::{Model, Reading};
use kalmanscope_filters::{Channel, Quantity};
use kalmanscope_records::Record;

use crate::{Estimates, FilterSettings, Scenario};

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
        let model = settings.model(&scenario.plant.kind, scenario.input).decaying(0.0);
        for place in [Channel::UNKNOWN_FORCE, Channel::WHITE_FORCE].into_iter().filter_map(|force| model.place(force)) {
            values[place] = 0.0;
        }
        let quantities = scenario.sensors.iter().map(|sensor| sensor.measures);
        let late = quantities.zip(settings.sensor_delay.iter().copied()).collect();
        Self { model, values, input_delay: settings.input_delay, late, plucks: settings.plucks.clone() }
    }

    /// The reading by a sensor of sample `k`, or of the nearest sample where the sensor is late.
    fn measured(&self, record: &Record, sensor: usize, k: usize) -> f64 {
        let quantity = record.sensors()[sensor];
        let late = self.late.iter().find(|(own, _)| *own == quantity).map_or(0.0, |(_, late)| late / record.dt());
        record.late_reading(sensor, k, late)
    }

    /// Runs over the samples of `part`. The motion at the beginning, and where a filter takes it to begin again
    /// ([`FilterSettings::plucks`]), is fitted to the next fifty readings by least squares; from then on the measurements are not used.
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

/// The errors of a filter's predictions one step ahead over a part: its innovations against the measurements. `None` if
/// there is nothing to compare, for example because the filter has stopped before the part.
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
    fn a_free_run_in_pieces_is_that_in_one_go() {
        for kind in ["sdof", "duffing"] {
            let text = format!("duration = 20.0\n[plant]\nkind = \"{kind}\"\n[plant.initial]\ndisplacement = 0.3\n");
            let scenario = scenario(&text);
            let mut run = Run::new(&scenario).unwrap();
            run.finish();
            let model = Identified::at(&scenario, &scenario.filters[0], &run.estimates()[0], run.len() - 1);
            let mut running = model.running(run.record(), 100..1900);
            let mut pieces = 1;
            while !running.advance(run.record(), &mut || false) {
                assert!(running.progress() < 1.0);
                pieces += 1;
            }
            assert!(pieces > 20, "{pieces}");
            assert_eq!(running.progress(), 1.0);
            assert_eq!(running.finish(run.record()), model.run(run.record(), 100..1900));
        }
    }

    fn free_runs(text: &str) -> Vec<(FreeRun, Vec<Option<Fit>>)> {
        let scenario = scenario(text);
        let mut run = Run::new(&scenario).unwrap();
        run.finish();
        let record = run.record();
        let filters = scenario.filters.iter().zip(run.estimates()).filter(|(_, estimates)| !estimates.is_empty());
        let one = |(settings, estimates): (&FilterSettings, &Estimates)| {
            let free = Identified::at(&scenario, settings, estimates, estimates.len() - 1).run(record, 0..record.len());
            let part = free.fitted..record.len();
            let steps = (0..record.sensors().len()).map(|place| one_step(estimates, record, place, part.clone()));
            let steps = steps.collect();
            (free, steps)
        };
        filters.map(one).collect()
    }

    #[test]
    fn without_sensors_or_with_one_sample_there_is_no_fit() {
        let all = free_runs("duration = 2.0\nsensors = []\n[[filters]]\nkind = \"ekf\"\nsensor_std = []\n");
        assert_eq!(all.len(), 1);
        assert_eq!((all[0].0.fitted, all[0].0.fits.len()), (100, 0));
        let scenario = scenario("duration = 2.0\n");
        let mut run = Run::new(&scenario).unwrap();
        run.finish();
        let model = Identified::at(&scenario, &scenario.filters[0], &run.estimates()[0], run.len() - 1);
        for part in [5..6, 5..5, 500..600] {
            let free = model.run(run.record(), part);
            assert_eq!(free.fitted, 0);
            assert!(free.part.len() <= 1 && free.predicted.iter().all(|column| column.len() == free.part.len()));
        }
    }

    #[test]
    fn a_filter_that_has_stopped_before_the_part_has_no_fit_one_step_ahead() {
        let scenario = scenario("duration = 2.0\n");
        let mut run = Run::new(&scenario).unwrap();
        run.advance_to(20);
        let estimates = run.estimates()[0].clone();
        run.finish();
        assert_eq!(one_step(&estimates, run.record(), 0, 50..run.len()), None);
        assert!(one_step(&run.estimates()[0], run.record(), 0, 50..run.len()).is_some());
    }

    #[test]
    fn a_motion_that_is_no_number_is_not_fitted() {
        let scenario = scenario("duration = 2.0\n");
        let mut run = Run::new(&scenario).unwrap();
        run.finish();
        for value in [1e155, 1e300, f64::INFINITY, f64::NAN, -1e155] {
            let channels = run.estimates()[0].channels().len();
            for place in 0..channels {
                let mut values = run.estimates()[0].mean(run.len() - 1).to_vec();
                values[place] = value;
                let free = Identified::new(&scenario, &scenario.filters[0], values).run(run.record(), 0..run.len());
                assert_eq!(free.fits.len(), run.record().sensors().len(), "{value} {place}");
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
