//! The diagnosis of a filter: the verdict, its evidence, and the settings to turn if it is bad.
//!
//! ```text
//! Estimates, Record ──▶ sums by part, spectra of windows ──▶ Case
//! Case ──tests──▶ Evidence ──level──▶ Verdict ──causes──▶ LikelyCauses ──trials, search──▶ Remedies
//! ```
//!
//! Each test is an item of a file in `checks/`, each cause one in `cause/`.

use std::f64::consts::TAU;
use std::fmt;
use std::ops::Range;

use kalmanscope_core::internals::sort_items;
use kalmanscope_core::{Channel, Diagnostics, Estimates, FilterSettings, Record, Scenario};

use super::case::Case;
use super::cause::{ALTERNATIVES, BadFilter};
use super::words::{percent, short};
use super::{CAUSES, Evidence, LikelyCause, Subject, TESTS, VerdictKind, checks};

/// The diagnosis of one filter: a verdict and its evidence.
#[derive(Clone, Debug, Default)]
pub struct Diagnosis {
    /// The verdict on the filter, if there are enough measurements for one.
    pub verdict: Option<Verdict>,
    /// The results of all tests.
    pub evidence: Vec<Evidence>,
    /// The kept samples with a bad verdict, judged part by part of the record.
    pub bad_parts: Vec<Range<usize>>,
    samples: Range<usize>,
}

impl Diagnosis {
    /// The diagnosis of a filter, in one pass of about 0.1 µs a kept sample. `None` if the diagnostics are empty.
    pub fn new(diagnostics: &Diagnostics, estimates: &Estimates, record: &Record) -> Option<Self> {
        Self::over(0..diagnostics.len(), diagnostics, estimates, record)
    }

    /// The same over a range of the kept samples, such as those that a screen shows.
    pub fn over(
        samples: Range<usize>,
        diagnostics: &Diagnostics,
        estimates: &Estimates,
        record: &Record,
    ) -> Option<Self> {
        if diagnostics.is_empty() {
            return None;
        }
        let case = Case::new(samples.clone(), diagnostics, estimates, record);
        let mut evidence = Vec::new();
        TESTS.iter().for_each(|test| (test.run)(&case, test, &mut evidence));
        checks::decide(&mut evidence);
        let verdict = Verdict::of(&case, &evidence);
        let bad_parts = case.ranges(|part| case.bad[part] || case.forgiven[part]);
        Some(Self { verdict, evidence, bad_parts, samples })
    }

    /// The likeliest by the evidence, without a trial, come first; for a good verdict other models that may be likelier.
    pub fn likely_causes(
        &self,
        origin: &FilterSettings,
        scenario: &Scenario,
        place: usize,
        diagnostics: &Diagnostics,
        estimates: &Estimates,
        record: &Record,
    ) -> Vec<LikelyCause> {
        let Some(filter) = scenario.filters.get(place).filter(|_| !estimates.is_empty()) else { return Vec::new() };
        let case = Case::new(self.samples.clone(), diagnostics, estimates, record);
        let bad = BadFilter { case: &case, evidence: &self.evidence, scenario, filter, origin };
        let mut likely_causes = Vec::new();
        let causes = match self.verdict.as_ref().map(|verdict| verdict.kind) {
            Some(VerdictKind::Consistent) => ALTERNATIVES,
            // After any change another plant or a drift fits better for a while.
            Some(VerdictKind::Recovered) => &ALTERNATIVES[..3],
            _ => CAUSES,
        };
        causes.iter().for_each(|cause| (cause.likely_causes)(&bad, cause, &mut likely_causes));
        sort_items(&mut likely_causes, |a, b| b.weight.total_cmp(&a.weight));
        likely_causes
    }
}

/// The verdict on a filter, and its reason.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// The verdict.
    pub kind: VerdictKind,
    /// The reason, in words and numbers.
    pub reason: String,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.kind.name(), self.reason)
    }
}

