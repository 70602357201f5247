//! A series that forgets its first items.

use std::ops::Range;

/// Items that are numbered from the run's beginning. Only the last ones are kept.
#[derive(Clone, Debug)]
pub(super) struct Series<T> {
    first: usize,
    items: Vec<T>,
}

impl<T> Series<T> {
    /// An empty series that begins with the item of this number.
    pub(super) fn starting_at(first: usize) -> Self {
        Self { first, items: Vec::new() }
    }

    /// The number of the first item that is kept.
    pub(super) fn first(&self) -> usize {
        self.first
    }

    /// The number of the next item.
    pub(super) fn end(&self) -> usize {
        self.first + self.items.len()
    }

    /// Appends an item.
    #[inline]
    pub(super) fn push(&mut self, item: T) {
        self.items.push(item);
    }

    /// Items by number; all must be kept.
    #[inline]
    pub(super) fn items(&self, numbers: Range<usize>) -> &[T] {
        &self.items[numbers.start - self.first..numbers.end - self.first]
    }

    /// The item of a number, which must be kept.
    #[inline]
    pub(super) fn at(&self, number: usize) -> &T {
        &self.items[number - self.first]
    }

    /// Begins again with the item of this number, if the series ends before it.
    pub(super) fn skip_to(&mut self, number: usize) {
        if self.end() < number {
            self.items.clear();
            self.first = number;
        }
    }

    /// Forgets items before the one of this number, once they are more than half of all: forgetting moves all others.
    pub(super) fn forget_before(&mut self, number: usize) {
        let gone = number.saturating_sub(self.first).min(self.items.len());
        if 2 * gone > self.items.len() {
            self.items.drain(..gone);
            self.first += gone;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_keep_their_numbers_and_memory_is_bounded() {
        let mut series = Series::starting_at(7);
        for number in 7_usize..10_000 {
            series.push(number);
            series.forget_before(number.saturating_sub(100));
            assert_eq!(*series.at(number), number);
            assert!(series.first() <= number.saturating_sub(100).max(7) && series.items.len() < 210);
        }
        assert_eq!(series.items(9_950..9_953), [9_950, 9_951, 9_952]);
        series.forget_before(20_000);
        assert_eq!((series.first(), series.end()), (10_000, 10_000));
        series.push(3);
        series.skip_to(10_001);
        assert_eq!((series.first(), series.end()), (10_000, 10_001));
        series.skip_to(10_002);
        assert_eq!((series.first(), series.end()), (10_002, 10_002));
    }
}
