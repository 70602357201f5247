//! The statistics of many runs that differ in their seeds: other noise each time, or the members of a population.

use std::ops::RangeInclusive;

use kalmanscope_core::diagnostics::chi_squared;
use kalmanscope_core::internals::sort_numbers;

use crate::{Ensemble, EnsembleError, Plan, Slice, Trace};
use kalmanscope_core::{Axis, Channel, Measure, Scenario, Spacing, VerdictKind};

/// Statistics over the seeds of an ensemble, which grow as rows come in.
///
/// Source: Bar-Shalom, Li and Kirubarajan (2001), *Estimation with Applications to Tracking and Navigation*, section 5.4.
#[derive(Clone, Debug)]
pub struct MonteCarlo {
    trace: Trace,
    measures: usize,
    filters: Vec<Filter>,
    done: usize,
    impossible: usize,
}

/// The runs of one filter.
#[derive(Clone, Debug)]
struct Filter {
    channels: Vec<Channel>,
    /// For each time the sums of NEES and NIS and the number of runs in them.
    squares: Vec<[(f64, u32); 2]>,
    /// For each time and channel the errors of all runs.
    errors: Vec<Vec<Vec<f32>>>,
    /// For each time and channel the sum of the variances and the number of runs in it.
    variances: Vec<Vec<(f64, u32)>>,
    /// For each channel the last estimates, and their errors where the truth is known.
    finals: Vec<Vec<f64>>,
    last: Vec<Vec<LastError>>,
    /// The runs with each verdict, in the order of [`VerdictKind::ALL`].
    verdicts: [usize; VerdictKind::ALL.len()],
    diverged: usize,
    stopped: usize,
}

/// The last error of a channel in one run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LastError {
    /// Estimate minus truth, in the channel's unit.
    pub error: f64,
    /// The truth.
    pub truth: f64,
    /// The standard deviation that the filter states.
    pub std: f64,
}

impl LastError {
    /// Whether the estimate is within this share of the truth.
    pub fn is_within(&self, share: f64) -> bool {
        self.error.abs() <= share * self.truth.abs()
    }

    /// Whether the truth is within ±2σ.
    pub fn is_covered(&self) -> bool {
        self.error.abs() <= 2.0 * self.std
    }
}

impl MonteCarlo {
    /// The ensemble of a scenario's filters with the seeds 1 to `seeds`, and a trace of `times` times for each run. Verdicts take
    /// longer than the runs.
    ///
    /// # Errors
    /// [`EnsembleError`] where the scenario is impossible or lacks a filter.
    pub fn ensemble(
        scenario: Scenario,
        filters: Vec<usize>,
        seeds: usize,
        times: usize,
        verdicts: bool,
    ) -> Result<Ensemble, EnsembleError> {
        let channels = crate::channels(&scenario, &filters);
        let flags = [Measure::DIVERGED, Measure::STOPPED].into_iter().chain(verdicts.then_some(Measure::VERDICT));
        let of = |channel| [Measure::estimate(channel), Measure::error(channel), Measure::std(channel)];
        let measures = flags.chain(channels.into_iter().flat_map(of)).collect();
        let axis = Axis { key: "seed".to_owned(), from: 1.0, to: seeds as f64, count: seeds, spacing: Spacing::Linear };
        Ensemble::new(scenario, Plan { filters, measures, times, axes: vec![axis] })
    }

    /// Empty statistics of an ensemble that [`Self::ensemble`] has made.
    pub fn new(ensemble: &Ensemble) -> Self {
        let trace = ensemble.trace();
        let times = trace.samples().len();
        let filter = |nth: usize| {
            let channels = trace.channels(nth).to_vec();
            Filter {
                squares: vec![[(0.0, 0); 2]; times],
                errors: vec![vec![Vec::new(); channels.len()]; times],
                variances: vec![vec![(0.0, 0); channels.len()]; times],
                finals: vec![Vec::new(); channels.len()],
                last: vec![Vec::new(); channels.len()],
                verdicts: [0; VerdictKind::ALL.len()],
                channels,
                diverged: 0,
                stopped: 0,
            }
        };
        let filters = (0..ensemble.plan().filters.len()).map(filter).collect();
        Self { filters, trace, measures: ensemble.plan().measures.len(), done: 0, impossible: 0 }
    }