impl Verdict {
    /// The gravest verdict that the evidence supports. `None` if there are too few measurements.
    pub(crate) fn of(case: &Case<'_>, evidence: &[Evidence]) -> Option<Self> {
        let stopped = case.diagnostics.stop.is_some();
        if !stopped && case.diagnostics.nis_within(case.samples.clone()).samples < 20 {
            return None;
        }
        let counting = || evidence.iter().filter(|one| one.counts);
        let kind = counting().map(|one| one.speaks_for).max().unwrap_or(VerdictKind::Consistent);
        let mut grounds: Vec<&Evidence> = counting().filter(|one| one.speaks_for == kind).collect();
        sort_items(&mut grounds, |a, b| b.effect.total_cmp(&a.effect));
        // The same evidence on the last fifth adds nothing.
        let mut told: Vec<(&str, Subject)> = Vec::new();
        grounds.retain(|one| {
            let of = (one.test.name, one.subject);
            let is_new = !told.contains(&of);
            told.push(of);
            is_new
        });
        let mut reasons: Vec<String> = grounds.iter().take(3).map(|one| one.sentence.clone()).collect();
        let order = |one: &&Evidence, other: &&Evidence| {
            one.speaks_for.cmp(&other.speaks_for).then(one.effect.total_cmp(&other.effect))
        };
        // The first of those that are equally grave.
        let beside = counting().rev().filter(|one| one.speaks_for != kind).max_by(order);
        if kind == VerdictKind::Recovered || kind == VerdictKind::Consistent || kind == VerdictKind::NotIdentifiable {
            let said = grounds.iter().filter(|_| kind == VerdictKind::NotIdentifiable).map(|one| one.subject);
            reasons.push(fit(case, &said.collect::<Vec<_>>()));
        }
        if kind == VerdictKind::PatternLeft {
            let words =
                |(channel, size): (Channel, f64)| format!("{} may be off by about {size:.1}σ", channel.symbol());
            reasons.extend(size_of_pattern(case).map(words));
        }
        reasons.extend(beside.map(|one| format!("also, {}", one.sentence)));
        let unknown = if case.errors.is_empty() { " (the truth is not known: innovations only)" } else { "" };
        Some(Self { kind, reason: reasons.join("; ") + unknown })
    }
}

fn fit(case: &Case<'_>, said: &[Subject]) -> String {
    let (level, _) = case.nis(&case.kept);
    let mut text = format!("innovations² are {level:.2} times what it expects");
    if let Some(share) = case.share_in_ellipsoid() {
        text += &format!(", the truth is in its 95 % ellipsoid in {} of the samples", percent(share));
        if share < 0.5 {
            text += ", perhaps by chance: the error of a parameter stays for the whole record";
        }
    }
    let most = case.largest_first_correlation();
    let count = case.sensors.iter().map(|one| one.count(&case.kept)).fold(f64::INFINITY, f64::min);
    if most.abs() * count.sqrt() > 3.3 {
        text += &format!("; they are not quite white ({most:.2} at lag 1), which is harmless");
    }
    if let Some(last) = case.last() {
        for (place, &channel) in case.estimates.channels().iter().enumerate().filter(|(_, c)| c.is_parameter()) {
            let (std, first) = (case.estimates.std(last, place), case.estimates.initial_std(place));
            if first == 0.0 && std > 0.0 {
                text += &format!("; the {} begins with σ = 0, and its process noise lets it change", channel.name());
            }
            let share = if first == 0.0 { 0.0 } else { std / first };
            // The text above has already named the parameters that are not identifiable.
            if share > 0.5 && !said.contains(&Subject::Channel(channel)) {
                text += &format!("; σ of the {} is {} times its first value", channel.name(), short(share));
            }
        }
        text += &ridges(case, last);
        let mut channels = case.estimates.channels().iter().enumerate();
        if channels.any(|(place, c)| c.is_mirrored() && case.estimates.canonical_sign(last, place) < 0.0) {
            text += "; the filter itself has (-ωₙ, -ζ), the mirror image of the same oscillator";
        }
    }
    text
}

/// Limits the relative variance of a known combination, over that of the other one.
const RIDGE: f64 = 0.02;

const KNOWN: f64 = 0.01;

