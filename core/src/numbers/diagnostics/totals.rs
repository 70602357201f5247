//! Sums of normalised squares over any range of samples.

use std::ops::{Range, RangeInclusive};

use super::chi_squared;
use super::range_sums::RangeSums;

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
    /// Adds a sample with `degrees` numbers squared, or without any.
    #[inline]
    pub(crate) fn add(&mut self, square: f64, degrees: u32) {
        self.sum += if degrees > 0 { square } else { 0.0 };
        self.degrees += degrees;
        self.samples += u32::from(degrees > 0);
    }

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

/// The normalised squares of all samples.
#[derive(Clone, Debug, Default)]
pub(super) struct Totals {
    whole: Total,
    squares: RangeSums,
    /// Degrees of freedom and contributing samples up to each sample.
    counts: Vec<(u32, u32)>,
}

impl Totals {
    /// Adds a sample with `degrees` numbers squared, or without any.
    #[inline]
    pub(super) fn push(&mut self, square: f64, degrees: u32) {
        let Self { whole, squares, counts } = self;
        whole.add(square, degrees);
        squares.push([if degrees > 0 { square } else { 0.0 }]);
        counts.push((whole.degrees, whole.samples));
    }

    pub(super) fn clear(&mut self) {
        let Self { whole, squares, counts } = self;
        *whole = Total::default();
        squares.restart(1);
        counts.clear();
    }

    pub(super) fn whole(&self) -> Total {
        self.whole
    }

    /// For each sample of `range`, which exist, the mean over all numbers that were squared in the `window` samples up to it;
    /// NaN if there is none.
    ///
    /// ```text
    /// Σ_(k-w<i≤k) = Σ_(k-w<i<s) + Σ_(s≤i≤k),  s = w ⌊k/w⌋
    /// ```
    ///
    /// Both sums grow by one term a sample, backwards and forwards from s, so that no term outside a window enters it.
    ///
    /// Source: van Herk (1992), A fast algorithm for local minimum and maximum filters on rectangular and octagonal kernels.
    pub(super) fn moving_means(&self, window: usize, range: Range<usize>) -> Vec<f64> {
        // A longer window has no more samples.
        let (squares, window) = (self.squares.rows(), window.min(range.end).max(1));
        let mut means = Vec::with_capacity(range.len());
        // The sums from each sample of the block before to its end.
        let mut behind = Vec::with_capacity(window + 1);
        let mut start = range.start - range.start % window;
        while start < range.end {
            let before = &squares[start.saturating_sub(window)..start];
            behind.clear();
            behind.push(0.0);
            behind.extend(before.iter().rev().scan(0.0, |sum, square| {
                *sum += square;
                Some(*sum)
            }));
            let mut sum = 0.0;
            let end = range.end.min(start + window);
            for (k, square) in (start..end).zip(&squares[start..end]) {
                sum += square;
                if k >= range.start {
                    // The window begins in the block before, or with the first sample.
                    let more = (start + window - 1 - k).min(before.len());
                    means.push((sum + behind[more]) / f64::from(self.degrees(start - more, k + 1)));
                }
            }
            start += window;
        }
        means
    }

    /// The degrees of freedom of the samples from `start` to before `end`.
    fn degrees(&self, start: usize, end: usize) -> u32 {
        let until = |end: usize| end.checked_sub(1).map_or(0, |k| self.counts[k].0);
        until(end) - until(start)
    }

    /// The total over the part of `range` that exists.
    pub(super) fn within(&self, range: Range<usize>) -> Total {
        let end = range.end.min(self.counts.len());
        let start = range.start.min(end);
        if start == 0 && end == self.counts.len() {
            return self.whole;
        }
        let until = |end: usize| end.checked_sub(1).map_or((0, 0), |k| self.counts[k]);
        let ((degrees_before, samples_before), (degrees, samples)) = (until(start), until(end));
        Total {
            sum: self.squares.within(0, start..end),
            degrees: degrees - degrees_before,
            samples: samples - samples_before,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_has_the_sum_of_its_samples() {
        let mut totals = Totals::default();
        totals.clear();
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
    fn moving_means_are_those_of_each_window() {
        let mut totals = Totals::default();
        totals.clear();
        for k in 0..97 {
            let degrees = [1, 2, 0, 1, 3][k % 5];
            totals.push(if k == 40 { 1e18 } else { 0.1 + k as f64 }, degrees);
        }
        for (window, range) in [
            (1, 0..97),
            (7, 0..97),
            (7, 13..60),
            (40, 39..97),
            (97, 0..97),
            (500, 90..97),
            (3, 9..9),
            (usize::MAX, 0..97),
            (usize::MAX, 90..97),
        ] {
            let means = totals.moving_means(window, range.clone());
            assert_eq!(means.len(), range.len());
            for (k, mean) in range.zip(means) {
                let direct = totals.within((k + 1).saturating_sub(window)..k + 1).per_degree();
                let is_same = (mean - direct).abs() <= 1e-14 * direct.abs() || mean.is_nan() && direct.is_nan();
                assert!(is_same, "window {window}, sample {k}: {mean} instead of {direct}");
            }
        }
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
