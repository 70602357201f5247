//! Granules: short stretches of samples with stored sums.

use std::ops::Range;

use crate::judgement::diagnosis::innovations::{FIRST_CROSS_LAG, LAGS};

/// The samples of a granule; granule i begins with sample number 16 i. With fewer there would be more sums to add for a
/// window, with more there would be more samples outside whole granules.
pub(super) const GRANULE: usize = 16;

/// The samples before a granule that its products reach back to.
pub(super) const BEFORE: usize = LAGS - 1;

/// The samples after a granule that its products reach forward to.
pub(super) const AFTER: usize = FIRST_CROSS_LAG.unsigned_abs() as usize;

/// Some successive samples in one granule.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Piece {
    /// The numbers of the samples.
    pub(super) samples: Range<usize>,
    /// The number of the granule, if its stored sums serve for these samples: it is whole, and its products reach no
    /// sample outside the window.
    pub(super) granule: Option<usize>,
}

/// The pieces of some samples of a window.
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

/// The first granule with sums that serve in a window that begins at `start` or later.
pub(super) fn first_in(start: usize) -> usize {
    (start + BEFORE).div_ceil(GRANULE)
}

/// The samples of a granule.
pub(super) fn samples_of(number: usize) -> Range<usize> {
    number * GRANULE..(number + 1) * GRANULE
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
}
