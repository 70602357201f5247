//! The data on one filter that all tests share, prepared once; the kinds of verdicts that they support, and tails of distributions.

use std::ops::Range;

use kalmanscope_core::diagnostics::chi_squared;
use kalmanscope_core::internals::mapped;
use kalmanscope_core::{Diagnostics, Estimates, Record};

use super::periodogram::Periodogram;
use super::sums::{ALL, ChannelErrors, Chosen, PARTS, Pair, SensorInnovations, range_of, sum_over};

/// Limits the innovations² of a good part, relative to their expectation.
const SURPRISE: f64 = 1.35;

const SLACK: f64 = 0.7;

const NOT_CHANCE: f64 = 4.0;

/// The normal score at the upper end of the 95 % interval of innovations², and, with a minus, at its lower end.
const ABOVE: f64 = 1.96;

/// Limits the errors² of a good part over the covariance: of a parameter (its errors in a part count as one), of a motion.
const OUTSIDE: (f64, f64) = (16.0, 8.0);

const FORGIVEN: usize = 3;

pub(crate) struct Case<'a> {
    pub(crate) diagnostics: &'a Diagnostics,
    pub(crate) estimates: &'a Estimates,
    pub(crate) record: &'a Record,
    pub(crate) samples: Range<usize>,
    pub(crate) sensors: Vec<SensorInnovations>,
    pub(crate) pairs: Vec<Pair>,
    pub(crate) errors: Vec<ChannelErrors>,
    pub(crate) bad: Chosen,
    /// The bad parts, and parts with too small innovations, after which the filter has recovered.
    pub(crate) forgiven: Chosen,
    pub(crate) kept: Chosen,
}

pub(crate) struct Span {
    pub(crate) parts: Chosen,
    pub(crate) samples: Range<usize>,
    pub(crate) words: &'static str,
}

impl<'a> Case<'a> {
    pub(crate) fn new(
        samples: Range<usize>,
        diagnostics: &'a Diagnostics,
        estimates: &'a Estimates,
        record: &'a Record,
    ) -> Self {
        let end = samples.end.min(estimates.len()).min(record.len());
        let samples = samples.start.min(end)..end;
        let start = samples.start;
        let (sensors, series) = SensorInnovations::of_all(&samples, estimates, record);
        let errors = ChannelErrors::of_all(&samples, estimates, record);
        let (bad, forgiven, kept, pairs) = ([false; PARTS], [false; PARTS], ALL, Vec::new());
        let mut case = Self { diagnostics, estimates, record, samples, sensors, pairs, errors, bad, forgiven, kept };
        let bad: Chosen = std::array::from_fn(|part| case.is_bad(part));
        case.bad = bad;
        let count = bad.iter().filter(|&&bad| bad).count();
        if count <= FORGIVEN && !bad[PARTS - 1] {
            case.forgiven = bad;
            let slack: Chosen = std::array::from_fn(|part| case.is_slack(part));
            let both: Chosen = std::array::from_fn(|part| bad[part] || slack[part]);
            let count = both.iter().filter(|&&one| one).count();
            if count <= FORGIVEN && !slack[PARTS - 1] && case.is_white(&std::array::from_fn(|part| !both[part])) {
                case.forgiven = both;
            }
            case.kept = std::array::from_fn(|part| !case.forgiven[part]);
        }
        let ranges = mapped(&case.ranges(|part| case.kept[part]), &|of| of.start - start..of.end - start);
        for (one, periodogram) in case.sensors.iter_mut().zip(Periodogram::of_all(&series, &ranges)) {
            one.periodogram = periodogram;
        }
        if series.len() > 1 {
            case.pairs = Pair::of_all(&case.sensors, &series, &ranges);
        }
        case
    }

    pub(crate) fn len(&self) -> usize {
        self.samples.len()
    }

    pub(crate) fn last(&self) -> Option<usize> {
        (!self.samples.is_empty()).then(|| self.samples.end - 1)
    }

    pub(crate) fn part(&self, part: usize) -> Range<usize> {
        range_of(part, &self.samples)
    }

    pub(crate) fn expected_correlation(&self, [i, j]: [usize; 2]) -> f64 {
        let m = self.sensors.len();
        let of = |k: usize| {
            let cov = self.estimates.innovation_cov(k);
            cov[j * m + i] / (cov[i * (m + 1)] * cov[j * (m + 1)]).sqrt()
        };
        let all = self.ranges(|part| self.kept[part]).into_iter().flatten().map(of).filter(|r| r.is_finite());
        let (sum, count) = all.fold((0.0, 0.0), |(sum, count), r| (sum + r, count + 1.0));
        if count > 0.0 { sum / count } else { 0.0 }
    }

