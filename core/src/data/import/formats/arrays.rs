//! Arrays of numbers as columns: files of NumPy, one array or several.

use serde_json::Value;

use super::super::error::MOST_COLUMNS;
use super::super::guess::is_named_time;
use super::super::{Column, ImportError, Mapping, Table};
use super::kinds::whole;
use super::nameless::{RATES, STEPS};
use super::unpack::{Room, entries};

/// The form of a binary number: `f`, `i`, `u`, or in NumPy `b`, `m` and `M`, and its bytes.
#[derive(Clone, Copy)]
pub(super) struct Form {
    pub(super) kind: char,
    pub(super) size: usize,
    pub(super) is_big: bool,
}

impl Form {
    /// Whether it can be read.
    fn is_known(self) -> bool {
        let sizes: &[usize] = match self.kind {
            'f' => &[4, 8],
            'i' | 'u' => &[1, 2, 4, 8],
            'b' => &[1],
            'm' | 'M' => &[8],
            _ => &[],
        };
        sizes.contains(&self.size)
    }

    /// The number in as many bytes.
    pub(super) fn number(self, bytes: &[u8]) -> f64 {
        let add = |sum: u64, byte: &u8| sum << 8 | u64::from(*byte);
        let bits = if self.is_big { bytes.iter().fold(0, add) } else { bytes.iter().rev().fold(0, add) };
        let signed = |bits: u64| (bits << (64 - 8 * self.size)) as i64 >> (64 - 8 * self.size);
        match (self.kind, self.size) {
            ('f', 4) => f64::from(f32::from_bits(bits as u32)),
            ('f', _) => f64::from_bits(bits),
            // No time.
            ('m' | 'M', _) if bits == 1 << 63 => f64::NAN,
            ('i' | 'm' | 'M', _) => signed(bits) as f64,
            _ => bits as f64,
        }
    }

    /// The numbers at the beginning of each part of `step` bytes.
    pub(super) fn numbers(self, bytes: &[u8], step: usize, room: &mut Room) -> Result<Vec<f64>, String> {
        if !self.is_known() {
            return Err(format!("numbers of {} bytes of type {}", self.size, self.kind));
        }
        room.take(bytes.len() / step, 8)?;
        Ok(bytes.chunks(step).filter_map(|part| Some(self.number(part.get(..self.size)?))).collect())
    }
}

/// The arrays of a file, and those parts of it that are none.
#[derive(Default)]
pub(super) struct Arrays {
    /// Name, unit, and columns of the same length.
    all: Vec<(String, Option<String>, Vec<Vec<f64>>)>,
    /// Parts that are not read, in words.
    pub(super) left_out: Vec<String>,
}

impl Arrays {
    /// Adds an array with one or two dimensions, of which the longer one is time. `is_by_columns`: neighbours are below each other.
    pub(super) fn add(
        &mut self,
        name: &str,
        unit: Option<&str>,
        shape: &[usize],
        is_by_columns: bool,
        values: Vec<f64>,
    ) {
        let wide: Vec<usize> = shape.iter().copied().filter(|length| *length != 1).collect();
        let columns = match *wide.as_slice() {
            _ if values.is_empty() => return self.left_out.push(format!("`{name}` (empty)")),
            [] | [_] => vec![values],
            [rows, columns] if rows.min(columns) <= MOST_COLUMNS => {
                // The places of neighbours in time and of the columns, in steps of a number.
                let [down, across] = if is_by_columns { [1, rows] } else { [columns, 1] };
                let [down, across] = if rows < columns { [across, down] } else { [down, across] };
                let column = |k: usize| values.iter().skip(k * across).step_by(down).take(rows.max(columns)).copied();
                (0..rows.min(columns)).map(|k| column(k).collect()).collect()
            }
            _ => {
                let shape: Vec<String> = shape.iter().map(ToString::to_string).collect();
                return self.left_out.push(format!("`{name}` ({} numbers)", shape.join(" × ")));
            }
        };
        self.all.push((name.to_owned(), unit.map(str::to_owned), columns));
    }

