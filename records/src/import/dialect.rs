//! The form of a text file with columns of numbers, and the search for it in the first lines.

use std::fmt;

use super::cell::Content;
use super::{Decimal, Delimiter, Dialect, Encoding, header};

impl fmt::Display for Dialect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { encoding, delimiter, decimal, names, units, data, thousands } = self;
        let decimal = if *decimal == Decimal::Point { "points" } else { "commas" };
        write!(f, "{}, {} between cells, decimal {decimal}", encoding.name(), delimiter.name())?;
        if *thousands {
            f.write_str(", thousands apart")?;
        }
        match names {
            0 => f.write_str(", no names")?,
            line => write!(f, ", names in line {line}")?,
        }
        if *units > 0 {
            write!(f, ", units in line {units}")?;
        }
        write!(f, ", numbers from line {data} on")
    }
}

const MARKS: [(&[u8], Encoding); 3] =
    [(b"\xEF\xBB\xBF", Encoding::Utf8), (b"\xFF\xFE", Encoding::Utf16Le), (b"\xFE\xFF", Encoding::Utf16Be)];

impl Encoding {
    const fn name(self) -> &'static str {
        ["UTF-8", "Latin-1", "UTF-16", "UTF-16 (big-endian)"][self as usize]
    }

    /// The encoding of a file that begins with these bytes, or `None` if it is not text.
    pub fn sniff(bytes: &[u8]) -> Option<Self> {
        if let Some(&(_, marked)) = MARKS.iter().find(|(mark, _)| bytes.starts_with(mark)) {
            return Some(marked);
        }
        // Digits and delimiters have a zero byte each in UTF-16.
        let zeros = |first: usize| bytes.iter().skip(first).step_by(2).filter(|&&byte| byte == 0).count();
        let (even, odd) = (zeros(0), zeros(1));
        let most = bytes.len() / 3;
        if even + odd > 0 {
            return match (even, odd) {
                (0, _) if odd >= most => Some(Self::Utf16Le),
                (_, 0) if even >= most => Some(Self::Utf16Be),
                _ => None,
            };
        }
        let is_control = |byte: &&u8| **byte < b' ' && !matches!(**byte, b'\t' | b'\n' | b'\r' | 0x0C);
        let is_text = bytes.iter().filter(is_control).count() * 100 <= bytes.len();
        // The end may lie within a character.
        let is_utf8 = std::str::from_utf8(bytes).map_or_else(|error| error.error_len().is_none(), |_| true);
        is_text.then_some(if is_utf8 { Self::Utf8 } else { Self::Latin1 })
    }

    pub(super) fn mark(self, bytes: &[u8]) -> usize {
        let own = MARKS.iter().find(|(mark, encoding)| *encoding == self && bytes.starts_with(mark));
        own.map_or(0, |(mark, _)| mark.len())
    }

    pub(super) fn decode(self, bytes: &[u8], text: &mut String) {
        match self {
            Self::Utf8 => text.push_str(&String::from_utf8_lossy(bytes)),
            Self::Latin1 => text.extend(bytes.iter().map(|&byte| char::from(byte))),
            Self::Utf16Le | Self::Utf16Be => {
                let number = if self == Self::Utf16Be { u16::from_be_bytes } else { u16::from_le_bytes };
                let (pairs, _) = bytes.as_chunks::<2>();
                let characters = char::decode_utf16(pairs.iter().map(|pair| number(*pair)));
                text.extend(characters.map(|character| character.unwrap_or(char::REPLACEMENT_CHARACTER)));
            }
        }
    }

    /// In bytes, with the line's end; `None` without one.
    pub(super) fn line_length(self, bytes: &[u8]) -> Option<usize> {
        match self {
            Self::Utf8 | Self::Latin1 => bytes.iter().position(|&byte| byte == b'\n').map(|place| place + 1),
            Self::Utf16Le | Self::Utf16Be => {
                let end: [u8; 2] = if self == Self::Utf16Le { [b'\n', 0] } else { [0, b'\n'] };
                bytes.as_chunks::<2>().0.iter().position(|pair| *pair == end).map(|place| 2 * place + 2)
            }
        }
    }
}

pub(super) const REMARKS: [char; 2] = ['#', '%'];

