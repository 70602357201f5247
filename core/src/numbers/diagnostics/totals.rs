//! Sums over any range of samples, each added up from its own terms; those of normalised squares, and of log likelihoods.

use std::ops::{Range, RangeInclusive};

use super::chi_squared;
use crate::FilterKind;
use crate::mathematics::gaussian_likelihood::{LogSum, log_likelihood};

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

#[derive(Clone, Debug, Default)]
pub(super) struct Totals {
    whole: Total,
    squares: RangeSums,
    /// Degrees of freedom and contributing samples up to each sample.
    counts: Vec<(u32, u32)>,
}

impl Totals {
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
    /// Both sums grow by one term a sample, backwards and forwards from s, so that no term outside a window enters it. Source:
    /// van Herk (1992), A fast algorithm for local minimum and maximum filters on rectangular and octagonal kernels.
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

    fn degrees(&self, start: usize, end: usize) -> u32 {
        let until = |end: usize| end.checked_sub(1).map_or(0, |k| self.counts[k].0);
        until(end) - until(start)
    }

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

/// The log likelihood of Gaussian beliefs, for which it needs the sum of the NIS as well; a particle filter reports its own.
#[derive(Clone, Copy, Debug)]
pub(super) struct Likelihood {
    ln_determinants: LogSum,
    own: Option<f64>,
}

impl Default for Likelihood {
    fn default() -> Self {
        Self { ln_determinants: LogSum::ZERO, own: None }
    }
}

impl Likelihood {
    pub(super) fn new(kind: FilterKind) -> Self {
        Self { own: kind.has_own_likelihood().then_some(0.0), ..Self::default() }
    }

    /// Takes in a sample: det S, NaN where nothing was measured, with its logarithm, and the log likelihood of particles.
    #[inline]
    pub(super) fn push(&mut self, determinant: f64, ln: impl FnOnce() -> f64, own: impl FnOnce() -> f64) {
        match &mut self.own {
            _ if determinant.is_nan() => {}
            Some(sum) => *sum += own(),
            None => self.ln_determinants.add(determinant, ln),
        }
    }

    pub(super) fn value(self, nis: Total) -> f64 {
        let of_gaussian =
            || if nis.degrees == 0 { 0.0 } else { log_likelihood(nis.sum, self.ln_determinants.value(), nis.degrees) };
        self.own.unwrap_or_else(of_gaussian)
    }
}

/// A block is the sum of this many items of the level below it.
const BLOCK: usize = 16;

/// Rows of numbers, and the sums of their columns over any range of rows.
///
/// A difference of running totals loses the digits of a range where a term before it is large. Here a range is the sum
/// of whole blocks of 16, 256, 4096, … rows and of the rows at its edges, so that no term outside it enters it. A row
/// takes one addition a column more than a running total, and a range about thirty for each level.
#[derive(Clone, Debug, Default)]
pub(super) struct RangeSums {
    width: usize,
    missing: usize,
    /// The rows, then blocks of rows, then blocks of these, each row by row.
    levels: Vec<Vec<f64>>,
}

impl RangeSums {
    pub(super) fn restart(&mut self, width: usize) {
        (self.width, self.missing) = (width, BLOCK);
        self.levels.iter_mut().for_each(Vec::clear);
        if self.levels.is_empty() {
            self.levels.push(Vec::new());
        }
    }

    pub(super) fn len(&self) -> usize {
        self.levels.first().map_or(0, |rows| rows.len().checked_div(self.width).unwrap_or(0))
    }

    #[inline]
    pub(super) fn push(&mut self, row: impl IntoIterator<Item = f64>) {
        self.levels[0].extend(row);
        self.missing -= 1;
        if self.missing == 0 {
            self.missing = BLOCK;
            self.complete_blocks();
        }
    }

    pub(super) fn rows(&self) -> &[f64] {
        self.levels.first().map_or(&[], Vec::as_slice)
    }

    #[cold]
    fn complete_blocks(&mut self) {
        let Self { width, levels, .. } = self;
        let size = BLOCK * *width;
        for level in 0.. {
            let len = levels[level].len();
            if len == 0 || !len.is_multiple_of(size) {
                break;
            }
            if level + 1 == levels.len() {
                levels.push(Vec::new());
            }
            let (below, above) = levels.split_at_mut(level + 1);
            let block = &below[level][len - size..];
            above[0].extend((0..*width).map(|column| block.iter().skip(column).step_by(*width).sum::<f64>()));
        }
    }

    pub(super) fn within(&self, column: usize, range: Range<usize>) -> f64 {
        let end = range.end.min(self.len());
        let (mut low, mut high) = (range.start.min(end), end);
        let mut sum = 0.0;
        for rows in &self.levels {
            let add = |from: usize, to: usize| (from..to).map(|row| rows[row * self.width + column]).sum::<f64>();
            let (first, last) = (low.div_ceil(BLOCK), high / BLOCK);
            if first >= last {
                return sum + add(low, high);
            }
            sum += add(low, first * BLOCK) + add(last * BLOCK, high);
            (low, high) = (first, last);
        }
        sum
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

    fn of(rows: impl IntoIterator<Item = [f64; 2]>) -> RangeSums {
        let mut sums = RangeSums::default();
        sums.restart(2);
        rows.into_iter().for_each(|row| sums.push(row));
        sums
    }

    #[test]
    fn every_range_is_the_sum_of_its_terms() {
        let sums = of((0..700).map(|k| [f64::from(k), -2.0 * f64::from(k)]));
        let upto = |k: usize| (k * k.saturating_sub(1) / 2) as f64;
        for start in (0..700).step_by(7) {
            for end in (start..720).step_by(11) {
                let expected = upto(end.min(700)) - upto(start);
                assert_eq!(sums.within(0, start..end), expected);
                assert_eq!(sums.within(1, start..end), -2.0 * expected);
            }
        }
        assert_eq!((sums.len(), sums.within(0, 900..1000)), (700, 0.0));
    }

    #[test]
    fn a_large_term_changes_no_range_that_it_is_not_in() {
        for large in [1e20, f64::INFINITY, f64::NAN] {
            for place in [0, 15, 16, 300, 6000] {
                let term = |k: usize| if k == place { large } else { 1e-3 };
                let sums = of((0..6001).map(|k| [term(k), 0.0]));
                for range in [0..place, place + 1..6001] {
                    let expected = 1e-3 * range.len() as f64;
                    assert!((sums.within(0, range) - expected).abs() <= 1e-12 * expected);
                }
            }
        }
    }

    #[test]
    fn it_begins_anew_with_rows_of_another_width() {
        let mut sums = of([[1.0, 2.0]; 40]);
        sums.restart(1);
        assert_eq!((sums.len(), sums.within(0, 0..9)), (0, 0.0));
        (0..40).for_each(|_| sums.push([1.0]));
        assert_eq!(sums.within(0, 3..40), 37.0);
        assert_eq!(RangeSums::default().within(0, 0..9), 0.0);
    }
}
