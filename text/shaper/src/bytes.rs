//! A font's tables as they stand in the file: big-endian numbers, which are zero where the file ends too early.
//!
//! Source: OpenType specification 1.9.1, chapter 2, common table formats.

/// A table, or the rest of it from some place on.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Bytes<'a>(pub(crate) &'a [u8]);

impl<'a> Bytes<'a> {
    /// The unsigned number at a place.
    pub(crate) fn u16(self, at: usize) -> u16 {
        self.0.get(at..).and_then(|rest| rest.first_chunk()).map_or(0, |two| u16::from_be_bytes(*two))
    }

    /// The signed number at a place.
    pub(crate) fn i16(self, at: usize) -> i32 {
        i32::from(self.u16(at).cast_signed())
    }

    /// A count, or an index.
    pub(crate) fn index(self, at: usize) -> usize {
        usize::from(self.u16(at))
    }

    /// The long offset at a place.
    pub(crate) fn long(self, at: usize) -> usize {
        (self.index(at) << 16) | self.index(at + 2)
    }

    /// What begins at a place.
    pub(crate) fn from(self, at: usize) -> Self {
        Self(self.0.get(at..).unwrap_or_default())
    }

    /// What the offset at a place points to: nothing where it is zero.
    pub(crate) fn follow(self, at: usize) -> Self {
        match self.index(at) {
            0 => Self::default(),
            offset => self.from(offset),
        }
    }

    /// The place of a glyph in this coverage.
    pub(crate) fn coverage(self, glyph: u16) -> Option<usize> {
        let count = self.index(2);
        match self.u16(0) {
            1 => self.from(4).last_until(count, 2, glyph).filter(|&place| self.u16(4 + 2 * place) == glyph),
            2 => {
                let range = self.from(4 + 6 * self.from(4).last_until(count, 6, glyph)?);
                (glyph <= range.u16(2)).then(|| range.index(4) + usize::from(glyph - range.u16(0)))
            }
            _ => None,
        }
    }

    /// The class of a glyph in this class definition.
    pub(crate) fn class(self, glyph: u16) -> u16 {
        match self.u16(0) {
            1 => {
                let place = glyph.checked_sub(self.u16(2)).filter(|place| *place < self.u16(4));
                place.map_or(0, |place| self.u16(6 + 2 * usize::from(place)))
            }
            2 => self.from(4).last_until(self.index(2), 6, glyph).map_or(0, |place| {
                let range = self.from(4 + 6 * place);
                if glyph <= range.u16(2) { range.u16(4) } else { 0 }
            }),
            _ => 0,
        }
    }

    /// Of records of `size` bytes in the order of the glyph that each begins with, the last one that is not beyond a glyph.
    pub(crate) fn last_until(self, count: usize, size: usize, glyph: u16) -> Option<usize> {
        let (mut low, mut high) = (0, count);
        while low < high {
            let middle = usize::midpoint(low, high);
            if self.u16(middle * size) <= glyph {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        low.checked_sub(1)
    }
}
