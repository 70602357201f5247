//! Files of MATLAB, version 5 (`-v6` and `-v7`): matrices as columns.

use flate2::read::ZlibDecoder;

use super::super::{ImportError, Table};
use super::arrays::{Arrays, product};
use super::binary::{Form, Room, whole};

const HEADER: usize = 128;
const MATRIX: usize = 14;
const COMPRESSED: usize = 15;

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

/// The matrices with equally many rows in a file of MATLAB.
///
/// Source: MathWorks, MAT-file format, level 5.
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
                Err(reason) => arrays.leave_out("", &format!("a variable ({reason})")),
            }
        }
    }
    if !parts.rest.is_empty() {
        arrays.leave_out("", "the end of the file, which is cut short");
    }
    arrays.table("a MATLAB file")
}

/// Adds a variable: its class and flags, its lengths, its name, its numbers.
fn add(arrays: &mut Arrays, mut parts: Parts<'_>, room: &mut Room) {
    let is_big = parts.is_big;
    let mut next = || parts.next().unwrap_or((0, &[]));
    let flags = whole(next().1, 0, 4, is_big).unwrap_or(0);
    // A table or another object has no lengths.
    let lengths = if flags & 0xFF == 17 { &[] } else { next().1 };
    let name = String::from_utf8_lossy(next().1).into_owned();
    let shape: Vec<usize> = lengths.chunks_exact(4).filter_map(|length| whole(length, 0, 4, is_big)).collect();
    // Programs add what only they need, without a name.
    if name.is_empty() {
        return;
    }
    let other = match flags & 0xFF {
        1 => "cell",
        2 => "struct",
        4 => "text",
        5 => "sparse matrix",
        6..=15 if flags & 0x800 != 0 => "complex numbers",
        6..=15 => "",
        _ => "table or other object",
    };
    let (kind, data) = next();
    // Numbers are written in as few bytes as they need.
    let (kind, size) = match kind {
        1..=6 => (if kind % 2 == 1 { 'i' } else { 'u' }, 1 << ((kind - 1) / 2)),
        7 => ('f', 4),
        9 => ('f', 8),
        _ => (if kind == 12 { 'i' } else { 'u' }, 8),
    };
    let values = match other {
        "" => Form { kind, size, is_big }.numbers(data, room),
        other => Err(other.to_owned()),
    };
    let is_whole = |values: &Vec<f64>| product(&shape) == Some(values.len());
    let values = values.and_then(|values| if is_whole(&values) { Ok(values) } else { Err("cut short".to_owned()) });
    arrays.add(&name, &shape, true, values);
}

#[cfg(test)]
pub(super) mod tests {
    use std::io::Write as _;

    use flate2::Compression;
    use flate2::write::ZlibEncoder;

    use super::*;

    fn part(kind: u32, data: &[u8]) -> Vec<u8> {
        let size = u32::try_from(data.len()).unwrap().to_le_bytes();
        let gap = if kind == 15 { 0 } else { data.len().next_multiple_of(8) - data.len() };
        [&kind.to_le_bytes()[..], &size, data, &vec![0; gap]].concat()
    }

    fn variable(name: &str, class: u8, [rows, columns]: [u8; 2], kind: u32, data: &[u8]) -> Vec<u8> {
        // A short part: its size stands beside its type.
        let short = [&[1, 0, name.len() as u8, 0], name.as_bytes(), &vec![0; 4 - name.len()]].concat();
        let lengths = part(5, &[rows, 0, 0, 0, columns, 0, 0, 0]);
        part(14, &[part(6, &[class, 0, 0, 0, 0, 0, 0, 0]), lengths, short, part(kind, data)].concat())
    }

    /// Times of two bytes, a matrix that is packed, a rate, and a structure.
    pub(in super::super) fn file() -> Vec<u8> {
        let times: Vec<u8> = (0..6_u16).flat_map(u16::to_le_bytes).collect();
        let data: Vec<u8> = (0..12).flat_map(|k| (f64::from(k) / 2.0).to_le_bytes()).collect();
        let mut packed = ZlibEncoder::new(Vec::new(), Compression::default());
        packed.write_all(&variable("acc", 6, [6, 2], 9, &data)).unwrap();
        let packed = part(15, &packed.finish().unwrap());
        let (rate, rest) = (variable("fs", 6, [1, 1], 2, &[100]), variable("s", 2, [1, 1], 5, &[0; 4]));
        let header = [&b"MATLAB 5.0 MAT-file"[..], &[b' '; 105], b"\x00\x01IM"].concat();
        [header, variable("t", 6, [6, 1], 4, &times), packed, rate, rest].concat()
    }

    #[test]
    fn matrices_are_columns_and_what_is_not_read_is_said() {
        let table = mat(&file()).unwrap();
        let names: Vec<&str> = table.columns.iter().map(|column| column.name.as_str()).collect();
        assert_eq!(names, ["t", "acc[0]", "acc[1]"]);
        assert_eq!(table.columns[0].values, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
        assert_eq!(table.columns[2].values, [3.0, 3.5, 4.0, 4.5, 5.0, 5.5]);
        assert_eq!(table.remarks, ["not read: `s` (struct)", "`fs` is 100, which is not used"]);
        let cut = mat(&file()[..file().len() - 20]).unwrap();
        assert!(cut.remarks[0].contains("cut short"), "{:?}", cut.remarks);
    }
}
