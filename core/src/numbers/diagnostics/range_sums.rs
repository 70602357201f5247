//! Sums over any range of samples, each added up from its own terms.

use std::ops::Range;

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
    /// Rows until the next block is complete.
    missing: usize,
    /// The rows, then blocks of rows, then blocks of these, each row by row.
    levels: Vec<Vec<f64>>,
}

impl RangeSums {
    /// Begins again with rows of `width` numbers, in the same memory.
    pub(super) fn restart(&mut self, width: usize) {
        (self.width, self.missing) = (width, BLOCK);
        self.levels.iter_mut().for_each(Vec::clear);
        if self.levels.is_empty() {
            self.levels.push(Vec::new());
        }
    }

    /// The number of rows.
    pub(super) fn len(&self) -> usize {
        self.levels.first().map_or(0, |rows| rows.len().checked_div(self.width).unwrap_or(0))
    }

    /// Appends a row.
    #[inline]
    pub(super) fn push(&mut self, row: impl IntoIterator<Item = f64>) {
        self.levels[0].extend(row);
        self.missing -= 1;
        if self.missing == 0 {
            self.missing = BLOCK;
            self.complete_blocks();
        }
    }

    /// All rows, one after the other.
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

    /// The sum of a column over the existing rows in `range`.
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
