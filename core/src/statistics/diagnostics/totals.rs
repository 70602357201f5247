//! Sums over any range of samples, each added up from its own terms, and those of normalised squares.

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
    pub(super) fn new(total: Total, independent: u32) -> Option<Self> {
        let Total { degrees, samples, .. } = total;
        let expected = f64::from(degrees) / f64::from(samples);
        let scaled = (expected * f64::from(independent)).round() as u32;
        Some(Self { mean: total.mean(), expected, interval: chi_squared::interval(scaled, independent)? })
    }
}

#[derive(Clone, Debug, Default)]
pub(super) struct Totals {
    pub(super) whole: Total,
    squares: RangeSums,
}

impl Totals {
    /// Takes in the square of a sample, NaN where there is none, and the total up to it.
    pub(super) fn push(&mut self, square: f64, whole: Total) {
        let is_counted = whole.samples > self.whole.samples;
        self.whole = whole;
        self.squares.push(if is_counted { square } else { 0.0 }, (whole.degrees, whole.samples));
    }

    pub(super) fn clear(&mut self) {
        self.whole = Total::default();
        self.squares.clear();
    }

    /// For each sample of `range` the mean over the `window` samples up to it; NaN if nothing was squared there.
    /// ```text
    /// Σ_(k-w<i≤k) = Σ_(k-w<i<s) + Σ_(s≤i≤k),  s = w ⌊k/w⌋
    /// ```
    /// No term outside a window enters it. Source: van Herk (1992), A fast algorithm for local minimum and maximum filters.
    pub(super) fn moving_means(&self, window: usize, range: Range<usize>) -> Vec<f64> {
        let (squares, window) = (self.squares.terms(), window.min(range.end).max(1));
        let mut means = Vec::with_capacity(range.len());
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
                    let more = (start + window - 1 - k).min(before.len());
                    means.push((sum + behind[more]) / f64::from(self.degrees(start - more, k + 1)));
                }
            }
            start += window;
        }
        means
    }

    fn degrees(&self, start: usize, end: usize) -> u32 {
        self.squares.counts_before(end).0 - self.squares.counts_before(start).0
    }

    pub(super) fn within(&self, range: Range<usize>) -> Total {
        let (sum, (degrees, samples)) = self.squares.within(range, self.whole.sum);
        Total { sum, degrees, samples }
    }
}

const BLOCK: usize = 16;

/// Sums of whole blocks of 16, 256, 4096, … terms: no large term outside a range takes the digits of its sum.
#[derive(Clone, Debug, Default)]
pub(super) struct RangeSums {
    /// The terms, then the sums of blocks of terms, then those of blocks of these.
    levels: Vec<Vec<f64>>,
    counts: Vec<(u32, u32)>,
}

impl RangeSums {
    pub(super) fn clear(&mut self) {
        self.levels.iter_mut().for_each(Vec::clear);
        self.counts.clear();
    }

    pub(super) fn len(&self) -> usize {
        self.counts.len()
    }

    pub(super) fn push(&mut self, term: f64, counts: (u32, u32)) {
        if self.levels.is_empty() {
            self.levels.push(Vec::new());
        }
        self.levels[0].push(term);
        self.counts.push(counts);
        if self.counts.len().is_multiple_of(BLOCK) {
            self.complete_blocks();
        }
    }

    fn terms(&self) -> &[f64] {
        self.levels.first().map_or(&[], Vec::as_slice)
    }

    fn counts_before(&self, end: usize) -> (u32, u32) {
        end.checked_sub(1).map_or((0, 0), |k| self.counts[k])
    }

    #[cold]
    fn complete_blocks(&mut self) {
        for level in 0.. {
            let len = self.levels[level].len();
            if len == 0 || !len.is_multiple_of(BLOCK) {
                break;
            }
            if level + 1 == self.levels.len() {
                self.levels.push(Vec::new());
            }
            let sum = self.levels[level][len - BLOCK..].iter().sum::<f64>();
            self.levels[level + 1].push(sum);
        }
    }

