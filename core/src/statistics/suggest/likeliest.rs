//! The likeliest of some settings: runs of a trial, a slice after the other, and the search for the sizes of several noises.

use std::ops::Range;

use kalmanscope_filters::Channel;
use kalmanscope_filters::lists::numbers;
use kalmanscope_records::Record;
use kalmanscope_records::task::pause;

use crate::{Identified, Run, Scenario, Sensor};

const FREE: usize = 16_384;

const CHUNK: usize = 200;

pub(super) async fn tried(scenario: &Scenario, record: &Record, samples: usize) -> Option<Run> {
    let part = record.part(0..record.len().min(samples));
    let mut run = Run::on_record(scenario, part.into()).ok()?;
    while run.done() < run.samples() {
        run.advance_to(run.done() + CHUNK);
        pause().await;
    }
    Some(run)
}

/// A run, and the errors of a free run of its final model, one for each sensor.
pub(super) async fn tried_freely(scenario: &Scenario, record: &Record) -> Option<(Run, Option<Vec<f64>>)> {
    let run = tried(scenario, record, FREE).await?;
    let estimates = run.estimates().first().filter(|estimates| estimates.stop().is_none() && !estimates.is_empty());
    let Some(estimates) = estimates else { return Some((run, None)) };
    let model = Identified::at(run.scenario(), &run.scenario().filters[0], estimates, estimates.len() - 1);
    let free = model.run_in_pieces(run.record(), 0..run.record().len(), |_| ()).await;
    let of = |sensor: &Sensor| free.fit(run.record(), sensor.measures).map(|fit| fit.rms);
    let errors = scenario.sensors.iter().map(of).collect::<Option<Vec<f64>>>();
    let errors = errors.filter(|errors| errors.iter().all(|error| error.is_finite()));
    Some((run, errors))
}

pub(super) fn likelihood(run: &Run) -> Option<f64> {
    likelihood_over(run, 1..run.estimates().first()?.len()).map(|(sum, _)| sum)
}

pub(super) fn likelihood_over(run: &Run, samples: Range<usize>) -> Option<(f64, u32)> {
    let estimates = run.estimates().first().filter(|estimates| estimates.stop().is_none())?;
    let counted = samples.map(|k| (estimates.log_likelihood(k), estimates.readings(k))).filter(|(l, _)| !l.is_nan());
    let (sum, readings) = counted.fold((0.0, 0), |(sum, all), (l, readings)| (sum + l, all + readings));
    sum.is_finite().then_some((sum, readings))
}

/// The size of each sensor's innovations over their expected size, in the second half: a filter finds its parameters in the first one.
pub(super) fn sizes(run: &Run) -> Vec<f64> {
    let Some(estimates) = run.estimates().first() else { return Vec::new() };
    let sensors = estimates.sensors().len();
    let size = |i: usize| {
        let square = |k: usize| {
            let (e, cov) = (estimates.innovation(k).get(i)?, estimates.innovation_cov(k).get(i * sensors + i)?);
            Some(e * e / cov).filter(|square| !square.is_nan())
        };
        let half = (estimates.len() / 2..estimates.len()).filter_map(square);
        let (sum, count) = half.fold((0.0, 0_u32), |(sum, count), square| (sum + square, count + 1));
        Some(libm::sqrt(sum / f64::from(count))).filter(|size| size.is_finite()).unwrap_or(1.0)
    };
    numbers(sensors, &size)
}

pub(super) fn surprise(run: &Run) -> f64 {
    let sizes = sizes(run);
    let mean = sizes.iter().map(|size| size * size).sum::<f64>() / sizes.len().max(1) as f64;
    libm::sqrt(mean).clamp(0.1, 10.0)
}

