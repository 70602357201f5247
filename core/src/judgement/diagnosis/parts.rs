//! The parts of a record that are judged each by itself.

use std::ops::Range;

/// The number of parts that a record is judged in, so that one sudden change does not decide for the whole.
pub const PARTS: usize = 10;

/// Part `part` of some samples.
pub(crate) fn range(part: usize, samples: &Range<usize>) -> Range<usize> {
    let end = |part: usize| samples.start + part * samples.len() / PARTS;
    end(part)..end(part + 1)
}

/// A choice of parts.
pub(crate) type Chosen = [bool; PARTS];

/// Every part.
pub(crate) const ALL: Chosen = [true; PARTS];

/// The sum over chosen parts of a number that each has.
pub(crate) fn sum(chosen: &Chosen, of: impl Fn(usize) -> f64) -> f64 {
    (0..PARTS).filter(|&part| chosen[part]).map(of).sum()
}
