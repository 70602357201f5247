//! Arrays of numbers as columns: files of NumPy, one array or several.

use serde_json::Value;

use super::super::error::MOST_COLUMNS;
use super::super::guess::is_named_time;
use super::super::header::{RATES, STEPS};
use super::super::table::free_name;
use super::super::{Column, ImportError, Mapping, Table};
use super::binary::{Form, Room, whole};
use super::unpack::{entries, list};

#[derive(Default)]
pub(super) struct Arrays {
    all: Vec<Vec<Column>>,
    left_out: Vec<String>,
}

impl Arrays {
    pub(super) fn leave_out(&mut self, name: &str, reason: &str) {
        self.left_out.push(if name.is_empty() { reason.to_owned() } else { format!("`{name}` ({reason})") });
    }

    /// Adds an array with one or two dimensions, of which the longer one is time. `is_by_columns`: neighbours are below each other.
    pub(super) fn add(&mut self, name: &str, shape: &[usize], is_by_columns: bool, values: Result<Vec<f64>, String>) {
        let values = match values {
            Ok(values) if values.is_empty() => return self.leave_out(name, "empty"),
            Ok(values) => values,
            Err(reason) => return self.leave_out(name, &reason),
        };
        let wide: Vec<usize> = shape.iter().copied().filter(|length| *length != 1).collect();
        // The number of columns, and the steps to the next number in time and to the next column.
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

    /// A table of the arrays with equally many rows: those with the times, or else with the most numbers. A single number with the
    /// name of a rate or a step makes times where there are none.
    pub(super) fn table(mut self, form: &str) -> Result<Table, ImportError> {
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
                for mut column in own {
                    column.name = free_name(&column.name, |name| columns.iter().any(|other| other.name == name));
                    columns.push(column);
                }
            } else {
                self.leave_out(&own[0].name, &format!("{length} rows"));
            }
        }
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
}

/// The time between samples that a number states which has the name of a rate or a step \[s\].
fn step_of(name: &str, value: f64) -> Option<f64> {
    let letters = |text: &str| text.to_lowercase().replace(|c: char| !c.is_alphanumeric(), "");
    let name = letters(name);
    let is = |words: &[&str], others: [&str; 2], unit: &str| {
        let name = name.strip_suffix(unit).unwrap_or(&name);
        words.iter().chain(&others).any(|word| letters(word) == name)
    };
    // A number of four bytes is the decimal one that its digits say.
    let short = value as f32;
    let value = if f64::from(short) == value { short.to_string().parse().ok()? } else { value };
    let step = if is(&RATES, ["sr", "rate"], "hz") { Some(1.0 / value) } else { None };
    step.or(is(&STEPS, ["ts", "period"], "sec").then_some(value)).filter(|step| step.is_finite() && *step > 0.0)
}

fn lengths(shape: &Value) -> Option<Vec<usize>> {
    shape.as_array()?.iter().map(|length| usize::try_from(length.as_u64()?).ok()).collect()
}

pub(super) fn product(shape: &[usize]) -> Option<usize> {
    shape.iter().try_fold(1_usize, |all, length| all.checked_mul(*length))
}

impl Arrays {
    /// Adds an array as NumPy writes it.
    ///
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
        // Of a type such as `<f8`. The bytes of an object are elsewhere.
        let letters = letters.ok_or("its rows have names: save each column as an array")?;
        let mut rest = letters.chars();
        let (is_big, kind) = (rest.next() == Some('>'), rest.next().unwrap_or('O'));
        let size = rest.as_str().parse::<usize>().unwrap_or(1).max(1);
        let count = product(&shape).and_then(|count| count.checked_mul(size));
        let data = count.and_then(|count| bytes[end..].get(..count)).ok_or("it is shorter than its header says")?;
        self.add(name, &shape, is_by_columns, Form { kind, size, is_big }.numbers(data, room));
        Ok(())
    }
}

pub(super) fn npy(bytes: &[u8]) -> Result<Table, ImportError> {
    let mut arrays = Arrays::default();
    let read = arrays.add_npy("", bytes, &mut Room::of(bytes));
    read.map_err(|reason| ImportError::OtherKind(format!("this is a NumPy file; {reason}")))?;
    arrays.table("a NumPy array")
}

