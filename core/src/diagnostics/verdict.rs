//! The verdict on a filter, in a word and in a sentence.

use std::fmt;
use std::ops::Range;

use super::chi_squared::wilson_hilferty;
use super::{Depth, Diagnostics, Total};
use crate::Estimates;

/// The verdict on a filter, and its reason.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// The verdict.
    pub kind: VerdictKind,
    /// The reason, in words and numbers.
    pub reason: String,
}

/// The consistency of a filter's standard deviations with its errors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VerdictKind {
    /// The errors agree with the standard deviations.
    Consistent,
    /// The errors are larger than the standard deviations.
    Overconfident,
    /// The errors are smaller than the standard deviations.
    Underconfident,
    /// The filter has lost the truth, or has stopped.
    Diverged,
}

/// A verdict needs at least this many measurements.
const ENOUGH: u32 = 20;
/// The record is judged in this number of equal parts, so that one sudden change does not decide the whole.
const PARTS: usize = 10;
/// At most this many parts may be bad, because a filter with fading memory needs time to follow a sudden change.
const FORGIVEN: usize = 2;
/// Limits the NIS over its expectation, on either side: a smaller deviation is tolerated even where the number of
/// samples makes it significant.
const NIS_TOLERANCE: (f64, f64) = (0.8, 1.25);
/// Limits chance: a deviation of more standard deviations than this is significant.
const NOT_CHANCE: f64 = 3.0;
/// Limits of a NEES that is too small: below the expectation minus this many standard deviations, and below this share
/// of it, the process noise is larger than caution explains.
const NEES_TOO_SMALL: (f64, f64) = (2.3, 0.08);
/// Limits the correlation of successive innovations where the truth is not known; above it they are not white.
const CORRELATED: f64 = 0.3;
/// Diverged: an error of more standard deviations than this, and larger than the truth and the initial uncertainty.
const LOST: f64 = 10.0;
/// Limits of wind-up: a parameter's standard deviation is this many times the initial one, and grows by this factor in
/// a third of the record.
const WIND_UP: (f64, f64) = (3.0, 1.5);
/// A parameter whose standard deviation is still above this share of the initial one has not been identified.
const UNLEARNT: f64 = 0.5;

impl VerdictKind {
    /// The verdict in a word.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Consistent => "consistent",
            Self::Overconfident => "overconfident",
            Self::Underconfident => "underconfident",
            Self::Diverged => "diverged",
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { kind, reason } = self;
        write!(f, "{}: {reason}", kind.name())
    }
}

impl Diagnostics {
    /// The verdict; `None` with fewer than 20 measurements, and at the depth
    /// [`Depth::Consistency`](super::Depth::Consistency). `estimates` are those that the diagnostics follow.
    ///
    /// The record so far is judged in ten equal parts, of which two may be bad. The first verdict that applies counts:
    /// - diverged: the filter has stopped, or in the last fifth a channel's error is more than 10σ and larger than the
    ///   truth ever was and than what was thought possible at first;
    /// - underconfident by wind-up: a parameter's σ is thrice what it was at first and still grows;
    /// - overconfident: NEES above the 99.9 % quantile of χ², or NIS above 1.25 times its expectation and what chance
    ///   allows; or, where the truth is not known, innovations with a correlation above 0.3;
    /// - underconfident: half of the parts have a NIS below 0.8 times its expectation and what chance allows, or a NEES
    ///   below 0.08 times and what chance allows a single sample;
    /// - consistent otherwise.
    pub fn verdict(&self, estimates: &Estimates) -> Option<Verdict> {
        if let Some(stop) = self.stop() {
            let before = self.wound_up(estimates).map_or(String::new(), |reason| format!("; before, {reason}"));
            let reason = format!("{}{before}", stop.reason);
            return Some(Verdict { kind: VerdictKind::Diverged, reason });
        }
        let nis = self.nis_within(0..self.len());
        if nis.samples < ENOUGH || self.depth != Depth::All {
            return None;
        }
        let lost = self.lost(estimates).map(|reason| (VerdictKind::Diverged, reason));
        let (kind, reason) = lost
            .or_else(|| Some((VerdictKind::Underconfident, self.wound_up(estimates)?)))
            .or_else(|| Some((VerdictKind::Overconfident, self.too_sure()?)))
            .or_else(|| Some((VerdictKind::Underconfident, self.too_modest()?)))
            .unwrap_or_else(|| (VerdictKind::Consistent, self.fits(estimates)));
        let only = if self.share_in_ellipsoid().is_none() { " (the truth is not known: innovations only)" } else { "" };
        Some(Verdict { kind, reason: reason + only })
    }

    /// A channel whose error has left all limits.
    fn lost(&self, estimates: &Estimates) -> Option<String> {
        let last = self.len().checked_sub(1)?;
        let recent = self.len() * 4 / 5..self.len();
        self.accuracy.known().iter().enumerate().find_map(|(at, known)| {
            let rmse = self.accuracy.within(at, recent.clone()).rmse();
            let (first, std) = (estimates.initial_std(known.place), estimates.std(last, known.place));
            let bound = known.largest_truth.max(known.first_error).max(2.0 * first);
            (std > 0.0 && rmse > LOST * std && rmse > bound).then(|| {
                let (name, unit) = (known.channel.name(), known.channel.unit());
                let space = if unit.is_empty() { "" } else { " " };
                format!("{name} is off by {}{space}{unit}, {}σ", short(rmse), short(rmse / std))
            })
        })
    }

