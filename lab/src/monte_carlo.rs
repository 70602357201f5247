//! The statistics of many runs that differ in their seeds: other noise each time, or the members of a population.

use std::ops::RangeInclusive;

use kalmanscope_core::diagnostics::chi_squared;
use kalmanscope_core::internals::sort_numbers;
use kalmanscope_core::{Axis, Channel, Scenario, Spacing};
use kalmanscope_diagnosis::CAUSES;
use kalmanscope_diagnosis::{Measure, VerdictKind};

use crate::{Ensemble, EnsembleError, Plan, Slice, Trace};

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

/// The judgement on each run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunVerdicts {
    /// Nothing.
    Not,
    /// Its verdict, which takes longer than the run.
    Verdicts,
    /// Also the first cause of a bad verdict, which takes up to seconds.
    Causes,
}

#[derive(Clone, Debug, Default)]
struct Filter {
    squares: Vec<[(f64, u32); 2]>,
    errors: Vec<Vec<Vec<f32>>>,
    variances: Vec<Vec<(f64, u32)>>,
    finals: Vec<Vec<f64>>,
    last: Vec<Vec<LastError>>,
    verdicts: Vec<usize>,
    causes: Vec<usize>,
    unexplained: usize,
    diverged: usize,
    stopped: usize,
}

impl MonteCarlo {
    /// The ensemble of a scenario's filters with the seeds 1 to `seeds`, and a trace of `times` times for each run.
    ///
    /// # Errors
    /// [`EnsembleError`] where the scenario is impossible or lacks a filter.
    pub fn ensemble(
        scenario: Scenario,
        filters: Vec<usize>,
        seeds: usize,
        times: usize,
        judged: RunVerdicts,
    ) -> Result<Ensemble, EnsembleError> {
        let channels = crate::channels(&scenario, &filters);
        let judged: &[Measure] = match judged {
            RunVerdicts::Not => &[],
            RunVerdicts::Verdicts => &[Measure::VERDICT],
            RunVerdicts::Causes => &[Measure::VERDICT, Measure::CAUSE],
        };
        let flags = [Measure::DIVERGED, Measure::STOPPED].into_iter().chain(judged.iter().copied());
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
            let channels = trace.channels(nth).len();
            Filter {
                squares: vec![[(0.0, 0); 2]; times],
                errors: vec![vec![Vec::new(); channels]; times],
                variances: vec![vec![(0.0, 0); channels]; times],
                finals: vec![Vec::new(); channels],
                last: vec![Vec::new(); channels],
                verdicts: vec![0; VerdictKind::ALL.len()],
                causes: vec![0; CAUSES.len()],
                ..Filter::default()
            }
        };
        let filters = (0..ensemble.plan().filters.len()).map(filter).collect();
        Self { filters, trace, measures: ensemble.plan().measures.len(), done: 0, impossible: 0 }
    }

    /// Takes in the rows of some seeds, each once.
    pub fn take(&mut self, ensemble: &Ensemble, slice: &Slice) {
        for row in slice.rows.chunks_exact(ensemble.width()) {
            self.done += 1;
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
                    let place = verdict as usize;
                    filter.verdicts[place] += 1;
                    let cause = number(Measure::CAUSE);
                    if cause.is_finite() {
                        filter.causes[cause as usize] += 1;
                    } else if measures.contains(&Measure::CAUSE) && !VerdictKind::ALL[place].is_good() {
                        filter.unexplained += 1;
                    }
                }
                for (place, &channel) in self.trace.channels(nth).iter().enumerate() {
                    let estimate = number(Measure::estimate(channel));
                    filter.finals[place].push(estimate);
                    let (error, std) = (number(Measure::error(channel)), number(Measure::std(channel)));
                    if error.is_finite() {
                        filter.last[place].push(LastError { error, truth: estimate - error, std });
                    }
                }
                for time in 0..self.trace.samples().len() {
                    for (sum, square) in filter.squares[time].iter_mut().zip(self.trace.squares(row, nth, time)) {
                        if square.is_finite() {
                            *sum = (sum.0 + square, sum.1 + 1);
                        }
                    }
                    for channel in 0..filter.finals.len() {
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
        self.trace.channels(nth)
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

    /// The runs of the `nth` filter in which each of [`CAUSES`] comes first, of those with a bad verdict; and those without any cause.
    pub fn causes(&self, nth: usize) -> (&[usize], usize) {
        let Filter { causes, unexplained, .. } = &self.filters[nth];
        (causes, *unexplained)
    }

    /// The last estimates of a channel, one a seed in the order in which they came.
    pub fn finals(&self, nth: usize, channel: usize) -> &[f64] {
        &self.filters[nth].finals[channel]
    }
}

fn quantile(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let place = share * last as f64;
    let (low, rest) = (place.floor() as usize, place.fract());
    let (a, b) = (sorted[low], sorted[(low + 1).min(last)]);
    a + rest * (b - a)
}

/// The 95 % interval of a share, of which `count` of `of` were seen. NaN if none was looked at.
///
/// Source: Wilson (1927), Probable inference, the law of succession, and statistical inference, *Journal of the American
/// Statistical Association* 22.
pub fn share_interval(count: usize, of: usize) -> [f64; 2] {
    const Z: f64 = chi_squared::NORMAL_95;
    let (n, share) = (of as f64, count as f64 / of as f64);
    let middle = share + Z * Z / (2.0 * n);
    let half = Z * libm::sqrt(share * (1.0 - share) / n + Z * Z / (4.0 * n * n));
    [middle - half, middle + half].map(|end| (end / (1.0 + Z * Z / n)).clamp(0.0, 1.0))
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
