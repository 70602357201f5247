//! Several filters side by side from guesses of the natural frequency that are far apart.

use crate::data::record::Parts;
use crate::samples::estimator::Estimator;
use crate::samples::sink::{LastSample, Sink};
use crate::{Channel, FilterError, FilterSettings};

/// A filter that begins from several guesses of ωₙ, spread evenly in its logarithm from e⁻² to e² times the initial
/// mean. Each guess has a filter of its own, and the likeliest so far is reported. Every 500 measured samples, each
/// filter that is 30 behind the likeliest in log likelihood and has not gained on it since the last check is dropped,
/// so that one remains in the end.
///
/// Source: Magill (1965), Optimal adaptive estimation of sampled stochastic processes (a bank of filters, weighed by their
/// likelihoods).
pub(crate) struct Guesses {
    members: Vec<Member>,
    /// The place of the likeliest.
    leader: usize,
    /// The measured samples so far.
    measured: usize,
}

/// The filter of one guess.
struct Member {
    estimator: Box<dyn Estimator>,
    last: LastSample,
    log_likelihood: f64,
    /// The amount by which its log likelihood was below the likeliest at the last check.
    behind: f64,
}

/// The outermost guesses are e^±2 times the initial mean: 0.14 and 7.4 times.
const REACH: f64 = 2.0;

/// The measured samples between two checks for filters that are far behind.
const LOOK: usize = 500;

/// Limits the amount by which a guess may be below the likeliest in log likelihood.
const FAR_BEHIND: f64 = 30.0;

/// The settings of the filters of all guesses, the nearest to the initial mean first. A guess's standard deviation is
/// at least about half the distance to the next guess, in logarithms.
pub(crate) fn members(settings: &FilterSettings) -> Vec<FilterSettings> {
    let count = settings.guesses;
    let place = |i: usize| 2.0 * REACH * i as f64 / (count - 1) as f64 - REACH;
    let mut logarithms: Vec<f64> = (0..count).map(place).collect();
    logarithms.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
    let of = |logarithm: f64| {
        let mut member = FilterSettings { guesses: 1, ..settings.clone() };
        let mean = settings.initial_mean[Channel::NATURAL_FREQUENCY] * libm::exp(logarithm);
        member.initial_mean[Channel::NATURAL_FREQUENCY] = mean;
        let std = &mut member.initial_std[Channel::NATURAL_FREQUENCY];
        *std = std.max(REACH / count as f64 * mean);
        member
    };
    logarithms.into_iter().map(of).collect()
}

impl Guesses {
    /// Of filters that begin from different guesses; there must be one.
    pub(crate) fn new(estimators: impl IntoIterator<Item = Box<dyn Estimator>>) -> Self {
        let member = |estimator| Member { estimator, last: LastSample::default(), log_likelihood: 0.0, behind: 0.0 };
        Self { members: estimators.into_iter().map(member).collect(), leader: 0, measured: 0 }
    }

    /// Gives up the filters that are far behind and do not gain.
    fn look(&mut self) {
        let Self { members, leader, .. } = self;
        let best = members[*leader].log_likelihood;
        let mut place = 0;
        let first = *leader;
        members.retain_mut(|member| {
            let behind = best - member.log_likelihood;
            let is_kept = place == first || behind < FAR_BEHIND || behind < member.behind;
            member.behind = behind;
            if place < first && !is_kept {
                *leader -= 1;
            }
            place += 1;
            is_kept
        });
    }
}

impl Estimator for Guesses {
    fn begin(&self, sink: &mut dyn Sink) -> Result<(), FilterError> {
        self.members[self.leader].estimator.begin(sink)
    }

    fn step(
        &mut self,
        force_before: f64,
        force: f64,
        measured: &[f64],
        sink: &mut dyn Sink,
    ) -> Result<(), FilterError> {
        let is_measured = measured.iter().any(|value| !value.is_nan());
        self.step_all(is_measured, sink, |member, sink| member.step(force_before, force, measured, sink))
    }

    fn step_through(&mut self, parts: &Parts, sink: &mut dyn Sink) -> Result<(), FilterError> {
        let is_measured = parts.iter().any(|(_, readings)| readings.iter().any(|value| !value.is_nan()));
        self.step_all(is_measured, sink, |member, sink| member.step_through(parts, sink))
    }
}

impl Guesses {
    /// Lets all filters take a step, and reports the likeliest.
    fn step_all(
        &mut self,
        is_measured: bool,
        sink: &mut dyn Sink,
        step: impl Fn(&mut dyn Estimator, &mut dyn Sink) -> Result<(), FilterError>,
    ) -> Result<(), FilterError> {
        let mut reason = FilterError::NotFinite;
        let wants_prior = sink.wants_prior();
        self.members.retain_mut(|member| {
            member.last.want_prior(wants_prior);
            let step = step(&mut *member.estimator, &mut member.last);
            reason = step.err().unwrap_or(reason);
            let gained = member.last.sample().ln_likelihood();
            member.log_likelihood += if gained.is_nan() { 0.0 } else { gained };
            step.is_ok() && member.log_likelihood.is_finite()
        });
        let likelihood = |place: &usize| self.members[*place].log_likelihood;
        // The first of those that are alike, which is the nearest to the initial mean.
        let likeliest = (0..self.members.len()).rev().max_by(|a, b| likelihood(a).total_cmp(&likelihood(b)));
        self.leader = likeliest.ok_or(reason)?;
        sink.push(&self.members[self.leader].last.sample());
        if is_measured {
            self.measured += 1;
            if self.measured.is_multiple_of(LOOK) {
                self.look();
            }
        }
        Ok(())
    }
}
