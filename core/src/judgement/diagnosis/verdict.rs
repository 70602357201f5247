//! The verdict on a filter, in a word and in a sentence.

use std::fmt;

use super::case::Case;
use super::evidence::{Evidence, Subject};
use super::size;
use super::verdict_kind::VerdictKind;
use super::words::{percent, short};

/// The verdict on a filter, and its reason.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// The verdict.
    pub kind: VerdictKind,
    /// The reason, in words and numbers.
    pub reason: String,
}

/// The least number of measurements for a verdict.
const ENOUGH: u32 = 20;

/// Limits the pieces of evidence in a sentence.
const MOST: usize = 3;

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.kind.name(), self.reason)
    }
}

impl Verdict {
    /// The gravest verdict that the evidence supports. `None` if there are too few measurements.
    pub(crate) fn of(case: &Case<'_>, evidence: &[Evidence]) -> Option<Self> {
        let stopped = case.diagnostics.stop().is_some();
        if !stopped && case.diagnostics.nis_within(case.samples.clone()).samples < ENOUGH {
            return None;
        }
        let counting = || evidence.iter().filter(|one| one.counts);
        let kind = counting().map(|one| one.speaks_for).max().unwrap_or(VerdictKind::Consistent);
        let mut grounds: Vec<&Evidence> = counting().filter(|one| one.speaks_for == kind).collect();
        grounds.sort_by(|a, b| b.effect.total_cmp(&a.effect));
        // The same evidence on the last fifth adds nothing.
        let mut told: Vec<(&str, Subject)> = Vec::new();
        grounds.retain(|one| {
            let of = (one.test.name, one.subject);
            let is_new = !told.contains(&of);
            told.push(of);
            is_new
        });
        let mut reasons: Vec<String> = grounds.iter().take(MOST).map(|one| one.sentence.clone()).collect();
        let mut besides: Vec<&Evidence> = counting().filter(|one| one.speaks_for != kind).collect();
        besides.sort_by(|a, b| {
            (b.speaks_for, b.effect).partial_cmp(&(a.speaks_for, a.effect)).unwrap_or(std::cmp::Ordering::Equal)
        });
        if kind == VerdictKind::Recovered || kind == VerdictKind::Consistent || kind == VerdictKind::NotIdentifiable {
            let said = grounds.iter().filter(|_| kind == VerdictKind::NotIdentifiable).map(|one| one.subject);
            reasons.push(fit(case, &said.collect::<Vec<_>>()));
        }
        if kind == VerdictKind::PatternLeft {
            reasons.extend(size::of_pattern(case).map(size::in_words));
        }
        reasons.extend(besides.first().map(|one| format!("besides, {}", one.sentence)));
        let unknown = if case.knows_truth() { "" } else { " (the truth is not known: innovations only)" };
        Some(Self { kind, reason: reasons.join("; ") + unknown })
    }
}

/// The fit of a consistent filter, and an explanation of numbers that seem to contradict the verdict.
fn fit(case: &Case<'_>, said: &[Subject]) -> String {
    let (level, _) = case.nis(&case.kept);
    let mut text = format!("innovations² are {level:.2} times what it expects");
    if let Some(share) = case.share_in_ellipsoid() {
        text += &format!(", the truth is in its 95 % ellipsoid in {} of the samples", percent(share));
        if share < 0.5 {
            text += ", as one record in many may have it: errors of parameters stay for as long as it lasts";
        }
    }
    let most = case
        .sensors
        .iter()
        .map(|one| one.autocorrelation(&case.kept)[0])
        .fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
    let count = case.sensors.iter().map(|one| one.count(&case.kept)).fold(f64::INFINITY, f64::min);
    if most.abs() * count.sqrt() > 3.3 {
        text += &format!("; they are not quite white ({most:.2} at lag 1), which does no harm");
    }
    if let Some(last) = case.last() {
        for (place, &channel) in case.estimates.channels().iter().enumerate().filter(|(_, c)| c.is_parameter()) {
            let share = case.estimates.std(last, place) / case.estimates.initial_std(place);
            // The text above has already named the parameters that are not identifiable.
            if share > 0.5 && !said.contains(&Subject::Channel(channel)) {
                text += &format!("; σ of the {} is {} times that at first", channel.name(), short(share));
            }
        }
        let mirrored = case
            .estimates
            .channels()
            .iter()
            .enumerate()
            .find(|(place, c)| c.is_mirrored() && case.estimates.canonical_sign(last, *place) < 0.0);
        if mirrored.is_some() {
            text += "; the filter itself has (-ωₙ, -ζ), the mirror image of the same oscillator";
        }
    }
    text
}
