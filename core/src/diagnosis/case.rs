//! A filter before its judges: what the tests look at, prepared once.

use std::ops::Range;

use super::errors::ChannelErrors;
use super::innovations::SensorInnovations;
use super::parts::{self, ALL, Chosen, PARTS};
use crate::{CramerRao, Diagnostics, Estimates, Record};

/// Innovations² of a part that are more times what is expected are a surprise.
const SURPRISE: f64 = 1.35;

/// The normal score beyond which a part's innovations are no chance.
const NOT_CHANCE: f64 = 4.0;

/// Errors² of a part that are more times what the covariance says are far outside: of parameters, whose errors in a part
/// are as good as one, and of motions, whose errors in a part are several.
const OUTSIDE: (f64, f64) = (16.0, 8.0);

/// The most parts of a record that may be bad and be forgiven.
const FORGIVEN: usize = 3;

/// The numbers on one filter.
pub(crate) struct Case<'a> {
    pub(crate) diagnostics: &'a Diagnostics,
    pub(crate) estimates: &'a Estimates,
    pub(crate) record: &'a Record,
    pub(crate) bound: Option<&'a CramerRao>,
    pub(crate) sensors: Vec<SensorInnovations>,
    pub(crate) errors: Vec<ChannelErrors>,
    /// The parts that are bad.
    pub(crate) bad: Chosen,
    /// The parts that are bad and after which the filter has come back.
    pub(crate) forgiven: Chosen,
    /// All others.
    pub(crate) kept: Chosen,
}

/// Parts of a record that a test looks at.
pub(crate) struct Span {
    pub(crate) parts: Chosen,
    pub(crate) samples: Range<usize>,
    /// What to add to a sentence about them.
    pub(crate) words: &'static str,
}

impl<'a> Case<'a> {
    pub(crate) fn new(
        diagnostics: &'a Diagnostics,
        estimates: &'a Estimates,
        record: &'a Record,
        bound: Option<&'a CramerRao>,
    ) -> Self {
        let sensors = SensorInnovations::of_all(estimates, record);
        let errors = ChannelErrors::of_all(estimates, record);
        let (bad, forgiven, kept) = ([false; PARTS], [false; PARTS], ALL);
        let mut case = Self { diagnostics, estimates, record, bound, sensors, errors, bad, forgiven, kept };
        let bad: Chosen = std::array::from_fn(|part| case.is_bad(part));
        case.bad = bad;
        let count = bad.iter().filter(|&&bad| bad).count();
        if count > 0 && count <= FORGIVEN && !bad[PARTS - 1] {
            (case.forgiven, case.kept) = (bad, bad.map(|bad| !bad));
        }
        let kept: Vec<Range<usize>> =
            (0..PARTS).filter(|&part| case.kept[part]).map(|part| parts::range(part, case.len())).collect();
        SensorInnovations::transform(&mut case.sensors, &kept);
        case
    }

    /// The number of samples that are kept.
    pub(crate) fn len(&self) -> usize {
        self.estimates.len()
    }

    /// All that is kept.
    pub(crate) fn whole(&self) -> Span {
        Span { parts: self.kept, samples: 0..self.len(), words: "" }
    }

    /// All that is kept, and the last fifth alone: what has changed late is diluted by all that was before.
    pub(crate) fn spans(&self) -> [Span; 2] {
        let first = PARTS - 2;
        let late: Chosen = std::array::from_fn(|part| part >= first && self.kept[part]);
        let samples = parts::range(first, self.len()).start..self.len();
        [self.whole(), Span { parts: late, samples, words: " in the last fifth" }]
    }

    /// Whether the truth of any channel is known.
    pub(crate) fn knows_truth(&self) -> bool {
        !self.errors.is_empty()
    }

    /// The samples of the bad parts; neighbours are one range.
    pub(crate) fn bad_samples(&self) -> Vec<Range<usize>> {
        let mut ranges: Vec<Range<usize>> = Vec::new();
        for part in (0..PARTS).filter(|&part| self.bad[part]) {
            let next = parts::range(part, self.len());
            match ranges.last_mut() {
                Some(before) if before.end == next.start => before.end = next.end,
                _ => ranges.push(next),
            }
        }
        ranges
    }

    /// The samples from the first to the last forgiven part; none where nothing is.
    pub(crate) fn forgiven_samples(&self) -> Option<Range<usize>> {
        let first = self.forgiven.iter().position(|&forgiven| forgiven)?;
        let last = self.forgiven.iter().rposition(|&forgiven| forgiven)?;
        Some(parts::range(first, self.len()).start..parts::range(last, self.len()).end)
    }

    /// The mean of the normalised innovations squared over some parts, by number; and how many numbers.
    pub(crate) fn nis(&self, chosen: &Chosen) -> (f64, f64) {
        let total = |of: fn(crate::diagnostics::Total) -> f64| {
            parts::sum(chosen, |part| of(self.diagnostics.nis_within(parts::range(part, self.len()))))
        };
        let degrees = total(|total| f64::from(total.degrees));
        (total(|total| total.sum) / degrees, degrees)
    }

    /// Whether the innovations of a sensor are smaller than expected over all that is kept: the filter trusts it too little,
    /// and a gain that is too low leaves innovations correlated.
    pub(crate) fn any_too_small(&self) -> bool {
        self.sensors.iter().any(|one| one.level(&self.kept) < 0.75)
    }

    fn is_bad(&self, part: usize) -> bool {
        let only: Chosen = std::array::from_fn(|other| other == part);
        let surprised = |level: f64, degrees: f64| {
            degrees > 0.0
                && !(level <= SURPRISE)
                && !(super::distributions::chi_squared_score(level, degrees) <= NOT_CHANCE)
        };
        let (nis, degrees) = self.nis(&only);
        surprised(nis, degrees)
            || self.sensors.iter().any(|one| surprised(one.level(&only), one.count(&only)))
            || self.errors.iter().any(|one| {
                one.by_part[part].count > 0.0
                    && if one.channel.is_parameter() {
                        !(one.level(&only) <= OUTSIDE.0)
                    } else {
                        !(one.level(&only) <= OUTSIDE.1)
                            && !(super::distributions::chi_squared_score(one.level(&only), one.independent(&only))
                                <= NOT_CHANCE)
                    }
            })
    }
}