    /// Takes in the rows of some seeds, each once.
    pub fn take(&mut self, ensemble: &Ensemble, slice: &Slice) {
        for row in slice.rows.chunks_exact(ensemble.width()) {
            self.done += 1;
            // The row of an impossible member has no number.
            if row.iter().all(|number| number.is_nan()) {
                self.impossible += 1;
                continue;
            }
            for (nth, filter) in self.filters.iter_mut().enumerate() {
                let measures = &ensemble.plan().measures;
                let number = |measure: Measure| {
                    let place = measures.iter().position(|other| *other == measure);
                    place.map_or(f64::NAN, |place| row[nth * self.measures + place])
                };
                filter.diverged += usize::from(number(Measure::DIVERGED) == 1.0);
                filter.stopped += usize::from(number(Measure::STOPPED) == 1.0);
                let verdict = number(Measure::VERDICT);
                if verdict.is_finite() {
                    filter.verdicts[verdict as usize] += 1;
                }
                let Filter { channels, finals, last, .. } = &mut *filter;
                for (&channel, (finals, last)) in channels.iter().zip(finals.iter_mut().zip(last)) {
                    let estimate = number(Measure::estimate(channel));
                    finals.push(estimate);
                    let (error, std) = (number(Measure::error(channel)), number(Measure::std(channel)));
                    if error.is_finite() {
                        last.push(LastError { error, truth: estimate - error, std });
                    }
                }
                for time in 0..self.trace.samples().len() {
                    for (sum, square) in filter.squares[time].iter_mut().zip(self.trace.squares(row, nth, time)) {
                        if square.is_finite() {
                            *sum = (sum.0 + square, sum.1 + 1);
                        }
                    }
                    for channel in 0..filter.channels.len() {
                        let [error, std] = self.trace.error(row, nth, time, channel);
                        if error.is_finite() {
                            filter.errors[time][channel].push(error as f32);
                            let sum = &mut filter.variances[time][channel];
                            *sum = (sum.0 + std * std, sum.1 + 1);
                        }
                    }
                }
            }
        }
    }

    /// The number of members that are done and impossible, as with a damping ratio below 0. They are in no other number.
    pub fn impossible(&self) -> usize {
        self.impossible
    }

    /// The number of runs: of seeds that are done and possible.
    pub fn runs(&self) -> usize {
        self.done - self.impossible
    }

    /// The number of seeds that are done.
    pub fn done(&self) -> usize {
        self.done
    }

    /// The samples of the traces.
    pub fn samples(&self) -> &[usize] {
        self.trace.samples()
    }

    /// The channels of the `nth` filter.
    pub fn channels(&self, nth: usize) -> &[Channel] {
        &self.filters[nth].channels
    }

    /// The shares of the `nth` filter's runs that lost the truth or stopped, and that stopped.
    pub fn diverged(&self, nth: usize) -> [f64; 2] {
        let runs = self.runs() as f64;
        [self.filters[nth].diverged, self.filters[nth].stopped].map(|count| count as f64 / runs)
    }

    /// The mean NEES over the runs at each time; NaN where there is none.
    pub fn nees(&self, nth: usize) -> impl Iterator<Item = f64> {
        self.filters[nth].squares.iter().map(|[(sum, runs), _]| sum / f64::from(*runs))
    }

    /// The mean NIS over the runs at each time; NaN where there is none.
    pub fn nis(&self, nth: usize) -> impl Iterator<Item = f64> {
        self.filters[nth].squares.iter().map(|[_, (sum, runs)]| sum / f64::from(*runs))
    }

