//! Packed files: gzip, and ZIP with one table in it.

use std::io::Read;

use flate2::Crc;
use flate2::read::{DeflateDecoder, MultiGzDecoder};

use super::super::reader::Reader;
use super::super::{Dialect, ImportError, Mapping, Table};
use super::kinds::whole;

/// The bytes that unpacked files and numbers may still take: 200 times those of the file, within these limits.
pub(super) struct Room(usize);

const LEAST_ROOM: usize = 64 << 20;
const MOST_ROOM: usize = 1 << 30;

impl Room {
    pub(super) fn of(file: &[u8]) -> Self {
        Self(file.len().saturating_mul(200).clamp(LEAST_ROOM, MOST_ROOM))
    }

    pub(super) fn take(&mut self, count: usize, size: usize) -> Result<(), String> {
        let left = count.checked_mul(size).and_then(|bytes| self.0.checked_sub(bytes));
        self.0 = left.unwrap_or(0);
        left.map(|_| ())
            .ok_or_else(|| "it is too large when unpacked: more than 200 times the file, or 1 GiB".to_owned())
    }

    pub(super) fn unpack(&mut self, packed: impl Read) -> Result<Vec<u8>, String> {
        let mut bytes = Vec::new();
        let read = packed.take(self.0 as u64 + 1).read_to_end(&mut bytes);
        self.take(bytes.len(), 1)?;
        read.map_or_else(|_| Err("it is damaged or cut short".to_owned()), |_| Ok(bytes))
    }
}

/// The table in an unpacked file. A packed file may have itself in it: it is not unpacked twice.
fn table(bytes: Vec<u8>, dialect: Option<Dialect>) -> Result<Table, ImportError> {
    if is_zip(&bytes) || bytes.starts_with(b"\x1F\x8B") {
        return Err(ImportError::OtherKind("it is packed twice: unpack it once".to_owned()));
    }
    Reader::read(bytes, dialect)
}

/// The table in a file of gzip.
///
/// # Errors
/// [`ImportError`] where it cannot be unpacked, or where there is no table in it.
pub(super) fn gzip(bytes: &[u8], dialect: Option<Dialect>) -> Result<Table, ImportError> {
    let file = Room::of(bytes).unpack(MultiGzDecoder::new(bytes));
    let file = file.map_err(|reason| ImportError::OtherKind(format!("this is a gzip file; {reason}")))?;
    table(file, dialect)
}

pub(super) fn is_zip(bytes: &[u8]) -> bool {
    bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"PK\x05\x06")
}

/// Whether a file with some name is in a ZIP.
pub(super) fn has_entry(bytes: &[u8], is: fn(&str) -> bool) -> bool {
    entries(bytes).is_some_and(|entries| entries.iter().any(|entry| is(&entry.name)))
}

/// A file in a ZIP.
pub(super) struct Entry<'a> {
    pub(super) name: String,
    packed: &'a [u8],
    is_encrypted: bool,
    method: usize,
    checksum: usize,
}

/// The files in a ZIP, without folders and those that systems add. `None` for one that is cut short or damaged.
///
/// Source: PKWARE (2022), .ZIP file format specification, sections 4.3.7, 4.3.12 and 4.3.16.
pub(super) fn entries(bytes: &[u8]) -> Option<Vec<Entry<'_>>> {
    /// The bytes of the end of the directory, and the most behind it.
    const END: [usize; 2] = [22, 65_536];
    let places = (0..=bytes.len().checked_sub(END[0])?).rev().take(END[1]);
    let end = places.into_iter().find(|place| bytes[*place..].starts_with(b"PK\x05\x06"))?;
    let number = |place: usize, size: usize| whole(bytes, place, size, false);
    let mut head = number(end + 16, 4)?;
    let mut entries = Vec::new();
    for _ in 0..number(end + 10, 2)? {
        let at = |offset: usize, size: usize| number(head.checked_add(offset)?, size);
        if at(0, 4)? != 0x0201_4B50 {
            return None;
        }
        let (size, length, local) = (at(20, 4)?, at(28, 2)?, at(42, 4)?);
        let data = local.checked_add(30 + number(local.checked_add(26)?, 2)? + number(local.checked_add(28)?, 2)?)?;
        let packed = bytes.get(data..data.checked_add(size)?)?;
        let name = String::from_utf8_lossy(bytes.get(head + 46..head + 46 + length)?).into_owned();
        let (is_encrypted, method, checksum) = (at(8, 2)? & 1 == 1, at(10, 2)?, at(16, 4)?);
        head = head.checked_add(46 + length + at(30, 2)? + at(32, 2)?)?;
        let is_hidden = name.split('/').any(|part| part.starts_with('.') || part == "__MACOSX");
        if !name.ends_with('/') && !is_hidden {
            entries.push(Entry { name, packed, is_encrypted, method, checksum });
        }
    }
    Some(entries)
}