pub(super) fn npz(bytes: &[u8]) -> Result<Table, ImportError> {
    let (mut arrays, mut room) = (Arrays::default(), Room::of(bytes));
    for entry in entries(bytes).unwrap_or_default() {
        let name = entry.name.strip_suffix(".npy").unwrap_or(&entry.name);
        let read = entry.unpack(&mut room).and_then(|file| arrays.add_npy(name, &file, &mut room));
        read.unwrap_or_else(|reason| arrays.leave_out(name, &reason));
    }
    arrays.table("a NumPy archive")
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub(in super::super) fn file(descr: &str, shape: &str, is_fortran: bool, data: &[u8]) -> Vec<u8> {
        let order = if is_fortran { "True" } else { "False" };
        let header = format!("{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}, }}\n");
        let length = u16::try_from(header.len()).unwrap().to_le_bytes();
        [b"\x93NUMPY\x01\0", &length[..], header.as_bytes(), data].concat()
    }

    fn columns(bytes: &[u8]) -> Vec<(String, Vec<f64>)> {
        npy(bytes).unwrap().columns.into_iter().map(|column| (column.name, column.values)).collect()
    }

    #[test]
    fn an_array_has_a_column_for_each_channel_in_either_order() {
        let data: Vec<u8> = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0].into_iter().flat_map(f64::to_be_bytes).collect();
        let by_rows = [("column 1".to_owned(), vec![0.0, 2.0, 4.0]), ("column 2".to_owned(), vec![1.0, 3.0, 5.0])];
        assert_eq!(columns(&file("'>f8'", "(3, 2)", false, &data)), by_rows);
        assert_eq!(columns(&file("'>f8'", "(2, 3)", true, &data)), by_rows, "of two rows the longer side is time");
        let by_columns = [("column 1".to_owned(), vec![0.0, 1.0, 2.0]), ("column 2".to_owned(), vec![3.0, 4.0, 5.0])];
        assert_eq!(columns(&file("'>f8'", "(3, 2)", true, &data)), by_columns);
        assert_eq!(columns(&file("'<i2'", "(2,)", false, &[1, 0, 0xFE, 0xFF]))[0].1, [1.0, -2.0]);
        assert_eq!(columns(&file("'|u1'", "(2, 1)", false, &[1, 0xFE]))[0].1, [1.0, 254.0]);
    }

    #[test]
    fn arrays_that_are_not_read_are_named() {
        let message = |descr| npy(&file(descr, "(2,)", false, &[0; 32])).unwrap_err().to_string();
        assert!(message("[('t', '<f8'), ('x', '<f8')]").contains("its rows have names"));
        assert!(message("'<U1'").contains("type U1"), "{}", message("'<U1'"));
        assert!(message("'<M8[ns]'").contains("type M1"), "{}", message("'<M8[ns]'"));
    }

    #[test]
    fn the_longest_arrays_are_the_columns_and_a_number_is_the_rate() {
        let mut arrays = Arrays::default();
        let mut add = |name: &str, values: Vec<f64>| arrays.add(name, &[values.len()], false, Ok(values));
        add("force", vec![1.0; 40]);
        add("Fs_Hz", vec![50.0]);
        add("x", (0..40).map(|k| f64::from(k % 7)).collect());
        add("event_time", vec![0.5, 0.7]);
        let table = arrays.table("a test").unwrap();
        let names: Vec<&str> = table.columns.iter().map(|column| column.name.as_str()).collect();
        assert_eq!((names, table.columns[0].values[3]), (vec!["time", "force", "x"], 0.06));
        assert_eq!(table.remarks, ["not read: `event_time` (2 rows)", "`Fs_Hz` is 50, so the rows are 0.02 s apart"]);
        assert_eq!(step_of("dt", f64::from(0.01_f32)), Some(0.01));
        assert_eq!([step_of("mass", 3.0), step_of("fs", 0.0)], [None; 2]);
    }

    #[test]
    fn arrays_that_are_none_are_said() {
        let message = |bytes: &[u8]| npy(bytes).unwrap_err().to_string();
        assert!(message(&file("'<f8'", "(3,)", false, &[0; 23])).ends_with("it is shorter than its header says"));
        assert!(message(&file("'<c16'", "(1,)", false, &[0; 16])).ends_with("not read: type c16"));
        assert!(message(&file("'<f8'", "(9999999999, 9999999999)", false, &[0; 16])).contains("shorter"));
        assert!(message(&file("'|V0'", "(9999999999,)", false, &[])).contains("shorter"));
    }
}
