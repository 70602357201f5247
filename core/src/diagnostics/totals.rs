//! Cumulative sums of normalised squares, kept for every sample.

use std::ops::{Range, RangeInclusive};

use super::chi_squared;

/// A sum of normalised squares over some samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Total {
    /// The sum.
    pub sum: f64,
    /// The degrees of freedom: how many numbers were squared.
    pub degrees: u32,
    /// The number of samples that contribute.
    pub samples: u32,
}

impl Total {
    /// The mean over the samples that contribute; NaN if none does.
    pub fn mean(self) -> f64 {
        self.sum / f64::from(self.samples)
    }

    /// The mean over all numbers that were squared: about 1 for a consistent filter; NaN if there is none.
    pub fn per_degree(self) -> f64 {
        self.sum / f64::from(self.degrees)
    }
}

/// A mean of normalised squares and its expected interval.
#[derive(Clone, Debug, PartialEq)]
pub struct MeanSquare {
    /// The mean over the samples that contribute.
    pub mean: f64,
    /// Its expectation for a consistent filter: the degrees of freedom of a sample.
    pub expected: f64,
    /// Its 95 % interval for a consistent filter.
    pub interval: RangeInclusive<f64>,
}

impl MeanSquare {
    /// `independent` is the number of samples that count as independent.
    pub(super) fn new(total: Total, independent: u32) -> Option<Self> {
        let Total { degrees, samples, .. } = total;
        let expected = f64::from(degrees) / f64::from(samples);
        let scaled = (expected * f64::from(independent)).round() as u32;
        Some(Self { mean: total.mean(), expected, interval: chi_squared::interval(scaled, independent)? })
    }

    /// Whether the mean is inside its interval.
    pub fn is_inside(&self) -> bool {
        self.interval.contains(&self.mean)
    }
}

/// Cumulative totals up to each sample.
#[derive(Clone, Debug, Default)]
pub(super) struct Totals {
    last: Total,
    until: Vec<Total>,
}

impl Totals {
    /// Adds a sample of `degrees` squared numbers; zero where nothing was measured.
    pub(super) fn push(&mut self, square: f64, degrees: u32) {
        let Self { last, until } = self;
        let Total { mut sum, degrees: before, mut samples } = *last;
        if degrees > 0 {
            sum += square;
            samples += 1;
        }
        *last = Total { sum, degrees: before + degrees, samples };
        until.push(Total { sum, degrees: before + degrees, samples });
    }

    pub(super) fn clear(&mut self) {
        let Self { last, until } = self;
        *last = Total::default();
        until.clear();
    }

    pub(super) fn whole(&self) -> Total {
        self.last
    }

    /// The total over the part of `range` that exists.
    pub(super) fn within(&self, range: Range<usize>) -> Total {
        let until = |end: usize| end.min(self.until.len()).checked_sub(1).map_or(Total::default(), |k| self.until[k]);
        let (before, after) = (until(range.start.min(range.end)), until(range.end));
        Total {
            sum: after.sum - before.sum,
            degrees: after.degrees - before.degrees,
            samples: after.samples - before.samples,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_has_the_sum_of_its_samples() {
        let mut totals = Totals::default();
        for (square, degrees) in [(f64::NAN, 0), (1.0, 1), (2.0, 2), (f64::NAN, 0), (5.0, 2)] {
            totals.push(square, degrees);
        }
        assert_eq!(totals.whole(), Total { sum: 8.0, degrees: 5, samples: 3 });
        assert_eq!(totals.within(2..4), Total { sum: 2.0, degrees: 2, samples: 1 });
        assert_eq!(totals.within(4..99), Total { sum: 5.0, degrees: 2, samples: 1 });
        assert_eq!(totals.within(0..5), totals.whole());
        assert_eq!(totals.within(9..9), Total::default());
    }

    #[test]
    fn independent_samples_make_the_interval_narrow() {
        let total = Total { sum: 410.0, degrees: 400, samples: 100 };
        let one = MeanSquare::new(total, 1).unwrap();
        assert_eq!((one.mean, one.expected), (4.1, 4.0));
        assert!((one.interval.end() - 11.1433).abs() < 1e-4 && one.is_inside());
        let all = MeanSquare::new(total, 100).unwrap();
        assert!((all.interval.end() - 4.573).abs() < 1e-3, "{all:?}");
        assert_eq!(MeanSquare::new(Total::default(), 1), None);
    }
}