    /// A table of the arrays with equally many rows: those with the times, or else with the most numbers. A single number that is named so
    /// is the rate.
    pub(super) fn table(self, form: &str) -> Result<Table, ImportError> {
        let Self { all, mut left_out } = self;
        let (single, all): (Vec<_>, Vec<_>) = all.into_iter().partition(|(_, _, columns)| columns[0].len() == 1);
        let rows_of = |columns: &[Vec<f64>]| columns[0].len();
        let is_time =
            |name: &str, unit: &Option<String>| is_named_time(&Column::of_header(name, unit.as_deref(), Vec::new()));
        let rows = all.iter().map(|(_, _, columns)| rows_of(columns)).max_by_key(|rows| {
            let group = || all.iter().filter(|(_, _, columns)| rows_of(columns) == *rows);
            let columns: usize = group().map(|(_, _, columns)| columns.len()).sum();
            (group().any(|(name, unit, _)| is_time(name, unit)), rows * columns)
        });
        let mut columns: Vec<Column> = Vec::new();
        for (name, unit, own) in all {
            if Some(rows_of(&own)) != rows || columns.len() + own.len() > MOST_COLUMNS {
                left_out.push(format!("`{name}` ({} × {} numbers)", rows_of(&own), own.len()));
                continue;
            }
            let count = own.len();
            for (k, values) in own.into_iter().enumerate() {
                let mut column = Column::of_header(&name, unit.as_deref(), values);
                match (name.is_empty(), count) {
                    (true, _) => column.name = format!("column {}", columns.len() + 1),
                    (false, 1) => {}
                    (false, _) => column.name = format!("{}[{k}]", column.name),
                }
                columns.push(column);
            }
        }
        let left_out = left_out.join(", ");
        let Some(rows) = rows else {
            let rest = if left_out.is_empty() { String::new() } else { format!("; not read: {left_out}") };
            return Err(ImportError::OtherKind(format!("this is {form} without arrays of numbers{rest}")));
        };
        let mut remarks = Vec::new();
        if !left_out.is_empty() {
            remarks.push(format!("not read: {left_out}"));
        }
        let mut table =
            Table::of_columns(&format!("{form}: {} columns of {rows} numbers", columns.len()), columns, remarks);
        let mut is_timeless = Mapping::guess(&table).0.time.column.is_none();
        for (name, _, value) in single {
            let value = value[0][0];
            let step = step_of(&name, value).filter(|_| is_timeless);
            table.remarks.push(match step {
                Some(step) => format!("`{name}` is {value}: the rows are {step} s apart"),
                None => format!("`{name}` is {value}, which is not used"),
            });
            if let Some(step) = step {
                let times = (0..rows).map(|k| k as f64 * step).collect();
                table.columns.insert(0, Column::of_header("time", Some("s"), times));
                is_timeless = false;
            }
        }
        Ok(table)
    }
}

/// The time between samples that a number states which has the name of a rate or a step \[s\].
fn step_of(name: &str, value: f64) -> Option<f64> {
    let letters = |text: &str| text.to_lowercase().chars().filter(|c| c.is_alphanumeric()).collect::<String>();
    let name = letters(name);
    let is = |words: &[&str], others: [&str; 3], unit: &str| {
        let name = name.strip_suffix(unit).filter(|rest| !rest.is_empty()).unwrap_or(&name);
        words.iter().chain(&others).any(|word| letters(word) == name)
    };
    let is_rate = is(&RATES, ["sr", "rate", "frequency"], "hz");
    let step = if is_rate { 1.0 / value } else { value };
    ((is_rate || is(&STEPS, ["ts", "step", "period"], "sec")) && step.is_finite() && step > 0.0).then_some(step)
}

/// A part of each row of an array of NumPy.
struct Field {
    name: String,
    form: Form,
    count: usize,
    unit: Option<String>,
}

impl Field {
    /// Of a type such as `<f8` or `<M8[ns]`.
    fn of(name: &str, letters: &str, count: usize) -> Option<Self> {
        let mut rest = letters.chars();
        let (order, kind) = (rest.next()?, rest.next()?);
        let (size, unit) = rest.as_str().split_once('[').unwrap_or((rest.as_str(), ""));
        let unit = unit.strip_suffix(']').map(str::to_owned);
        // A letter of Unicode has four bytes.
        let size = size.parse::<usize>().ok()?.checked_mul(if kind == 'U' { 4 } else { 1 })?;
        Some(Self { name: name.to_owned(), form: Form { kind, size, is_big: order == '>' }, count, unit })
    }

    /// Of a name, a type, and perhaps the shape of a row's part.
    fn of_row(row: &Value) -> Option<Self> {
        let name = row.get(0).and_then(|name| name.as_str().or_else(|| name.get(1)?.as_str()))?;
        let count = row.get(2).map_or(Some(1), |shape| product(&lengths(shape)?))?;
        Self::of(name, row.get(1)?.as_str()?, count)
    }
}

fn lengths(shape: &Value) -> Option<Vec<usize>> {
    shape.as_array()?.iter().map(|length| usize::try_from(length.as_u64()?).ok()).collect()
}

fn product(shape: &[usize]) -> Option<usize> {
    shape.iter().try_fold(1_usize, |all, length| all.checked_mul(*length))
}

