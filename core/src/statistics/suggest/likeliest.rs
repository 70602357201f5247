//! The likeliest of some settings: runs of a trial, a slice after the other, and the search for the sizes of several noises.

use std::ops::Range;

use kalmanscope_filters::Channel;
use kalmanscope_filters::lists::numbers;
use kalmanscope_records::Record;

use crate::{FreeRun, Identified, Run, Running, Scenario, Sensor};

const FREE: usize = 16_384;

const CHUNK: usize = 200;

#[derive(Default)]
pub(super) struct Trial {
    run: Option<Run>,
    free: Option<Running>,
}

impl Trial {
    /// Runs it on the first samples of a record. `None` while it is under way, `Some(None)` where it is impossible.
    #[expect(clippy::option_option, reason = "a trial is under way, impossible or done")]
    pub(super) fn follow(
        &mut self,
        scenario: impl FnOnce() -> Scenario,
        record: &Record,
        samples: usize,
        while_time: &mut dyn FnMut() -> bool,
    ) -> Option<Option<Run>> {
        if self.run.is_none() {
            let part = record.part(0..record.len().min(samples));
            self.run = Run::on_record(&scenario(), part.into()).ok();
        }
        let Some(run) = &mut self.run else { return Some(None) };
        while run.done() < run.samples() {
            run.advance_to(run.done() + CHUNK);
            if !while_time() && run.done() < run.samples() {
                return None;
            }
        }
        Some(self.run.take())
    }

    /// Runs it, then a free run of its final model, which has an error for each sensor. `None` while it is under way.
    pub(super) fn follow_freely(
        &mut self,
        scenario: impl FnOnce() -> Scenario,
        record: &Record,
        while_time: &mut dyn FnMut() -> bool,
    ) -> Option<(Option<Run>, Option<Vec<f64>>)> {
        if self.free.is_none() {
            let run = self.follow(scenario, record, FREE, while_time)?;
            self.free = run.as_ref().and_then(begin_freely);
            if self.free.is_none() {
                return Some((run, None));
            }
            self.run = run;
        }
        if let (Some(running), Some(run)) = (self.free.as_mut(), &self.run)
            && !running.advance(run.record(), while_time)
        {
            return None;
        }
        let (run, running) = (self.run.take(), self.free.take());
        let errors = run.as_ref().zip(running).and_then(|(run, free)| errors(run, &free.finish(run.record())));
        Some((run, errors))
    }
}

fn begin_freely(run: &Run) -> Option<Running> {
    let (scenario, record) = (run.scenario(), run.record());
    let estimates = run.estimates().first().filter(|estimates| estimates.stop().is_none())?;
    let model = Identified::at(scenario, &scenario.filters[0], estimates, estimates.len().checked_sub(1)?);
    Some(model.running(record, 0..record.len()))
}

fn errors(run: &Run, free: &FreeRun) -> Option<Vec<f64>> {
    let of = |sensor: &Sensor| free.fit(run.record(), sensor.measures).map(|fit| fit.rms);
    let errors = run.scenario().sensors.iter().map(of).collect::<Option<Vec<f64>>>();
    errors.filter(|errors| errors.iter().all(|error| error.is_finite()))
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

#[derive(Clone, Debug)]
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

#[derive(Clone, Debug)]
pub(super) struct Climb {
    pub(super) found: Likeliest<Vec<f64>>,
    sizes: usize,
    round: usize,
    size: usize,
    is_down: bool,
    has_moved: bool,
}

const FACTORS: [f64; 3] = [4.0, 2.0, std::f64::consts::SQRT_2];
/// A change is for the better if the log likelihood rises by more than this.
const BETTER: f64 = 0.5;
const MOST: usize = 48;
const FAR: f64 = 1e9;

impl Climb {
    pub(super) fn new(sizes: usize) -> Self {
        Self { found: Likeliest::new(), sizes, round: 0, size: 0, is_down: false, has_moved: false }
    }

    fn factors(&self) -> Vec<f64> {
        self.found.best.as_ref().map_or_else(|| vec![1.0; self.sizes], |(factors, _)| factors.clone())
    }

    pub(super) fn next(&self) -> Option<Vec<f64>> {
        let mut factors = self.factors();
        if self.found.trials > 0 {
            let factor = *FACTORS.get(self.round).filter(|_| self.found.trials < MOST)?;
            factors[self.size] *= if self.is_down { 1.0 / factor } else { factor };
        }
        Some(factors)
    }

    pub(super) fn take(&mut self, likelihood: Option<f64>) {
        let Some(factors) = self.next() else { return };
        let is_first = self.found.trials == 0;
        let is_better = self.found.take(factors, likelihood, BETTER);
        let is_near = (1.0 / FAR..FAR).contains(&self.factors()[self.size]);
        if is_first || (is_better && is_near) {
            self.has_moved = !is_first;
            return;
        }
        let is_over = self.is_down || self.has_moved;
        (self.is_down, self.has_moved) = (!is_over, false);
        let place = self.round * self.sizes + self.size + usize::from(is_over);
        (self.round, self.size) = (place / self.sizes, place % self.sizes);
    }

    pub(super) fn progress(&self) -> f64 {
        (self.round * self.sizes + self.size) as f64 / (FACTORS.len() * self.sizes) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_climb_finds_a_summit_that_is_far_away_and_passes_over_trials_without_a_likelihood() {
        for summit in [[1.0, 1.0], [3e4, 0.02], [2e-5, 700.0]] {
            let mut climb = Climb::new(2);
            while let Some(factors) = climb.next() {
                let off: f64 = factors.iter().zip(summit).map(|(a, b)| libm::log(a / b)).map(|x| 30.0 * x * x).sum();
                climb.take(Some(-off));
            }
            let (best, _) = climb.found.best.as_ref().unwrap();
            for (found, at) in best.iter().zip(summit) {
                assert!((found / at).ln().abs() < 0.25, "{best:?} {summit:?}");
            }
            assert!(climb.found.trials < MOST && climb.progress() >= 1.0, "{}", climb.found.trials);
        }
        let mut climb = Climb::new(2);
        while climb.next().is_some() {
            climb.take(None);
        }
        assert!(climb.found.best.is_none());
    }
}
