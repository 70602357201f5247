//! Limits of files and of the records made of them.

/// Limits the columns of a file.
pub(super) const MOST_COLUMNS: usize = 1000;
/// Limits the bytes of one line.
pub(super) const LONGEST_LINE: usize = 1_000_000;
/// The fewest samples of a record.
pub(super) const FEWEST: usize = 2;
/// Limits the samples of a record.
pub const MOST: usize = 2_000_000;