    /// The 95 % interval of a mean over this many runs of squares with these degrees of freedom each.
    pub fn interval(degrees: usize, runs: usize) -> Option<RangeInclusive<f64>> {
        let (degrees, runs) = (u32::try_from(degrees).ok()?, u32::try_from(runs).ok()?);
        chi_squared::interval(degrees.checked_mul(runs)?, runs)
    }

    /// Quantiles of a channel's error over the runs at each time, in the channel's unit; NaN where there is none.
    pub fn quantiles<const N: usize>(&self, nth: usize, channel: usize, shares: [f64; N]) -> Vec<[f64; N]> {
        let one = |errors: &Vec<Vec<f32>>| {
            let mut errors: Vec<f64> = errors[channel].iter().copied().map(f64::from).collect();
            sort_numbers(&mut errors);
            shares.map(|share| quantile(&errors, share))
        };
        self.filters[nth].errors.iter().map(one).collect()
    }

    /// The standard deviation that the filter states for a channel at each time: root of the mean variance over the runs.
    pub fn std(&self, nth: usize, channel: usize) -> impl Iterator<Item = f64> {
        self.filters[nth].variances.iter().map(move |variances| {
            let (sum, runs) = variances[channel];
            libm::sqrt(sum / f64::from(runs))
        })
    }

    /// The root mean square error of a channel over the runs at each time.
    pub fn rmse(&self, nth: usize, channel: usize) -> impl Iterator<Item = f64> {
        self.filters[nth].errors.iter().map(move |errors| {
            let squares: f64 = errors[channel].iter().map(|&error| f64::from(error) * f64::from(error)).sum();
            libm::sqrt(squares / errors[channel].len() as f64)
        })
    }

    /// The last errors of a channel, one for each run that knows its truth, in the order in which they came.
    pub fn last_errors(&self, nth: usize, channel: usize) -> &[LastError] {
        &self.filters[nth].last[channel]
    }

    /// The number of runs of the `nth` filter with each verdict, in the order of [`VerdictKind::ALL`].
    pub fn verdicts(&self, nth: usize) -> &[usize] {
        &self.filters[nth].verdicts
    }

    /// The last estimates of a channel, one a seed in the order in which they came.
    pub fn finals(&self, nth: usize, channel: usize) -> &[f64] {
        &self.filters[nth].finals[channel]
    }
}

/// The 95 % interval of a share, of which `count` of `of` were seen. NaN if none was looked at.
///
/// Source: Wilson (1927), Probable inference, the law of succession, and statistical inference, *Journal of the American
/// Statistical Association* 22.
pub fn share_interval(count: usize, of: usize) -> [f64; 2] {
    const Z: f64 = 1.959_963_984_540_054;
    let (n, share) = (of as f64, count as f64 / of as f64);
    let middle = share + Z * Z / (2.0 * n);
    let half = Z * libm::sqrt(share * (1.0 - share) / n + Z * Z / (4.0 * n * n));
    [middle - half, middle + half].map(|end| (end / (1.0 + Z * Z / n)).clamp(0.0, 1.0))
}