    pub(super) fn within(&self, range: Range<usize>, whole: f64) -> (f64, (u32, u32)) {
        let end = range.end.min(self.len());
        let start = range.start.min(end);
        let (before, until) = (self.counts_before(start), self.counts_before(end));
        let sum = if start == 0 && end == self.len() { whole } else { self.sum(start..end) };
        (sum, (until.0 - before.0, until.1 - before.1))
    }

    fn sum(&self, range: Range<usize>) -> f64 {
        let (mut low, mut high, mut sum) = (range.start, range.end, 0.0);
        for terms in &self.levels {
            let add = |from: usize, to: usize| terms[from..to].iter().sum::<f64>();
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

    fn totals(squares: impl IntoIterator<Item = (f64, u32)>) -> Totals {
        let mut totals = Totals::default();
        for (square, degrees) in squares {
            let Total { sum, degrees: before, samples } = totals.whole;
            let sum = if degrees > 0 { sum + square } else { sum };
            totals.push(square, Total { sum, degrees: before + degrees, samples: samples + u32::from(degrees > 0) });
        }
        totals
    }

    #[test]
    fn a_range_has_the_sum_of_its_samples() {
        let totals = totals([(f64::NAN, 0), (1.0, 1), (2.0, 2), (f64::NAN, 0), (5.0, 2)]);
        assert_eq!(totals.whole, Total { sum: 8.0, degrees: 5, samples: 3 });
        assert_eq!(totals.within(2..4), Total { sum: 2.0, degrees: 2, samples: 1 });
        assert_eq!(totals.within(4..99), Total { sum: 5.0, degrees: 2, samples: 1 });
        assert_eq!(totals.within(0..5), totals.whole);
        assert_eq!(totals.within(9..9), Total::default());
    }

    #[test]
    fn moving_means_are_those_of_each_window() {
        let totals = totals((0..97).map(|k| (if k == 40 { 1e18 } else { 0.1 + k as f64 }, [1, 2, 0, 1, 3][k % 5])));
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
        assert!((one.interval.end() - 11.1433).abs() < 1e-4 && one.interval.contains(&one.mean));
        let all = MeanSquare::new(total, 100).unwrap();
        assert!((all.interval.end() - 4.573).abs() < 1e-3, "{all:?}");
        assert_eq!(MeanSquare::new(Total::default(), 1), None);
    }

    fn of(terms: impl IntoIterator<Item = f64>) -> RangeSums {
        let mut sums = RangeSums::default();
        terms.into_iter().zip(1..).for_each(|(term, k)| sums.push(term, (k, 2 * k)));
        sums
    }

    #[test]
    fn every_range_is_the_sum_of_its_terms() {
        let sums = of((0..700).map(f64::from));
        let upto = |k: usize| (k * k.saturating_sub(1) / 2) as f64;
        for start in (0..700).step_by(7) {
            for end in (start..720).step_by(11) {
                let (expected, count) = (upto(end.min(700)) - upto(start), (end.min(700) - start) as u32);
                assert_eq!(sums.within(start..end, upto(700)), (expected, (count, 2 * count)));
            }
        }
        assert_eq!((sums.len(), sums.within(900..1000, upto(700))), (700, (0.0, (0, 0))));
    }

    #[test]
    fn a_large_term_changes_no_range_that_it_is_not_in() {
        for large in [1e20, f64::INFINITY, f64::NAN] {
            for place in [0, 15, 16, 300, 6000] {
                let sums = of((0..6001).map(|k| if k == place { large } else { 1e-3 }));
                for range in [0..place, place + 1..6001] {
                    let expected = 1e-3 * range.len() as f64;
                    assert!((sums.within(range, large).0 - expected).abs() <= 1e-12 * expected);
                }
            }
        }
    }
}
