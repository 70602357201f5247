//! Packed files: gzip, and ZIP with one table in it; binary numbers, and the memory that they may take.

use std::io::Read;

use flate2::Crc;
use flate2::read::{DeflateDecoder, MultiGzDecoder};
use kalmanscope_filters::lists::mapped;

use super::super::{Dialect, ImportError, Mapping, Result, Table, reader};
use crate::task::{Progress, at_once};

/// A packed file may contain itself: it is not unpacked twice.
fn table(bytes: &[u8], dialect: Option<Dialect>) -> Result<Table> {
    if is_zip(bytes) || bytes.starts_with(b"\x1F\x8B") {
        return Err(ImportError::OtherKind("it is packed twice: unpack it once".to_owned()));
    }
    at_once(reader::read(bytes, dialect, &Progress::default()))
}

pub(super) fn gzip(bytes: &[u8], dialect: Option<Dialect>) -> Result<Table> {
    let file = Room::of(bytes).unpack(MultiGzDecoder::new(bytes));
    let file = file.map_err(|reason| ImportError::OtherKind(format!("this is a gzip file; {reason}")))?;
    table(&file, dialect)
}

pub(super) fn is_zip(bytes: &[u8]) -> bool {
    bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"PK\x05\x06")
}

pub(super) fn has_entry(bytes: &[u8], is: fn(&str) -> bool) -> bool {
    entries(bytes).is_some_and(|entries| entries.iter().any(|entry| is(&entry.name)))
}

pub(super) struct Entry<'a> {
    pub(super) name: String,
    head: &'a [u8],
    packed: &'a [u8],
}

/// `None` for a damaged ZIP. Source: PKWARE (2022), .ZIP file format specification, sections 4.3.7, 4.3.12 and 4.3.16.
pub(super) fn entries(bytes: &[u8]) -> Option<Vec<Entry<'_>>> {
    const END: [usize; 2] = [22, 65_536];
    let mut places = (0..=bytes.len().checked_sub(END[0])?).rev().take(END[1]);
    let end = places.find(|place| bytes[*place..].starts_with(b"PK\x05\x06"))?;
    let number = |place: usize, size: usize| whole(bytes, place, size, false);
    let (mut rest, mut entries) = (bytes.get(number(end + 16, 4)?..)?, Vec::new());
    for _ in 0..number(end + 10, 2)? {
        let at = |place: usize, size: usize| whole(rest, place, size, false);
        let (size, length, local) = (at(20, 4)?, at(28, 2)?, at(42, 4)?);
        let data = local.checked_add(30 + number(local.checked_add(26)?, 2)? + number(local.checked_add(28)?, 2)?)?;
        let packed = bytes.get(data..data.checked_add(size)?)?;
        let name = String::from_utf8_lossy(rest.get(46..46 + length)?).into_owned();
        let is_hidden = name.split('/').any(|part| part.starts_with('.') || part == "__MACOSX");
        if !name.ends_with('/') && !is_hidden {
            entries.push(Entry { name, head: rest, packed });
        }
        rest = rest.get(46 + length + at(30, 2)? + at(32, 2)?..)?;
    }
    Some(entries)
}

impl Entry<'_> {
    pub(super) fn unpack(&self, room: &mut Room) -> Result<Vec<u8>, String> {
        let at = |place: usize, size: usize| whole(self.head, place, size, false).unwrap_or(0);
        let bytes = match (at(8, 2) & 1, at(10, 2)) {
            (0, 0) => room.unpack(self.packed)?,
            (0, 8) => room.unpack(DeflateDecoder::new(self.packed))?,
            (0, method) => return Err(format!("it is packed by method {method}, which is not read")),
            _ => return Err("it is encrypted".to_owned()),
        };
        let mut sum = Crc::new();
        sum.update(&bytes);
        if sum.sum() as usize == at(16, 4) { Ok(bytes) } else { Err("it is damaged".to_owned()) }
    }
}

/// Apps for phones add small tables of names in a folder `meta`.
pub(super) fn zip(bytes: &[u8], dialect: Option<Dialect>) -> Result<Table> {
    const FEWEST: usize = 30;
    let bad = |reason: &str| ImportError::OtherKind(format!("this is a ZIP; {reason}"));
    let mut entries = entries(bytes).ok_or_else(|| bad("it is damaged or cut short"))?;
    let (mut room, mut tables, mut failed) = (Room::of(bytes), Vec::new(), String::new());
    for (place, entry) in entries.iter().enumerate() {
        let file = entry.unpack(&mut room).map_err(ImportError::OtherKind);
        match file.and_then(|file| table(&file, dialect)) {
            Ok(table) => tables.push((place, table)),
            Err(reason) => failed = format!(": `{}`: {reason}", entry.name),
        }
    }
    let one = |is: &dyn Fn(&(usize, Table)) -> bool| {
        let mut places = (0..tables.len()).filter(|place| is(&tables[*place]));
        places.next().filter(|_| places.next().is_none())
    };
    let is_record = |table: &Table| table.rows() >= FEWEST && Mapping::guess(table).0.time.column.is_some();
    let is_meta = |name: &str| name.to_lowercase().split('/').any(|part| part.starts_with("meta"));
    let found = one(&|(_, table)| is_record(table)).or_else(|| one(&|(place, _)| !is_meta(&entries[*place].name)));
    let Some(found) = found else {
        if tables.is_empty() {
            return Err(bad(&format!("there is no table in it{failed}")));
        }
        let names: Vec<String> = mapped(&tables, &|(place, _)| format!("`{}`", entries[*place].name));
        let names = list(&names);
        return Err(bad(&format!("it has several tables: {names}; unpack it and open one")));
    };
    let (place, mut table) = tables.swap_remove(found);
    let name = entries.remove(place).name;
    let others: Vec<String> = mapped(&entries, &|entry| format!("`{}`", entry.name));
    let rest = if others.is_empty() { String::new() } else { format!("; left out: {}", list(&others)) };
    table.remarks.insert(0, format!("the table is `{name}` of the ZIP{rest}"));
    Ok(table)
}

pub(super) fn list(words: &[String]) -> String {
    const MOST: usize = 8;
    let more = words.len().saturating_sub(MOST);
    let rest = if more > 0 { format!(" and {more} more") } else { String::new() };
    words[..words.len() - more].join(", ") + &rest
}

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

pub(super) fn whole(bytes: &[u8], place: usize, size: usize, is_big: bool) -> Option<usize> {
    Some(bits(bytes.get(place..place.checked_add(size)?)?, is_big) as usize)
}

fn bits(bytes: &[u8], is_big: bool) -> u64 {
    let add = |sum: u64, byte: &u8| sum << 8 | u64::from(*byte);
    if is_big { bytes.iter().fold(0, add) } else { bytes.iter().rev().fold(0, add) }
}

/// NumPy's letter: `f`, `i`, `u` or `b`; and the bytes.
#[derive(Clone, Copy)]
pub(super) struct NumberForm {
    pub(super) kind: char,
    pub(super) size: usize,
    pub(super) is_big: bool,
}

impl NumberForm {
    pub(super) fn number(self, bytes: &[u8]) -> f64 {
        let bits = bits(bytes, self.is_big);
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