/// Interpolated between neighbours.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let place = share * last as f64;
    let (low, rest) = (place.floor() as usize, place.fract());
    let (a, b) = (sorted[low], sorted[(low + 1).min(last)]);
    a + rest * (b - a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Runner;
    use kalmanscope_core::{FilterKind, Run, Source};

    /// A linear filter that knows the true model: its theory is exact.
    fn scenario(noise: f64) -> Scenario {
        let text = "duration = 10.0\n[plant]\nnatural_frequency = 6.0\ndisturbance_std = 2.0\n[plant.initial]\ndisplacement = 0.0\n\
                    [[sensors]]\nmeasures = \"displacement\"\nnoise_std = 0.02\n[[filters]]\nkind = \"kf\"\n\
                    [filters.initial_mean]\nnatural_frequency = 6.0\ndamping_ratio = 0.05\n\
                    [filters.initial_std]\ndisplacement = 0.0\nvelocity = 0.0\n\
                    [filters.process_std]\ndisplacement = 0.0\nvelocity = 0.02\n";
        let mut scenario = Scenario::from_toml(text).unwrap();
        assert_eq!(scenario.filters[0].kind, FilterKind::KF);
        let damping = scenario.plant.parameter(Channel::DAMPING_RATIO).unwrap().at(0.0);
        scenario.filters[0].initial_mean[Channel::DAMPING_RATIO] = damping;
        let (sensors, process) = scenario.true_noise();
        scenario.filters[0].sensor_std = sensors.iter().map(|std| noise * std).collect();
        scenario.filters[0].process_std = process;
        scenario
    }

    fn statistics(scenario: Scenario, seeds: usize) -> (MonteCarlo, Ensemble) {
        let ensemble = MonteCarlo::ensemble(scenario, vec![0], seeds, 20, false).unwrap();
        let runner = Runner::new(ensemble.clone(), Source::Simulated).unwrap();
        let mut statistics = MonteCarlo::new(&ensemble);
        for cell in 0..seeds {
            statistics.take(&ensemble, &Slice { cells: vec![cell], rows: runner.rows(&[cell]) });
        }
        (statistics, ensemble)
    }

    #[test]
    fn the_theory_of_a_linear_filter_holds() {
        let (all, _) = statistics(scenario(1.0), 400);
        assert_eq!((all.done(), all.diverged(0)), (400, [0.0, 0.0]));
        let inside = |values: Vec<f64>, degrees: usize| {
            let interval = MonteCarlo::interval(degrees, 400).unwrap();
            values.iter().filter(|value| interval.contains(value)).count()
        };
        // 20 times; 95 % of them are expected.
        assert!(inside(all.nees(0).collect(), 2) >= 15, "{:?}", all.nees(0).collect::<Vec<_>>());
        assert!(inside(all.nis(0).collect(), 1) >= 15, "{:?}", all.nis(0).collect::<Vec<_>>());
        for (rmse, std) in all.rmse(0, 0).zip(all.std(0, 0)).skip(2) {
            assert!((rmse / std - 1.0).abs() < 0.15, "{rmse} {std}");
        }
        for ([low, middle, high], std) in
            all.quantiles(0, 0, [0.025, 0.5, 0.975]).into_iter().zip(all.std(0, 0)).skip(2)
        {
            assert!(low < middle && middle < high);
            assert!(((high - low) / (3.92 * std) - 1.0).abs() < 0.25, "{low} {high} {std}");
        }
    }

    #[test]
    fn a_filter_that_takes_its_sensor_for_better_is_found_out() {
        let (all, _) = statistics(scenario(0.3), 100);
        let interval = MonteCarlo::interval(1, 100).unwrap();
        assert!(all.nis(0).all(|nis| nis > *interval.end()));
    }

    #[test]
    fn a_trace_has_the_numbers_of_the_run_on_a_screen() {
        let (all, ensemble) = statistics(scenario(1.0), 1);
        let mut run = Run::new(&ensemble.at(0)).unwrap();
        run.finish();
        let estimates = &run.estimates()[0];
        let truth = run.record().truth(Channel::DISPLACEMENT).unwrap();
        for ((&k, nis), [error]) in all.samples().iter().zip(all.nis(0)).zip(all.quantiles(0, 0, [0.5])) {
            assert_eq!(nis, estimates.nis()[k]);
            assert!((error - (estimates.mean(k)[0] - truth[k])).abs() < 1e-7);
        }
        assert_eq!(all.finals(0, 0), [estimates.mean(estimates.len() - 1)[0]]);
    }

    #[test]
    fn times_are_no_more_than_the_samples() {
        let short = Scenario { duration: 0.1, ..Scenario::default() };
        let ensemble = MonteCarlo::ensemble(short, vec![0, 1], 3, 200, false).unwrap();
        assert_eq!(ensemble.trace().samples(), (1..=10).collect::<Vec<_>>());
        assert_eq!(ensemble.width(), 2 * (2 + 3 * 4) + 2 * 10 * 10);
    }

    /// Oscillators and guesses drawn at random, some of them impossible.
    #[test]
    fn a_population_is_counted() {
        let mut scenario = Scenario { duration: 20.0, ..Scenario::default() };
        scenario.filters.truncate(1);
        let law = |text: &str| (text.to_owned(), kalmanscope_core::scenario::Law::Normal([0.05, 0.05]));
        scenario.draw.extend([law("plant.damping_ratio"), law("filters.1.initial_mean.damping_ratio")]);
        let seeds = 200;
        let ensemble = MonteCarlo::ensemble(scenario.clone(), vec![0], seeds, 5, true).unwrap();
        let runner = Runner::new(ensemble.clone(), Source::Simulated).unwrap();
        let mut statistics = MonteCarlo::new(&ensemble);
        let cells: Vec<usize> = (0..seeds).collect();
        let rows = runner.rows(&cells);
        statistics.take(&ensemble, &Slice { cells, rows });
        let is_possible = |cell: &usize| ensemble.at(*cell).validate().is_ok();
        let possible: Vec<usize> = (0..seeds).filter(is_possible).collect();
        assert_eq!((statistics.done(), statistics.impossible()), (seeds, seeds - possible.len()));
        assert_eq!(statistics.runs(), possible.len());
        assert!((20..45).contains(&statistics.impossible()), "{}", statistics.impossible());
        // A member is what its seed draws.
        let places = ensemble.trace();
        let damping = places.channels(0).iter().position(|&channel| channel == Channel::DAMPING_RATIO).unwrap();
        let truth = |cell: usize| ensemble.at(cell).plant.parameter(Channel::DAMPING_RATIO).unwrap().at(0.0);
        for (last, &cell) in statistics.last_errors(0, damping).iter().zip(&possible) {
            assert!((last.truth - truth(cell)).abs() < 1e-12);
        }
        assert_eq!(ensemble.member(3), [ensemble.at(3).filters[0].initial_mean[Channel::DAMPING_RATIO], truth(3)]);
        assert_eq!(statistics.verdicts(0).iter().sum::<usize>(), possible.len());
        // A draw is of no use without seeds, and may not be an axis beside them.
        let plan = |axis: &str| Plan { filters: vec![0], axes: vec![Axis::parse(axis).unwrap()], ..Plan::default() };
        let other = Ensemble::new(scenario.clone(), plan("filters.1.fading=1:1.1:3")).unwrap();
        assert_eq!((other.drawn().len(), other.at(0).plant), (0, scenario.plant.clone()));
        let mut both = plan("seed=1:9:9");
        both.axes.push(Axis::parse("plant.damping_ratio=0.01:0.1:3").unwrap());
        assert!(Ensemble::new(scenario, both).unwrap_err().to_string().contains("is drawn for each seed"));
    }

    /// Guesses drawn at random over one measured record.
    #[test]
    fn guesses_are_drawn_over_a_given_record() {
        let mut scenario = Scenario { duration: 10.0, ..Scenario::default() };
        let record = std::sync::Arc::new(kalmanscope_core::simulate(&scenario));
        let law = kalmanscope_core::scenario::Law::LogUniform([3.0, 20.0]);
        scenario.draw.insert("filters.*.initial_mean.natural_frequency".to_owned(), law);
        let ensemble = MonteCarlo::ensemble(scenario.clone(), vec![0, 1], 12, 0, false).unwrap();
        let runner = Runner::new(ensemble, Source::Measured(std::sync::Arc::clone(&record))).unwrap();
        assert!(runner.runs(&[0, 5, 11]).iter().flatten().all(|run| std::sync::Arc::ptr_eq(&run.record, &record)));
        scenario.draw.insert("plant.damping_ratio".to_owned(), law);
        let ensemble = MonteCarlo::ensemble(scenario, vec![0], 12, 0, false).unwrap();
        let error = Runner::new(ensemble, Source::Measured(record)).err().unwrap().to_string();
        assert!(error.contains("`seed` is none"), "{error}");
    }
}