impl Dialect {
    pub(super) fn sniff(encoding: Encoding, lines: &[&str]) -> Option<Self> {
        let lines = &lines[..lines.len().min(300)];
        let delimiters = [Delimiter::Semicolon, Delimiter::Tab, Delimiter::Comma, Delimiter::Blanks].into_iter();
        let both = |delimiter| [Decimal::Point, Decimal::Comma].map(|decimal| TextForm::new(delimiter, decimal, lines));
        let form = delimiters.flat_map(both).rev().max_by_key(TextForm::score).filter(|form| form.score() > 0)?;
        let data = form.data()?;
        let (names, units) = form.header(lines, data);
        let TextForm { delimiter, decimal, thousands, .. } = form;
        Some(Self { encoding, delimiter, decimal, names, units, data: data + 1, thousands })
    }

    pub(super) fn header(&self, lines: &[&str], columns: usize) -> Vec<(String, Option<String>)> {
        let line = |number: usize| number.checked_sub(1).and_then(|place| lines.get(place)).copied();
        let cells = |number: usize| line(number).map(|line| header_cells(self.delimiter, line, columns));
        let (names, units) = (cells(self.names).unwrap_or_default(), cells(self.units).unwrap_or_default());
        let one = |place: usize| {
            let header = names.get(place).filter(|name| !name.is_empty());
            let (name, own) = match header {
                Some(header) => header::name_and_unit(header),
                None => (format!("column {}", place + 1), None),
            };
            let below = units.get(place).map(|text| header::in_words(text)).filter(|text| !text.is_empty());
            (name, below.map(str::to_owned).or(own))
        };
        (0..columns).map(one).collect()
    }
}

/// With blanks between cells, a unit in brackets belongs to the name before it.
fn header_cells(delimiter: Delimiter, line: &str, columns: usize) -> Vec<String> {
    let line = line.trim_start_matches(['\u{FEFF}', ' ']).trim_start_matches(REMARKS);
    let mut cells: Vec<String> = delimiter.cells(line).map(str::to_owned).collect();
    if delimiter == Delimiter::Blanks && cells.len() > columns {
        let mut merged: Vec<String> = Vec::new();
        for cell in cells {
            match merged.last_mut() {
                Some(before) if cell.starts_with(['(', '[', '<']) => *before = format!("{before} {cell}"),
                _ => merged.push(cell),
            }
        }
        cells = merged;
    }
    while cells.len() > columns && cells.last().is_some_and(String::is_empty) {
        cells.pop();
    }
    cells
}

struct TextForm {
    delimiter: Delimiter,
    decimal: Decimal,
    lines: Vec<Counts>,
    columns: usize,
    thousands: bool,
}

#[derive(Clone, Copy, Default)]
struct Counts {
    cells: usize,
    numbers: usize,
    texts: usize,
    begins: bool,
}

impl Counts {
    fn is_data(self, columns: usize) -> bool {
        self.cells == columns && self.numbers > 0 && self.texts * 2 <= columns
    }
}

impl TextForm {
    fn new(delimiter: Delimiter, decimal: Decimal, lines: &[&str]) -> Self {
        let mut thousands = false;
        let mut count = |line: &&str| {
            let is_row = !line.trim_start().starts_with(REMARKS) && !line.trim().is_empty();
            // A comma cannot be both, except with cells in quotes.
            if !is_row || delimiter == Delimiter::Comma && decimal == Decimal::Comma && !line.contains('"') {
                return Counts::default();
            }
            let mut counts = Counts::default();
            for cell in delimiter.cells(line) {
                counts.cells += 1;
                match decimal.read(cell, false) {
                    Content::Number(number) if number.is_nan() => {}
                    Content::Number(_) | Content::Clock(..) => counts.numbers += 1,
                    Content::Grouped(_) => {
                        counts.numbers += 1;
                        thousands = true;
                    }
                    Content::Missing | Content::Word => {}
                    Content::Text => {
                        counts.begins |= counts.cells == 1;
                        counts.texts += 1;
                    }
                }
            }
            counts
        };
        let lines: Vec<Counts> = lines.iter().map(&mut count).collect();
        let with_numbers = || lines.iter().filter(|line| line.numbers > 0).map(|line| line.cells);
        let columns = with_numbers().max_by_key(|&cells| (with_numbers().filter(|&c| c == cells).count(), cells));
        Self { delimiter, decimal, columns: columns.unwrap_or(0), lines, thousands }
    }