/// σ of ωₙ over ωₙ at the end of a record of some samples, of which a run has the first ones. `None` where no filter estimates it.
pub(super) fn frequency_error(run: &Run, samples: usize) -> Option<f64> {
    let estimates = run.estimates().first().filter(|estimates| estimates.stop().is_none())?;
    let (place, last) = (estimates.place(Channel::NATURAL_FREQUENCY)?, estimates.len().checked_sub(1)?);
    let share = estimates.len() as f64 / samples as f64;
    let error = libm::sqrt(share) * estimates.std(last, place) / estimates.canonical_mean(last, place).abs();
    Some(error).filter(|error| *error > 0.0)
}

pub(super) fn first_alone(scenario: &Scenario) -> Scenario {
    Scenario { filters: scenario.filters.iter().take(1).cloned().collect(), ..scenario.clone() }
}

pub(super) struct Likeliest<P> {
    pub(super) best: Option<(P, f64)>,
    pub(super) trials: usize,
}

impl<P> Likeliest<P> {
    pub(super) const fn new() -> Self {
        Self { best: None, trials: 0 }
    }

    /// Takes in a trial, which is better if its log likelihood is larger by more than a `margin`. Returns whether it is.
    pub(super) fn take(&mut self, point: P, likelihood: Option<f64>, margin: f64) -> bool {
        self.trials += 1;
        let before = self.best.as_ref().map_or(f64::NEG_INFINITY, |(_, before)| *before);
        let better = likelihood.filter(|now| *now > before + margin).map(|now| (point, now));
        let is_better = better.is_some();
        self.best = better.or_else(|| self.best.take());
        is_better
    }
}

const FACTORS: [f64; 3] = [4.0, 2.0, std::f64::consts::SQRT_2];
/// A change is for the better if the log likelihood rises by more than this.
const BETTER: f64 = 0.5;
pub(super) const MOST: usize = 48;
const FAR: f64 = 1e9;

/// The factors of some sizes with the largest log likelihood: each is multiplied, or else divided, as long as that rises.
pub(super) async fn climbed<F: Future<Output = Option<f64>>>(
    sizes: usize,
    mut trial: impl FnMut(Vec<f64>) -> F,
) -> Likeliest<Vec<f64>> {
    let mut found = Likeliest::new();
    let begin = vec![1.0; sizes];
    found.take(begin.clone(), trial(begin.clone()).await, BETTER);
    for (factor, size) in FACTORS.into_iter().flat_map(|factor| (0..sizes).map(move |size| (factor, size))) {
        for by in [factor, 1.0 / factor] {
            let mut has_moved = false;
            while found.trials < MOST {
                let best = |found: &Likeliest<Vec<f64>>| found.best.as_ref().map_or(&begin, |(best, _)| best).clone();
                let mut factors = best(&found);
                factors[size] *= by;
                let likelihood = trial(factors.clone()).await;
                let is_better = found.take(factors, likelihood, BETTER);
                if !(is_better && (1.0 / FAR..FAR).contains(&best(&found)[size])) {
                    break;
                }
                has_moved = true;
            }
            if has_moved {
                break;
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use kalmanscope_records::task::at_once;

    use super::*;

    #[test]
    fn a_climb_finds_a_summit_that_is_far_away_and_passes_over_trials_without_a_likelihood() {
        let off = |factors: &[f64], summit: [f64; 2]| -> f64 {
            factors.iter().zip(summit).map(|(a, b)| libm::log(a / b)).map(|x| 30.0 * x * x).sum()
        };
        for summit in [[1.0, 1.0], [3e4, 0.02], [2e-5, 700.0]] {
            let trial = |factors: Vec<f64>| std::future::ready(Some(-off(&factors, summit)));
            let Likeliest { best, trials } = at_once(climbed(2, trial));
            let best = best.unwrap().0;
            for (found, at) in best.iter().zip(summit) {
                assert!((found / at).ln().abs() < 0.25, "{best:?} {summit:?}");
            }
            assert!(trials < MOST, "{trials}");
        }
        assert!(at_once(climbed(2, |_| std::future::ready(None))).best.is_none());
    }
}
