//! Arrays of numbers as columns: files of NumPy, one array or several, and of MATLAB, version 5 (`-v6` and `-v7`).

use flate2::read::ZlibDecoder;
use serde_json::Value;

use super::super::guess::is_named_time;
use super::super::header::{RATES, STEPS};
use super::super::table::number_names;
use super::super::{Column, ImportError, MOST_COLUMNS, Mapping, Result, Table};
use super::unpack::{NumberForm, Room, entries, list, whole};

#[derive(Default)]
pub(super) struct Arrays {
    all: Vec<Vec<Column>>,
    left_out: Vec<String>,
}

impl Arrays {
    pub(super) fn leave_out(&mut self, name: &str, reason: &str) {
        self.left_out.push(if name.is_empty() { reason.to_owned() } else { format!("`{name}` ({reason})") });
    }

    /// The longer of two dimensions is time. `is_by_columns`: neighbours are below each other.
    pub(super) fn add(&mut self, name: &str, shape: &[usize], is_by_columns: bool, values: Result<Vec<f64>, String>) {
        let values = match values {
            Ok(values) if values.is_empty() => return self.leave_out(name, "empty"),
            Ok(values) => values,
            Err(reason) => return self.leave_out(name, &reason),
        };
        let wide: Vec<usize> = shape.iter().copied().filter(|length| *length != 1).collect();
        let (count, down, across) = match *wide.as_slice() {
            [] | [_] => (1, 1, 1),
            [rows, columns] if rows.min(columns) <= MOST_COLUMNS => {
                let [down, across] = if is_by_columns { [1, rows] } else { [columns, 1] };
                if rows < columns { (rows, across, down) } else { (columns, down, across) }
            }
            _ => return self.leave_out(name, &format!("an array of {} dimensions", wide.len())),
        };
        let rows = values.len() / count;
        let column = |k: usize| {
            let numbers = values.iter().skip(k * across).step_by(down).take(rows).copied().collect();
            let mut column = Column::of_header(name, None, numbers);
            match count {
                _ if name.is_empty() => column.name = format!("column {}", k + 1),
                1 => {}
                _ => column.name = format!("{}[{k}]", column.name),
            }
            column
        };
        self.all.push((0..count).map(column).collect());
    }

    /// Of the arrays with equally many rows it has those with times, else those with the most numbers.
    pub(super) fn table(mut self, form: &str) -> Result<Table> {
        let all = std::mem::take(&mut self.all);
        let (single, all): (Vec<_>, Vec<_>) = all.into_iter().partition(|columns| columns[0].values.len() == 1);
        let lengths = all.iter().map(|columns| columns[0].values.len());
        let most = lengths.clone().max().unwrap_or(0);
        let rows = lengths.max_by_key(|rows| {
            let group = all.iter().filter(|columns| columns[0].values.len() == *rows);
            let is_time = |own: &Vec<Column>| own.len() == 1 && is_named_time(&own[0]) && own[0].values.is_sorted();
            // Few times are those of events.
            (10 * rows >= most && group.clone().any(is_time), rows * group.flatten().count())
        });
        let mut columns: Vec<Column> = Vec::new();
        for own in all {
            let length = own[0].values.len();
            if Some(length) == rows && columns.len() + own.len() <= MOST_COLUMNS {
                columns.extend(own);
            } else {
                self.leave_out(&own[0].name, &format!("{length} rows"));
            }
        }
        number_names(&mut columns);
        let left_out = (!self.left_out.is_empty()).then(|| format!("not read: {}", list(&self.left_out)));
        let Some(rows) = rows else {
            let rest = left_out.map_or(String::new(), |left_out| format!("; {left_out}"));
            let reason = format!("this is {form} without columns of numbers; save them as arrays or as CSV{rest}");
            return Err(ImportError::OtherKind(reason));
        };
        let form = format!("{form}: {} columns of {rows} numbers", columns.len());
        let mut table = Table::of_columns(&form, columns, left_out.into_iter().collect());
        let mut has_times = Mapping::guess(&table).0.time.column.is_some();
        for Column { name, values, .. } in single.into_iter().flatten() {
            let step = step_of(&name, values[0]).filter(|_| !has_times);
            let use_of = step.map_or("which is not used".to_owned(), |step| format!("so the rows are {step} s apart"));
            table.remarks.push(format!("`{name}` is {}, {use_of}", values[0]));
            if let Some(step) = step {
                let times = (0..rows).map(|k| k as f64 * step).collect();
                table.columns.insert(0, Column::of_header("time", Some("s"), times));
                has_times = true;
            }
        }
        Ok(table)
    }

