//! Several filters side by side from guesses of the natural frequency that are far apart.

use super::{Member, Rule};
use crate::{Channel, FilterError, FilterSettings};

/// Filters that begin from several guesses of ωₙ, spread evenly in its logarithm from e⁻² to e² times the initial
/// mean; the likeliest so far is reported. Every 500 measured samples, each
/// filter that is 30 behind the likeliest in log likelihood and has not gained on it since the last check is dropped,
/// so that one remains in the end.
///
/// Source: Magill (1965), Optimal adaptive estimation of sampled stochastic processes (a bank of filters, weighed by their
/// likelihoods).
pub(crate) struct Guesses {
    /// The log likelihood of each filter, and the amount by which it was below the likeliest at the last check.
    each: Vec<[f64; 2]>,
    /// The place of the likeliest.
    leader: usize,
    /// The measured samples so far.
    measured: usize,
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
    /// Of so many filters.
    pub(crate) fn new(count: usize) -> Self {
        Self { each: vec![[0.0, f64::INFINITY]; count], leader: 0, measured: 0 }
    }

    /// Keeps some of the filters.
    fn retain(&mut self, members: &mut Vec<Member>, mut is_kept: impl FnMut(&Member, &mut [f64; 2]) -> bool) {
        let kept: Vec<bool> = members.iter().zip(&mut self.each).map(|(member, each)| is_kept(member, each)).collect();
        let (mut of_members, mut of_each) = (kept.iter(), kept.iter());
        members.retain(|_| of_members.next() == Some(&true));
        self.each.retain(|_| of_each.next() == Some(&true));
        // The first of those that are alike, which is the nearest to the initial mean.
        let likelihood = |place: &usize| self.each[*place][0];
        let likeliest = (0..self.each.len()).rev().max_by(|a, b| likelihood(a).total_cmp(&likelihood(b)));
        self.leader = likeliest.unwrap_or(0);
    }
}

impl Rule for Guesses {
    fn weights(&self) -> &[f64] {
        &[]
    }

    fn leader(&self) -> Option<usize> {
        Some(self.leader)
    }

    fn take(&mut self, members: &mut Vec<Member>) -> Result<(), FilterError> {
        let is_measured = members.iter().any(|member| member.failure.is_none() && member.last.sample().readings() > 0);
        let reason = members.iter().find_map(|member| member.failure).unwrap_or(FilterError::NotFinite);
        self.retain(members, |member, [sum, _]| {
            let gained = member.ln_likelihood();
            *sum += if gained.is_nan() { 0.0 } else { gained };
            sum.is_finite()
        });
        if members.is_empty() {
            return Err(reason);
        }
        self.measured += usize::from(is_measured);
        if is_measured && self.measured.is_multiple_of(LOOK) {
            let best = self.each[self.leader][0];
            self.retain(members, |_, [sum, before]| {
                let behind = best - *sum;
                let is_kept = behind < FAR_BEHIND || behind < *before;
                *before = behind;
                is_kept
            });
        }
        Ok(())
    }
}
