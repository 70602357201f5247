//! Several filters side by side from guesses of the natural frequency that are far apart.

use super::{Member, Rule};
use crate::mathematics::lists::{numbers, sort_items};
use crate::{Channel, FilterError, FilterSettings};

/// The likeliest so far reports alone. Every 500 measured samples, each filter that is 30 behind it in log likelihood and has not
/// gained on it since the last check is left out, so that one remains in the end.
pub(crate) struct Guesses {
    /// The log likelihood of each filter, and the amount by which it was below the likeliest at the last check.
    each: Vec<[f64; 2]>,
    leader: usize,
    measured: usize,
}

/// The outermost guesses are e^±2 times the initial mean: 0.14 and 7.4 times.
const REACH: f64 = 2.0;

/// The measured samples between two checks for filters that are far behind.
const LOOK: usize = 500;

/// Limits the amount by which a guess may be below the likeliest in log likelihood.
const FAR_BEHIND: f64 = 30.0;

/// The settings of the filters of all guesses, evenly spread in the logarithm of ωₙ, the nearest to the initial mean first. A guess's
/// standard deviation is at least about half the distance to the next guess, in logarithms.
pub(crate) fn members(settings: &FilterSettings) -> Vec<FilterSettings> {
    let count = settings.guesses;
    let place = |i: usize| 2.0 * REACH * i as f64 / (count - 1) as f64 - REACH;
    let mut logarithms: Vec<f64> = numbers(count, &place);
    sort_items(&mut logarithms, |a, b| a.abs().total_cmp(&b.abs()));
    let of = |logarithm: f64| {
        let mut member = FilterSettings { guesses: 1, ..settings.clone() };
        let [mean, std] =
            [&mut member.initial_mean, &mut member.initial_std].map(|of| &mut of[Channel::NATURAL_FREQUENCY]);
        *mean *= libm::exp(logarithm);
        *std = std.max(REACH / count as f64 * *mean);
        member
    };
    logarithms.into_iter().map(of).collect()
}

impl Guesses {
    pub(crate) fn new(count: usize) -> Self {
        Self { each: vec![[0.0, f64::INFINITY]; count], leader: 0, measured: 0 }
    }
}

impl Rule for Guesses {
    fn weights(&self) -> &[f64] {
        &[]
    }

    fn leader(&self) -> Option<usize> {
        Some(self.leader)
    }

    fn update(&mut self, members: &mut [Member]) -> Result<(), FilterError> {
        let Self { each, leader, measured } = self;
        for (member, [sum, _]) in members.iter_mut().zip(&mut *each) {
            let gained = member.ln_likelihood();
            *sum += if gained.is_nan() { 0.0 } else { gained };
            if !sum.is_finite() {
                (*sum, _) = (f64::NEG_INFINITY, member.failure.get_or_insert(FilterError::NotFinite));
            }
        }
        if let (Some(reason), true) = (members[*leader].failure, members.iter().all(|member| member.failure.is_some()))
        {
            return Err(reason);
        }
        // The first of those that are alike, which is the nearest to the initial mean.
        *leader = (0..each.len()).rev().max_by(|a, b| each[*a][0].total_cmp(&each[*b][0])).unwrap_or(0);
        let is_measured = members.iter().any(Member::is_read);
        *measured += usize::from(is_measured);
        if is_measured && measured.is_multiple_of(LOOK) {
            let best = each[*leader][0];
            for (member, [sum, before]) in members.iter_mut().zip(each) {
                let behind = best - *sum;
                if behind >= FAR_BEHIND && behind >= *before {
                    (*sum, _) = (f64::NEG_INFINITY, member.failure.get_or_insert(FilterError::ImpossibleMeasurement));
                }
                *before = behind;
            }
        }
        Ok(())
    }
}