    /// Source: NumPy, numpy.lib.format, versions 1 to 3.
    fn add_npy(&mut self, name: &str, bytes: &[u8], room: &mut Room) -> Result<(), String> {
        let start = if bytes.get(6) == Some(&1) { 10 } else { 12 };
        let header = || {
            let end = whole(bytes, 8, start - 8, false)?.checked_add(start)?;
            // A literal of Python as JSON.
            let pairs =
                [("(", "["), (")", "]"), ("'", "\""), (",]", "]"), (", }", "}"), (": F", ": f"), (": T", ": t")];
            let text = String::from_utf8_lossy(bytes.get(start..end)?).into_owned();
            let text = pairs.iter().fold(text, |text, (from, to)| text.replace(from, to));
            let header: Value = serde_json::from_str(&text).ok()?;
            let is_by_columns = header["fortran_order"].as_bool()?;
            Some((end, header["descr"].as_str().map(str::to_owned), lengths(&header["shape"])?, is_by_columns))
        };
        let (end, letters, shape, is_by_columns) = header().ok_or("its header cannot be read")?;
        // A type such as `<f8`. The bytes of an object are elsewhere.
        let letters = letters.ok_or("its rows have names: save each column as an array")?;
        let mut rest = letters.chars();
        let (is_big, kind) = (rest.next() == Some('>'), rest.next().unwrap_or('O'));
        let size = rest.as_str().parse::<usize>().unwrap_or(1).max(1);
        let count = product(&shape).and_then(|count| count.checked_mul(size));
        let data = count.and_then(|count| bytes[end..].get(..count)).ok_or("it is shorter than its header says")?;
        self.add(name, &shape, is_by_columns, NumberForm { kind, size, is_big }.numbers(data, room));
        Ok(())
    }
}

/// \[s\]
fn step_of(name: &str, value: f64) -> Option<f64> {
    let letters = |text: &str| text.to_lowercase().replace(|c: char| !c.is_alphanumeric(), "");
    let name = letters(name);
    let is = |words: &str, others: [&str; 2], unit: &str| {
        let name = name.strip_suffix(unit).unwrap_or(&name);
        words.split(", ").chain(others).any(|word| letters(word) == name)
    };
    // A number of four bytes stands for its shortest decimal.
    let short = value as f32;
    let value = if f64::from(short) == value { short.to_string().parse().ok()? } else { value };
    let step = if is(RATES, ["sr", "rate"], "hz") { Some(1.0 / value) } else { None };
    step.or(is(STEPS, ["ts", "period"], "sec").then_some(value)).filter(|step| step.is_finite() && *step > 0.0)
}

fn lengths(shape: &Value) -> Option<Vec<usize>> {
    shape.as_array()?.iter().map(|length| usize::try_from(length.as_u64()?).ok()).collect()
}

pub(super) fn product(shape: &[usize]) -> Option<usize> {
    shape.iter().try_fold(1_usize, |all, length| all.checked_mul(*length))
}

pub(super) fn npy(bytes: &[u8]) -> Result<Table> {
    let mut arrays = Arrays::default();
    let read = arrays.add_npy("", bytes, &mut Room::of(bytes));
    read.map_err(|reason| ImportError::OtherKind(format!("this is a NumPy file; {reason}")))?;
    arrays.table("a NumPy array")
}

pub(super) fn npz(bytes: &[u8]) -> Result<Table> {
    let (mut arrays, mut room) = (Arrays::default(), Room::of(bytes));
    for entry in entries(bytes).unwrap_or_default() {
        let name = entry.name.strip_suffix(".npy").unwrap_or(&entry.name);
        let read = entry.unpack(&mut room).and_then(|file| arrays.add_npy(name, &file, &mut room));
        read.unwrap_or_else(|reason| arrays.leave_out(name, &reason));
    }
    arrays.table("a NumPy archive")
}

const HEADER: usize = 128;
const MATRIX: usize = 14;
const COMPRESSED: usize = 15;

struct ArrayParts<'a> {
    rest: &'a [u8],
    is_big: bool,
}

impl<'a> Iterator for ArrayParts<'a> {
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

/// Source: MathWorks, MAT-file format, level 5.
pub(super) fn mat(bytes: &[u8]) -> Result<Table> {
    let (mut arrays, mut room) = (Arrays::default(), Room::of(bytes));
    let is_big = bytes.get(126) == Some(&b'M');
    let mut parts = ArrayParts { rest: bytes.get(HEADER..).unwrap_or_default(), is_big };
    for (kind, data) in &mut parts {
        if kind == MATRIX {
            add_variable(&mut arrays, ArrayParts { rest: data, is_big }, &mut room);
        } else if kind == COMPRESSED {
            match room.unpack(ZlibDecoder::new(data)) {
                Ok(inside) => (ArrayParts { rest: &inside, is_big })
                    .filter(|(kind, _)| *kind == MATRIX)
                    .for_each(|(_, data)| add_variable(&mut arrays, ArrayParts { rest: data, is_big }, &mut room)),
                Err(reason) => arrays.leave_out("", &format!("a variable ({reason})")),
            }
        }
    }
    if !parts.rest.is_empty() {
        arrays.leave_out("", "the end of the file, which is cut short");
    }
    arrays.table("a MATLAB file")
}

fn add_variable(arrays: &mut Arrays, mut parts: ArrayParts<'_>, room: &mut Room) {
    let is_big = parts.is_big;
    let mut next = || parts.next().unwrap_or((0, &[]));
    let flags = whole(next().1, 0, 4, is_big).unwrap_or(0);
    // A table or another object has no lengths.
    let lengths = if flags & 0xFF == 17 { &[] } else { next().1 };
    let name = String::from_utf8_lossy(next().1).into_owned();
    let shape: Vec<usize> = lengths.chunks_exact(4).filter_map(|length| whole(length, 0, 4, is_big)).collect();
    // Programs store internal data without a name.
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
        "" => NumberForm { kind, size, is_big }.numbers(data, room),
        other => Err(other.to_owned()),
    };
    let is_whole = |values: &Vec<f64>| product(&shape) == Some(values.len());
    let values = values.and_then(|values| if is_whole(&values) { Ok(values) } else { Err("cut short".to_owned()) });
    arrays.add(&name, &shape, true, values);
}