    /// A parameter whose standard deviation winds up for lack of excitation.
    fn wound_up(&self, estimates: &Estimates) -> Option<String> {
        let last = self.len().checked_sub(1)?;
        let parameters = estimates.channels().iter().enumerate().filter(|(_, channel)| channel.is_parameter());
        let mut growths = parameters.map(|(place, channel)| {
            let first = estimates.initial_std(place);
            let [before, now] = [self.last_third().start.min(last), last].map(|k| estimates.std(k, place));
            let growth = if now > WIND_UP.1 * before && first > 0.0 { now / first } else { 0.0 };
            (growth, channel)
        });
        let (growth, channel) = growths.find(|&(growth, _)| growth > WIND_UP.0)?;
        let name = channel.name();
        Some(format!("σ of {name} is {} times that at first and grows: nothing is learnt (wind-up)", short(growth)))
    }

    fn too_sure(&self) -> Option<String> {
        let parts = self.parts();
        let outside: Vec<f64> = parts.iter().filter(|p| p.is_far_outside()).map(|p| p.nees.per_degree()).collect();
        let surprised: Vec<f64> = parts.iter().filter(|p| p.is_surprised()).map(|p| p.nis.per_degree()).collect();
        let mut reasons = Vec::new();
        if outside.len() > FORGIVEN {
            let share = 100.0 * self.share_in_ellipsoid().unwrap_or(f64::NAN);
            let (count, level) = (outside.len(), short(median(outside.into_iter())));
            reasons.push(format!(
                "errors² are {level} times what it says in {count} of {PARTS} parts of the record, the truth is in its \
                 95 % ellipsoid in {share:.0} % of the samples"
            ));
        }
        if surprised.len() > FORGIVEN {
            let (count, level) = (surprised.len(), short(median(surprised.into_iter())));
            reasons.push(format!("innovations² are {level} times what it expects in {count} of {PARTS} parts"));
        } else if surprised.is_empty() && self.share_in_ellipsoid().is_none() {
            let correlation = self.whiteness().iter().map(|w| w.autocorrelation()[0]).fold(0.0, f64::max);
            if correlation > CORRELATED {
                let text = format!("innovations are correlated ({correlation:.2} at lag 1): the model lacks something");
                reasons.push(text);
            }
        }
        (!reasons.is_empty()).then(|| reasons.join("; "))
    }

    fn too_modest(&self) -> Option<String> {
        let parts = self.parts();
        let nis = median(parts.iter().map(|part| part.nis.per_degree()));
        // A median varies slightly more than the mean of the same numbers.
        let degrees = self.nis_within(0..self.len()).degrees / 2;
        if nis < NIS_TOLERANCE.0.min(*wilson_hilferty(degrees, degrees, NOT_CHANCE).start()) {
            return Some(format!("innovations² are only {} times what it expects", short(nis)));
        }
        let nees = median(parts.iter().map(|part| part.nees.per_degree()));
        let one = parts[PARTS - 1].channels();
        let limit = NEES_TOO_SMALL.1.min(*wilson_hilferty(one, one, NEES_TOO_SMALL.0).start());
        (nees < limit).then(|| format!("errors² are only {} times what it says", short(nees)))
    }

    fn fits(&self, estimates: &Estimates) -> String {
        let parts = self.parts();
        let nis = median(parts.iter().map(|part| part.nis.per_degree()));
        let mut text = format!("innovations² are {nis:.2} times what it expects");
        if let Some(share) = self.share_in_ellipsoid() {
            text += &format!(", the truth is in its 95 % ellipsoid in {:.0} % of the samples", 100.0 * share);
        }
        if parts.iter().any(|part| part.is_far_outside() || part.is_surprised()) {
            text += ", although a change took it by surprise";
        }
        let last = self.len() - 1;
        for (place, channel) in estimates.channels().iter().enumerate().filter(|(_, channel)| channel.is_parameter()) {
            let (first, now) = (estimates.initial_std(place), estimates.std(last, place));
            if first > 0.0 && now > UNLEARNT * first {
                text += &format!("; σ of {} is still {} times that at first", channel.name(), short(now / first));
            }
        }
        text
    }

    fn parts(&self) -> [Part; PARTS] {
        std::array::from_fn(|i| {
            let range: Range<usize> = i * self.len() / PARTS..(i + 1) * self.len() / PARTS;
            Part { nis: self.nis_within(range.clone()), nees: self.nees_within(range) }
        })
    }
}

/// A part of the record.
#[derive(Clone, Copy, Debug)]
struct Part {
    nis: Total,
    nees: Total,
}

impl Part {
    /// Whether the innovations are larger than expected.
    fn is_surprised(&self) -> bool {
        let Total { degrees, .. } = self.nis;
        let level = self.nis.per_degree();
        degrees > 0 && exceeds(level, wilson_hilferty(degrees, degrees, NOT_CHANCE).end().max(NIS_TOLERANCE.1))
    }

    /// Whether the errors are larger than the covariance allows a single sample; the samples of one part are strongly
    /// correlated.
    fn is_far_outside(&self) -> bool {
        let one = self.channels();
        one > 0 && exceeds(self.nees.per_degree(), *wilson_hilferty(one, one, NOT_CHANCE).end())
    }

    /// The number of channels in the NEES of one sample.
    fn channels(&self) -> u32 {
        self.nees.degrees.checked_div(self.nees.samples).unwrap_or(0)
    }
}

/// A difference of sums that have overflowed counts as infinite.
fn exceeds(level: f64, limit: f64) -> bool {
    level > limit || level.is_nan()
}

/// The median of the numbers among `values`; NaN if there is none.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = values.filter(|x| !x.is_nan()).collect();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN)
}

/// A positive number to about two digits.
fn short(value: f64) -> String {
    match value {
        0.001..0.0995 => format!("{value:.3}"),
        0.0995..9.95 => format!("{value:.1}"),
        9.95..1e6 => format!("{value:.0}"),
        _ => format!("{value:.1e}"),
    }
}
