//! Files of MATLAB, version 5 (`-v6` and `-v7`): matrices as columns.

use flate2::read::ZlibDecoder;

use super::super::{ImportError, Table};
use super::arrays::{Arrays, Form};
use super::kinds::whole;
use super::unpack::Room;

const HEADER: usize = 128;
const MATRIX: usize = 14;
const COMPRESSED: usize = 15;

/// Types of variables that are not numbers, by their classes.
const OTHERS: [(usize, &str); 7] = [
    (1, "cell"),
    (2, "struct"),
    (3, "object"),
    (4, "text"),
    (5, "sparse matrix"),
    (16, "function"),
    (17, "table or other object"),
];

/// The parts of a file, one after the other: the type and the bytes of each. What remains is cut short.
struct Parts<'a> {
    rest: &'a [u8],
    is_big: bool,
}

impl<'a> Iterator for Parts<'a> {
    type Item = (usize, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        let word = |place| whole(self.rest, place, 4, self.is_big);
        let (tag, size) = (word(0)?, word(4)?);
        // A short part has its size beside its type.
        let (kind, start, size, end) = match tag >> 16 {
            0 if tag == COMPRESSED => (tag, 8, size, size),
            0 => (tag, 8, size, size.checked_next_multiple_of(8)?),
            size => (tag & 0xFFFF, 4, size.min(4), 4),
        };
        let data = self.rest.get(start..size.checked_add(start)?)?;
        self.rest = self.rest.get(start + end..).unwrap_or_default();
        Some((kind, data))
    }
}

/// The matrices of equal length in a file of MATLAB.
///
/// Source: MathWorks, MAT-file format, level 5.
///
/// # Errors
/// [`ImportError::OtherKind`] where there are none.
pub(super) fn mat(bytes: &[u8]) -> Result<Table, ImportError> {
    let (mut arrays, mut room) = (Arrays::default(), Room::of(bytes));
    let is_big = bytes.get(126) == Some(&b'M');
    let mut parts = Parts { rest: bytes.get(HEADER..).unwrap_or_default(), is_big };
    for (kind, data) in &mut parts {
        if kind == MATRIX {
            add(&mut arrays, Parts { rest: data, is_big }, &mut room);
        } else if kind == COMPRESSED {
            match room.unpack(ZlibDecoder::new(data)) {
                Ok(inside) => (Parts { rest: &inside, is_big })
                    .filter(|(kind, _)| *kind == MATRIX)
                    .for_each(|(_, data)| add(&mut arrays, Parts { rest: data, is_big }, &mut room)),
                Err(reason) => arrays.left_out.push(format!("a variable ({reason})")),
            }
        }
    }
    if !parts.rest.is_empty() {
        arrays.left_out.push("the end of the file, which is cut short".to_owned());
    }
    arrays.table("a MATLAB file")
}

/// Adds a variable: its class and flags, its lengths, its name, its numbers.
fn add(arrays: &mut Arrays, mut parts: Parts<'_>, room: &mut Room) {
    const COMPLEX: usize = 0x800;
    let is_big = parts.is_big;
    let mut next = || parts.next().map_or(&[][..], |(_, data)| data);
    let flags = whole(next(), 0, 4, is_big).unwrap_or(0);
    let class = flags & 0xFF;
    // An object has no lengths.
    let lengths = if class == 17 { &[] } else { next() };
    let name = String::from_utf8_lossy(next()).into_owned();
    let shape: Vec<usize> = lengths.chunks_exact(4).filter_map(|length| whole(length, 0, 4, is_big)).collect();
    let other = OTHERS.iter().find(|(other, _)| *other == class).map(|(_, word)| *word);
    // Programs add what only they need, without a name.
    if name.is_empty() {
        return;
    }
    let Some((kind, data)) = parts.next().filter(|_| other.is_none() && flags & COMPLEX == 0) else {
        let reason = other.unwrap_or(if flags & COMPLEX == 0 { "cut short" } else { "complex numbers" });
        return arrays.left_out.push(format!("`{name}` ({reason})"));
    };
    // Numbers are written in as few bytes as they need.
    let form = match kind {
        1 | 3 | 5 => ('i', 1 << (kind / 2)),
        2 | 4 | 6 => ('u', 1 << (kind / 2 - 1)),
        7 | 9 => ('f', if kind == 7 { 4 } else { 8 }),
        12 => ('i', 8),
        13 => ('u', 8),
        _ => ('?', 1),
    };
    let form = Form { kind: form.0, size: form.1, is_big };
    let count = shape.iter().try_fold(1_usize, |all, length| all.checked_mul(*length));
    match form.numbers(data, form.size, room) {
        Ok(values) if Some(values.len()) == count => arrays.add(&name, None, &shape, true, values),
        Ok(_) => arrays.left_out.push(format!("`{name}` (cut short)")),
        Err(reason) => arrays.left_out.push(format!("`{name}` ({reason})")),
    }
}