impl Entry<'_> {
    pub(super) fn unpack(&self, room: &mut Room) -> Result<Vec<u8>, String> {
        let bytes = match self.method {
            _ if self.is_encrypted => return Err("it is encrypted".to_owned()),
            0 => room.unpack(self.packed)?,
            8 => room.unpack(DeflateDecoder::new(self.packed))?,
            other => return Err(format!("it is packed by method {other}, which is not read")),
        };
        let mut sum = Crc::new();
        sum.update(&bytes);
        if sum.sum() as usize == self.checksum { Ok(bytes) } else { Err("it is damaged".to_owned()) }
    }
}

/// The one table with times in a ZIP. Apps for phones add small tables of names in a folder `meta`.
///
/// # Errors
/// [`ImportError::OtherKind`] where there is none, or more than one.
pub(super) fn zip(bytes: &[u8], dialect: Option<Dialect>) -> Result<Table, ImportError> {
    /// The fewest rows that a record has for certain.
    const FEWEST: usize = 30;
    let bad = |reason: &str| ImportError::OtherKind(format!("this is a ZIP; {reason}"));
    let entries = entries(bytes).ok_or_else(|| bad("it is damaged or cut short"))?;
    let mut room = Room::of(bytes);
    let (mut tables, mut failed) = (Vec::new(), Vec::new());
    for entry in &entries {
        let file = entry.unpack(&mut room).map_err(ImportError::OtherKind);
        match file.and_then(|file| table(file, dialect)) {
            Ok(table) => tables.push((entry.name.as_str(), table)),
            Err(reason) => failed.push(format!("`{}`: {reason}", entry.name)),
        }
    }
    let is_record =
        |(_, table): &(&str, Table)| table.rows() >= FEWEST && Mapping::guess(table).0.time.column.is_some();
    let is_meta = |name: &str| name.to_lowercase().split('/').any(|part| part.starts_with("meta"));
    let one = |is: &dyn Fn(&(&str, Table)) -> bool| {
        let mut places = (0..tables.len()).filter(|place| is(&tables[*place]));
        places.next().filter(|_| places.next().is_none())
    };
    let Some(place) = one(&is_record).or_else(|| one(&|(name, _)| !is_meta(name))) else {
        return Err(match (tables.is_empty(), failed.first()) {
            (true, None) => bad("there is no file in it"),
            (true, Some(first)) => bad(&format!("there is no table in its {} file(s): {first}", failed.len())),
            (false, _) => bad(&format!(
                "it has several tables: {}; unpack it and open one",
                list(tables.iter().map(|(name, _)| *name))
            )),
        });
    };
    let (name, mut table) = tables.swap_remove(place);
    let others: Vec<&str> = entries.iter().map(|entry| entry.name.as_str()).filter(|other| *other != name).collect();
    let rest = if others.is_empty() { String::new() } else { format!("; left out: {}", list(others.into_iter())) };
    table.remarks.insert(0, format!("the table is `{name}` of the ZIP{rest}"));
    Ok(table)
}

/// Some names in one line, and the number of those that would be too many.
pub(super) fn list<'a>(names: impl ExactSizeIterator<Item = &'a str>) -> String {
    /// Limits the names in a sentence.
    const MOST: usize = 8;
    let more = if names.len() > MOST { format!(" and {} more", names.len() - MOST) } else { String::new() };
    names.take(MOST).map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ") + &more
}