    pub(crate) fn largest_first_correlation(&self) -> f64 {
        let all = self.sensors.iter().map(|one| one.first_correlation(&self.kept).1);
        all.fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a })
    }

    pub(crate) fn late(&self) -> Range<usize> {
        self.part(PARTS - 2).start..self.samples.end
    }

    pub(crate) fn share_in_ellipsoid(&self) -> Option<f64> {
        if self.samples == (0..self.diagnostics.len()) {
            return self.diagnostics.share_in_ellipsoid();
        }
        let total = self.diagnostics.nees_within(self.samples.clone());
        let limit = chi_squared::quantile(0.95, total.degrees.checked_div(total.samples)?)?;
        let inside = self.diagnostics.nees()[self.samples.clone()].iter().filter(|nees| **nees <= limit).count();
        Some(inside as f64 / f64::from(total.samples))
    }

    pub(crate) fn whole(&self) -> Span {
        Span { parts: self.kept, samples: self.samples.clone(), words: "" }
    }

    /// All kept parts, and the last fifth alone: in all samples, a late change is diluted by those before it.
    pub(crate) fn spans(&self) -> [Span; 2] {
        let first = PARTS - 2;
        let late = std::array::from_fn(|part| part >= first && self.kept[part]);
        let samples = self.late();
        [self.whole(), Span { parts: late, samples, words: " in the last fifth" }]
    }

    pub(super) fn ranges(&self, is_chosen: impl Fn(usize) -> bool) -> Vec<Range<usize>> {
        let all: Vec<_> = (0..PARTS).filter(|&part| is_chosen(part)).map(|part| self.part(part)).collect();
        let runs = all.chunk_by(|one, next| one.end == next.start);
        runs.map(|run| run[0].start..run[run.len() - 1].end).collect()
    }

    pub(crate) fn nis(&self, chosen: &Chosen) -> (f64, f64) {
        let total = |of: fn(kalmanscope_core::diagnostics::Total) -> f64| {
            sum_over(chosen, |part| of(self.diagnostics.nis_within(self.part(part))))
        };
        let degrees = total(|total| f64::from(total.degrees));
        (total(|total| total.sum) / degrees, degrees)
    }

    pub(crate) fn surprise(&self) -> VerdictKind {
        let (level, degrees) = self.nis(&self.kept);
        let is_below = chi_squared_score(level, degrees) < -ABOVE;
        if is_below { VerdictKind::PatternLeft } else { VerdictKind::Overconfident }
    }

    /// The covariance is too small only where innovations are larger than expected: too little trust leaves a pattern too.
    pub(crate) fn pattern(&self, one: &SensorInnovations) -> VerdictKind {
        let (level, degrees) = self.nis(&self.kept);
        let is_above = |level: f64, degrees: f64| exceeds(chi_squared_score(level, degrees), ABOVE);
        // Too little trust in a sensor makes its innovations small, and the low gain leaves them correlated.
        let any_too_small = self.sensors.iter().any(|one| one.level(&self.kept) < 0.75);
        if any_too_small && level < 1.15 {
            VerdictKind::Underconfident
        } else if is_above(level, degrees) || is_above(one.level(&self.kept), one.count(&self.kept)) {
            self.surprise()
        } else {
            VerdictKind::PatternLeft
        }
    }

    fn is_white(&self, chosen: &Chosen) -> bool {
        self.sensors.iter().all(|one| {
            let limit = NOT_CHANCE / one.count(chosen).max(1.0).sqrt();
            one.autocorrelation(chosen).iter().all(|r| r.abs() < limit)
        })
    }

    fn is_slack(&self, part: usize) -> bool {
        let only: Chosen = std::array::from_fn(|other| other == part);
        self.sensors.iter().any(|one| {
            let (level, count) = (one.level(&only), one.count(&only));
            level < SLACK && chi_squared_score(level, count) < -NOT_CHANCE
        })
    }

    fn is_bad(&self, part: usize) -> bool {
        let only: Chosen = std::array::from_fn(|other| other == part);
        let is_no_chance = |level: f64, degrees: f64| exceeds(chi_squared_score(level, degrees), NOT_CHANCE);
        let surprises =
            |level: f64, degrees: f64| degrees > 0.0 && exceeds(level, SURPRISE) && is_no_chance(level, degrees);
        let is_outside = |one: &ChannelErrors| {
            let level = one.level(&only);
            match one.channel.is_parameter() {
                true => exceeds(level, OUTSIDE.0),
                false => exceeds(level, OUTSIDE.1) && is_no_chance(level, one.independent(&only)),
            }
        };
        let (nis, degrees) = self.nis(&only);
        surprises(nis, degrees)
            || self.sensors.iter().any(|one| surprises(one.level(&only), one.count(&only)))
            || self.errors.iter().any(|one| one.count(&only) > 0.0 && is_outside(one))
    }
}

