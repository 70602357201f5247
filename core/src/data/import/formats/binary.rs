//! Binary numbers, and the memory that they may take.

use std::io::Read;

/// Limits the bytes of unpacked files and numbers: 200 times those of the file, but at least 64 MiB and at most 1 GiB.
pub(super) struct Room(usize);

impl Room {
    pub(super) fn of(file: &[u8]) -> Self {
        Self(file.len().saturating_mul(200).clamp(64 << 20, 1 << 30))
    }

    pub(super) fn take(&mut self, count: usize, size: usize) -> Result<(), String> {
        let left = count.checked_mul(size).and_then(|bytes| self.0.checked_sub(bytes));
        self.0 = left.unwrap_or(0);
        left.map(|_| ()).ok_or_else(|| "it is too large: unpacked, more than 200 times the file or 1 GiB".to_owned())
    }

    pub(super) fn unpack(&mut self, packed: impl Read) -> Result<Vec<u8>, String> {
        let mut bytes = Vec::new();
        let read = packed.take(self.0 as u64 + 1).read_to_end(&mut bytes);
        self.take(bytes.len(), 1)?;
        read.map_or_else(|_| Err("it is damaged or cut short".to_owned()), |_| Ok(bytes))
    }
}

/// The whole number of some bytes at a place, as the processor writes it that has its big end first, or not.
pub(super) fn whole(bytes: &[u8], place: usize, size: usize, is_big: bool) -> Option<usize> {
    let part = bytes.get(place..place.checked_add(size)?)?;
    let add = |sum: usize, byte: &u8| sum << 8 | usize::from(*byte);
    Some(if is_big { part.iter().fold(0, add) } else { part.iter().rev().fold(0, add) })
}

/// The form of a binary number, by NumPy's letters: `f`, `i`, `u` or `b`; and its bytes.
#[derive(Clone, Copy)]
pub(super) struct Form {
    pub(super) kind: char,
    pub(super) size: usize,
    pub(super) is_big: bool,
}

impl Form {
    pub(super) fn number(self, bytes: &[u8]) -> f64 {
        let add = |sum: u64, byte: &u8| sum << 8 | u64::from(*byte);
        let bits = if self.is_big { bytes.iter().fold(0, add) } else { bytes.iter().rev().fold(0, add) };
        let above = 64 - 8 * self.size;
        match (self.kind, self.size) {
            ('f', 4) => f64::from(f32::from_bits(bits as u32)),
            ('f', _) => f64::from_bits(bits),
            ('i', _) => ((bits << above) as i64 >> above) as f64,
            _ => bits as f64,
        }
    }

    pub(super) fn numbers(self, bytes: &[u8], room: &mut Room) -> Result<Vec<f64>, String> {
        match (self.kind, self.size) {
            ('f', 4 | 8) | ('i' | 'u', 1 | 2 | 4 | 8) | ('b', 1) => {}
            (kind, size) => return Err(format!("type {kind}{size}")),
        }
        room.take(bytes.len() / self.size, 8)?;
        Ok(bytes.chunks_exact(self.size).map(|bytes| self.number(bytes)).collect())
    }
}