/// A literal of Python as JSON: text in other quotes, lists for tuples, no comma at the end.
fn json(literal: &str) -> String {
    let (mut out, mut quote, mut is_escaped) = (String::new(), None, false);
    for c in literal.chars() {
        match (quote, c) {
            (Some(_), _) if is_escaped => {
                out.extend((c != '\'').then_some('\\').into_iter().chain([c]));
                is_escaped = false;
            }
            (Some(_), '\\') => is_escaped = true,
            (Some(own), _) if c == own => {
                quote = None;
                out.push('"');
            }
            (Some(_), '"') => out.push_str("\\\""),
            (None, '\'' | '"') => {
                quote = Some(c);
                out.push('"');
            }
            (None, ')' | ']' | '}') => {
                out.truncate(out.trim_end_matches([' ', ',']).len());
                out.push(if c == '}' { c } else { ']' });
            }
            (None, '(') => out.push('['),
            _ => out.push(c),
        }
    }
    out.replace(": False", ": false").replace(": True", ": true")
}

impl Arrays {
    /// Adds an array as NumPy writes it, or the columns of one whose rows have names.
    ///
    /// Source: NumPy, numpy.lib.format, versions 1 to 3.
    fn add_npy(&mut self, name: &str, bytes: &[u8], room: &mut Room) -> Result<(), String> {
        let is_first = bytes.get(6) == Some(&1);
        let start = if is_first { 10 } else { 12 };
        let header = || {
            let end = whole(bytes, 8, start - 8, false)?.checked_add(start)?;
            let header: Value = serde_json::from_str(&json(&String::from_utf8_lossy(bytes.get(start..end)?))).ok()?;
            let fields = match header.get("descr")? {
                Value::Array(rows) => rows.iter().map(Field::of_row).collect::<Option<Vec<_>>>()?,
                letters => vec![Field::of(name, letters.as_str()?, 1)?],
            };
            let is_by_columns = header.get("fortran_order")?.as_bool()?;
            Some((end, fields, lengths(header.get("shape")?)?, is_by_columns, header.get("descr")?.is_array()))
        };
        let (end, fields, shape, is_by_columns, has_names) = header().ok_or("its header cannot be read")?;
        let width =
            fields.iter().try_fold(0_usize, |sum, field| sum.checked_add(field.form.size.checked_mul(field.count)?));
        let size = width.and_then(|width| product(&shape)?.checked_mul(width));
        let size = size.filter(|size| *size <= bytes.len() - end).ok_or("it is shorter than its header says")?;
        let (rows, width, mut place) = (&bytes[end..end + size], width.unwrap_or(0).max(1), 0);
        for Field { name, form, count, unit } in fields {
            for k in 0..count.min(MOST_COLUMNS) {
                let values = form.numbers(rows.get(place + k * form.size..).unwrap_or_default(), width, room);
                let name = if count == 1 { name.clone() } else { format!("{name}[{k}]") };
                let length = [rows.len() / width];
                match values {
                    Ok(values) => self.add(
                        &name,
                        unit.as_deref(),
                        if has_names { &length } else { &shape },
                        is_by_columns,
                        values,
                    ),
                    Err(reason) if !name.is_empty() => self.left_out.push(format!("`{name}` ({reason})")),
                    Err(reason) => self.left_out.push(reason),
                }
            }
            place += form.size * count;
        }
        Ok(())
    }
}

/// The columns of an array in a file of NumPy.
///
/// # Errors
/// [`ImportError::OtherKind`] where there are no numbers in it, or fewer than its header says.
pub(super) fn npy(bytes: &[u8]) -> Result<Table, ImportError> {
    let mut arrays = Arrays::default();
    let read = arrays.add_npy("", bytes, &mut Room::of(bytes));
    read.map_err(|reason| ImportError::OtherKind(format!("this is a NumPy file; {reason}")))?;
    arrays.table("a NumPy array")
}

/// The arrays of equal length in an archive of NumPy.
///
/// # Errors
/// [`ImportError::OtherKind`] where there are none.
pub(super) fn npz(bytes: &[u8]) -> Result<Table, ImportError> {
    let (mut arrays, mut room) = (Arrays::default(), Room::of(bytes));
    for entry in entries(bytes).unwrap_or_default() {
        let name = entry.name.strip_suffix(".npy").unwrap_or(&entry.name);
        let read = entry.unpack(&mut room).and_then(|file| arrays.add_npy(name, &file, &mut room));
        if let Err(reason) = read {
            arrays.left_out.push(format!("`{name}`: {reason}"));
        }
    }
    arrays.table("a NumPy archive")
}