/// Combinations that are known, by the relative standard deviation of the product or the ratio:
/// ```text
/// var(ln ab) = σa²/a² + 2 cov/(ab) + σb²/b²,  var(ln a/b) with - 2 cov
/// ```
fn ridges(case: &Case<'_>, last: usize) -> String {
    let (estimates, channels) = (case.estimates, case.estimates.channels());
    let n = channels.len();
    let (mean, cov) = (estimates.mean(last), estimates.cov(last));
    let relative = |i: usize, j: usize| cov[j * n + i] / (mean[i] * mean[j]);
    // The matrices of an earlier part of a record may be dropped.
    let counts = |i: &usize| !cov.is_empty() && channels[*i].is_parameter() && relative(*i, *i) > KNOWN * KNOWN;
    let mut text = String::new();
    for i in (0..n).filter(counts) {
        for j in (i + 1..n).filter(counts) {
            let both = [1.0, -1.0].map(|sign| relative(i, i) + relative(j, j) + sign * 2.0 * relative(i, j));
            let (word, known, open) =
                if both[0] < both[1] { ("product", both[0], both[1]) } else { ("ratio", both[1], both[0]) };
            if known < RIDGE * open {
                let (one, other, std) = (channels[i].name(), channels[j].name(), percent(known.max(0.0).sqrt()));
                text += &format!("; only the {word} of the {one} and the {other} is known, to {std}");
            }
        }
    }
    text
}

/// Scores count as correlated over this many samples, or over a swing if that is longer.
const LEAST: usize = 40;

/// The standard deviation is about that of the error over the filter's own, for each parameter alone. An update moves a parameter by
/// `Δ = K e`; `s = Δ / P` is the score, and correlated scores increase the variance of the estimate by
/// ```text
/// f² = NIS/m (1 + 2 Σ (1 - l/L) ρ_l) = NIS/m ⟨(s_k + … + s_{k+L-1})²⟩ / (L ⟨s²⟩),  ρ_l the correlation of s at lag l < L
/// ```
/// with the mean over all windows of L samples in which the filter is not forgiven.
/// Source: White (1982), Maximum likelihood estimation of misspecified models; Newey and West (1987), A simple, positive
/// semi-definite, heteroskedasticity and autocorrelation consistent covariance matrix. Both in *Econometrica*.
fn size_of_pattern(case: &Case<'_>) -> Option<(Channel, f64)> {
    let (level, _) = case.nis(&case.kept);
    let window = swing(case).map_or(LEAST, |swing| LEAST.max(swing));
    let ranges = case.ranges(|part| case.kept[part]);
    let parameters = case.estimates.channels().iter().enumerate().filter(|(_, channel)| channel.is_parameter());
    let sizes = parameters.filter_map(|(place, &channel)| {
        let (means, variances) = (case.estimates.canonical_means(place), case.estimates.variances(place));
        let [mut squares, mut sums] = [(0.0, 0); 2];
        for range in &ranges {
            let mut totals = vec![0.0];
            for k in range.clone().filter(|&k| k > 0 && variances[k - 1] > 0.0) {
                let score = (means[k] - means[k - 1]) / variances[k - 1];
                squares = (squares.0 + score * score, squares.1 + 1);
                totals.push(totals[totals.len() - 1] + score);
            }
            let ends = totals.iter().skip(window);
            sums = ends.zip(&totals).fold(sums, |(sum, count), (end, begin)| {
                let one = end - begin;
                (sum + one * one, count + 1)
            });
        }
        let mean = |(sum, count): (f64, usize)| sum / count as f64;
        let size = (level * mean(sums) / (window as f64 * mean(squares))).sqrt();
        (size.is_finite() && squares.1 >= 4 * window).then_some((channel, size))
    });
    sizes.max_by(|a, b| a.1.total_cmp(&b.1))
}

fn swing(case: &Case<'_>) -> Option<usize> {
    let place = case.estimates.place(Channel::NATURAL_FREQUENCY)?;
    let turn = case.estimates.canonical_mean(case.last()?, place).abs() * case.record.dt();
    (turn > 0.0).then(|| (TAU / turn).min(case.len() as f64) as usize)
}