/// NaN, the mean of squares that have overflowed, counts as infinite.
fn exceeds(level: f64, limit: f64) -> bool {
    level > limit || level.is_nan()
}

/// The trust that a filter's estimates and standard deviations deserve, in order of gravity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum VerdictKind {
    /// Its errors are as large as its σ says.
    Consistent,
    /// It is consistent except for a time from which it has recovered.
    Recovered,
    /// The record does not determine a parameter: its σ is as large as at first.
    NotIdentifiable,
    /// Its errors are smaller than its σ says.
    Underconfident,
    /// Its innovations are no larger than it expects, but they have a pattern: something is left that the model does not explain.
    PatternLeft,
    /// Its errors are larger than its σ says.
    Overconfident,
    /// It forgets a parameter faster than the sensors give information on it.
    WoundUp,
    /// Its particles have become one, so that σ says nothing.
    Collapsed,
    /// Its estimates are not those of an oscillator: negative, beyond what the samples can show, or far from any start.
    Lost,
    /// It has lost the truth, or has stopped.
    Diverged,
}

impl VerdictKind {
    /// Every verdict, the gravest last.
    pub const ALL: [Self; 10] = [
        Self::Consistent,
        Self::Recovered,
        Self::NotIdentifiable,
        Self::Underconfident,
        Self::PatternLeft,
        Self::Overconfident,
        Self::WoundUp,
        Self::Collapsed,
        Self::Lost,
        Self::Diverged,
    ];

    /// The verdict in words.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Consistent => "consistent",
            Self::Recovered => "recovered",
            Self::NotIdentifiable => "not identifiable",
            Self::Underconfident => "underconfident",
            Self::PatternLeft => "pattern left",
            Self::Overconfident => "overconfident",
            Self::WoundUp => "wound up",
            Self::Collapsed => "collapsed",
            Self::Lost => "lost",
            Self::Diverged => "diverged",
        }
    }

    /// The verdict as an argument: its name with `-` in place of spaces.
    pub const fn key(self) -> &'static str {
        match self {
            Self::NotIdentifiable => "not-identifiable",
            Self::PatternLeft => "pattern-left",
            Self::WoundUp => "wound-up",
            _ => self.name(),
        }
    }

    /// The verdict on a filter of this name, as a sentence without its full stop.
    pub fn on(self, name: &str) -> String {
        match self {
            Self::PatternLeft => format!("{name} leaves a pattern"),
            Self::Recovered | Self::Collapsed | Self::Diverged => format!("{name} has {}", self.name()),
            _ => format!("{name} is {}", self.name()),
        }
    }

    /// Whether the standard deviations may be believed, now.
    pub const fn is_good(self) -> bool {
        matches!(self, Self::Consistent | Self::Recovered)
    }
}

/// Source: Abramowitz and Stegun (1964), *Handbook of Mathematical Functions*, section 7.1.
pub(crate) fn normal_tail(z: f64) -> f64 {
    0.5 * libm::erfc(z / std::f64::consts::SQRT_2)
}

/// To a few percent. Source: Wilson and Hilferty (1931), The distribution of chi-square, *PNAS* 17.
pub(crate) fn chi_squared_score(level: f64, degrees: f64) -> f64 {
    let variance = 2.0 / (9.0 * degrees);
    (libm::cbrt(level) - 1.0 + variance) / variance.sqrt()
}

/// Twice the probability that the mean of the squares is at least as far from 1 as `level`, to the same side.
pub(crate) fn chi_squared_p(level: f64, degrees: f64) -> f64 {
    if level.is_nan() || degrees <= 0.0 {
        return 1.0;
    }
    (2.0 * normal_tail(chi_squared_score(level, degrees).abs())).min(1.0)
}

pub(crate) fn normal_p(z: f64) -> f64 {
    if z.is_nan() { 1.0 } else { 2.0 * normal_tail(z.abs()) }
}
