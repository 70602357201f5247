//! The parts of a record that are judged each by itself.

use std::ops::Range;

/// The number of parts that a record is judged in, so that one sudden change does not decide for the whole.
pub const PARTS: usize = 10;

pub(crate) fn range(part: usize, samples: &Range<usize>) -> Range<usize> {
    let end = |part: usize| samples.start + part * samples.len() / PARTS;
    end(part)..end(part + 1)
}

pub(crate) type Chosen = [bool; PARTS];

pub(crate) const ALL: Chosen = [true; PARTS];

pub(crate) fn sum(chosen: &Chosen, of: impl Fn(usize) -> f64) -> f64 {
    (0..PARTS).filter(|&part| chosen[part]).map(of).sum()
}

pub(crate) const LAGS: usize = 21;

/// The lags of a cross-correlation with the input: from 4 samples before it to 15 after it.
pub(crate) const CROSS_LAGS: usize = 20;

pub(crate) const FIRST_CROSS_LAG: i32 = -4;
