//! The parts of a record that are judged each by itself, and the granules from whose sums theirs are added up.

use std::ops::Range;

/// The number of parts that a record is judged in, so that one sudden change does not decide for the whole.
pub const PARTS: usize = 10;

pub(crate) fn range(part: usize, samples: &Range<usize>) -> Range<usize> {
    let end = |part: usize| samples.start + part * samples.len() / PARTS;
    end(part)..end(part + 1)
}

pub(crate) type Chosen = [bool; PARTS];

pub(crate) const ALL: Chosen = [true; PARTS];

pub(crate) fn chosen(is_so: &dyn Fn(usize) -> bool) -> Chosen {
    std::array::from_fn(is_so)
}

pub(crate) fn sum(chosen: &Chosen, of: impl Fn(usize) -> f64) -> f64 {
    (0..PARTS).filter(|&part| chosen[part]).map(of).sum()
}

pub(crate) const LAGS: usize = 21;

/// The lags of a cross-correlation with the input: from 4 samples before it to 15 after it.
pub(crate) const CROSS_LAGS: usize = 20;

pub(crate) const FIRST_CROSS_LAG: i32 = -4;

/// Granule i begins with sample 16 i. Smaller ones are more sums to add, larger ones leave more samples outside.
pub(super) const GRANULE: usize = 16;

pub(super) const BEFORE: usize = LAGS - 1;

pub(super) const AFTER: usize = FIRST_CROSS_LAG.unsigned_abs() as usize;

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Piece {
    pub(super) samples: Range<usize>,
    /// Its stored sums serve for these samples: it is whole, and its products reach no sample outside the window.
    pub(super) granule: Option<usize>,
}

pub(super) fn pieces(samples: &Range<usize>, window: &Range<usize>) -> impl Iterator<Item = Piece> {
    let (samples, reach) = (samples.clone(), window.start + BEFORE..window.end.saturating_sub(AFTER));
    let end = if samples.is_empty() { 0 } else { samples.end.div_ceil(GRANULE) };
    (samples.start / GRANULE..end).map(move |number| {
        let whole = samples_of(number);
        let part = whole.start.max(samples.start)..whole.end.min(samples.end);
        let is_kept = part == whole && reach.start <= whole.start && whole.end <= reach.end;
        Piece { samples: part, granule: is_kept.then_some(number) }
    })
}

pub(super) fn first_in(start: usize) -> usize {
    (start + BEFORE).div_ceil(GRANULE)
}

pub(super) fn samples_of(number: usize) -> Range<usize> {
    number * GRANULE..(number + 1) * GRANULE
}

/// Only the last items are kept; numbers count from the run's beginning.
#[derive(Clone, Debug)]
pub(super) struct Series<T> {
    first: usize,
    items: Vec<T>,
}

impl<T> Series<T> {
    pub(super) fn starting_at(first: usize) -> Self {
        Self { first, items: Vec::new() }
    }

    pub(super) fn first(&self) -> usize {
        self.first
    }

    pub(super) fn end(&self) -> usize {
        self.first + self.items.len()
    }

    #[inline]
    pub(super) fn push(&mut self, item: T) {
        self.items.push(item);
    }

    #[inline]
    pub(super) fn items(&self, numbers: Range<usize>) -> &[T] {
        &self.items[numbers.start - self.first..numbers.end - self.first]
    }

    pub(super) fn get(&self, number: usize) -> Option<&T> {
        self.items.get(number.checked_sub(self.first)?)
    }

    fn skip_to(&mut self, number: usize) {
        if self.end() < number {
            self.items.clear();
            self.first = number;
        }
    }

    pub(super) fn follow(&mut self, window: &Range<usize>, sums: impl Fn(&Range<usize>) -> T) {
        self.skip_to(first_in(window.start));
        while (self.end() + 1) * GRANULE + AFTER <= window.end {
            self.push(sums(&samples_of(self.end())));
        }
        self.forget_before(window.start / GRANULE);
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
    fn pieces_are_the_samples_one_after_the_other() {
        for (samples, window) in [(0..200, 0..200), (37..143, 3..150), (40..41, 0..99), (64..80, 0..100), (5..5, 5..5)]
        {
            let all: Vec<Piece> = pieces(&samples, &window).collect();
            let joined: Vec<usize> = all.iter().flat_map(|piece| piece.samples.clone()).collect();
            assert!(all.iter().all(|piece| !piece.samples.is_empty()));
            assert_eq!(joined, samples.clone().collect::<Vec<_>>());
            for (piece, number) in all.iter().filter_map(|piece| Some((piece, piece.granule?))) {
                assert_eq!(piece.samples, samples_of(number));
                assert!(number >= first_in(window.start) && piece.samples.end + AFTER <= window.end);
            }
        }
        assert_eq!(pieces(&(32..80), &(12..84)).filter(|piece| piece.granule.is_some()).count(), 3);
        assert_eq!(pieces(&(32..80), &(13..83)).filter(|piece| piece.granule.is_some()).count(), 1);
    }

    #[test]
    fn items_keep_their_numbers_and_memory_is_bounded() {
        let mut series = Series::starting_at(7);
        for number in 7_usize..10_000 {
            series.push(number);
            series.forget_before(number.saturating_sub(100));
            assert_eq!(series.get(number), Some(&number));
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