    fn score(&self) -> i64 {
        let data = self.lines.iter().filter(|line| line.is_data(self.columns));
        data.map(|line| line.numbers as i64 - line.texts as i64).sum()
    }

    fn data(&self) -> Option<usize> {
        const NEXT: usize = 6;
        let rows = || self.lines.iter().filter(|line| line.is_data(self.columns));
        let begin_with_text = 2 * rows().filter(|line| line.begins).count() > rows().count();
        let is_first = |place: &usize| {
            let next: Vec<&Counts> = self.lines[*place..].iter().filter(|line| line.cells > 0).take(NEXT).collect();
            let data = next.iter().filter(|line| line.is_data(self.columns)).count();
            // A key and its value stand above names.
            let is_last = !next.iter().any(|line| line.numbers == 0 && line.texts > 0);
            let is_key = self.lines[*place].begins && !(is_last && begin_with_text);
            self.lines[*place].is_data(self.columns) && 2 * data >= next.len() && !is_key
        };
        (0..self.lines.len()).find(is_first)
    }

    fn header(&self, lines: &[&str], data: usize) -> (usize, usize) {
        let columns = self.columns;
        let above = (0..data).rev().filter(|&place| !lines[place].trim().is_empty());
        let cells = |place: usize| (place, header_cells(self.delimiter, lines[place], columns));
        let is_header = |(_, cells): &(usize, Vec<String>)| {
            let texts = cells.iter().filter(|c| self.decimal.number(c).is_none_or(f64::is_nan)).count();
            cells.len() == columns && texts * 2 > columns && cells.iter().any(|cell| !cell.is_empty())
        };
        let near: Vec<(usize, Vec<String>)> = above.map(cells).take_while(is_header).take(5).collect();
        let is_filled = |(_, cells): &&(usize, Vec<String>)| {
            let words = cells.iter().filter(|cell| cell.chars().any(char::is_alphabetic)).count();
            2 * words >= columns
        };
        // A line with a few numbers, such as the delays of the channels, names nothing.
        let filled: Vec<&(usize, Vec<String>)> = near.iter().filter(is_filled).collect();
        let are_units = |cells: &[String]| {
            // A single letter may name a channel.
            let is_unit = |cell: &&String| match header::unit(header::in_words(cell)) {
                Some((header::Dimension::Other, _)) => cell.chars().count() > 1,
                found => found.is_some(),
            };
            let known = cells.iter().filter(is_unit).count();
            let empty = cells.iter().filter(|cell| cell.is_empty()).count();
            known > 0 && (known + empty) * 2 > columns
        };
        // Keys of columns whose numbers have none: `Kanal;Kraft;Beschl`.
        if near.is_empty() && !self.lines[data].begins && self.delimiter.cells(lines[data]).next() == Some("") {
            let keyed = |words: &[&str]| {
                let is = |place: &usize| {
                    let cells = header_cells(self.delimiter, lines[*place], columns);
                    let key = cells.first().map(|key| key.to_lowercase()).unwrap_or_default();
                    cells.len() == columns && words.iter().any(|word| key.contains(word))
                };
                (0..data).find(is).map_or(0, |place| place + 1)
            };
            return (keyed(&["name", "kanal", "channel", "signal"]), keyed(&["unit", "einheit"]));
        }
        match (near.first(), filled.as_slice()) {
            (Some((last, cells)), [_, ..]) if are_units(cells) && near.len() > 1 => (near[1].0 + 1, last + 1),
            (_, filled)
                if let Some(place) = filled.iter().position(|(_, cells)| are_units(cells))
                    && let Some((names, _)) = filled.get(place + 1) =>
            {
                (names + 1, filled[place].0 + 1)
            }
            (_, [(last, cells), (above, names), ..]) if distinct(names) > distinct(cells) => (above + 1, last + 1),
            (_, [(last, _), ..]) | (Some((last, _)), []) => (last + 1, 0),
            (None, _) => (0, 0),
        }
    }
}

fn distinct(cells: &[String]) -> usize {
    (0..cells.len()).filter(|&place| !cells[..place].contains(&cells[place])).count()
}
