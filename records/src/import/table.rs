//! Columns of numbers, as a file has them, and the reading of their rows.

use std::collections::BTreeMap;

use kalmanscope_filters::lists::{mapped, numbers};
use serde::{Deserialize, Serialize};

use super::cell::Content;
use super::dialect::REMARKS;
use super::header::{Facts, name_and_unit};
use super::{Decimal, Dialect, ImportError, MOST_COLUMNS, Result};

/// The columns of a file. A document of it has all but the numbers, which are too many for a text.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Table {
    /// The file's form.
    pub dialect: Dialect,
    /// The file's form in one line: the format, if its header says what its numbers are, and the dialect.
    pub form: String,
    /// The columns, all of the same length.
    pub columns: Vec<Column>,
    /// Sentences about rows that were not as expected.
    pub remarks: Vec<String>,
    /// The samples a second that the file says \[Hz\].
    pub rate: Option<f64>,
    pub(super) lines: Lines,
}

/// A column of a file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Column {
    /// The name in the header, or `column 1` and so on.
    pub name: String,
    /// The unit in the header.
    pub unit: Option<String>,
    /// The numbers, in the file's unit; NaN where a cell is empty or has other text.
    #[serde(skip)]
    pub values: Vec<f64>,
    /// The first cell with text that is not a number.
    pub text: Option<TextCell>,
    /// The first cell with a word that says that its reading failed, such as `OVLD`. It counts as missing.
    pub word: Option<TextCell>,
    /// The number of cells with such a word.
    pub words: usize,
    /// Whether a cell is a time of day without a date.
    pub is_time_of_day: bool,
    /// Whether a cell is a date with a time of day.
    pub is_dated: bool,
}

/// A cell with text that is not a number.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TextCell {
    /// Line of the file, counted from 1.
    pub line: usize,
    /// The text.
    pub text: String,
}

impl TextCell {
    pub(super) fn error(&self, column: &str) -> ImportError {
        let Self { line, text } = self;
        ImportError::Cell(*line, column.to_owned(), format!("`{text}` is not a number"))
    }
}

impl Column {
    /// A column of numbers, with the name and unit of its header; `unit` is the one that the file gives separately.
    pub fn of_header(header: &str, unit: Option<&str>, values: Vec<f64>) -> Self {
        let (name, own) = name_and_unit(header);
        Self { name, unit: unit.map(str::to_owned).or(own), values, ..Self::default() }
    }

    pub(super) fn without_text(&self) -> Result<&Self> {
        self.text.as_ref().map_or(Ok(self), |text| Err(text.error(&self.name)))
    }

    /// Returns whether the number has thousands separators.
    fn push(&mut self, cell: &str, dialect: Dialect, line: usize) -> bool {
        let found = dialect.decimal.read(cell, dialect.thousands);
        let quoted = || TextCell { line, text: cell.chars().take(40).collect() };
        match found {
            Content::Number(_) | Content::Grouped(_) | Content::Missing => {}
            Content::Clock(_, is_dated) => {
                self.is_time_of_day |= !is_dated;
                self.is_dated |= is_dated;
            }
            Content::Word => {
                self.word.get_or_insert_with(quoted);
                self.words += 1;
            }
            Content::Text => {
                self.text.get_or_insert_with(quoted);
            }
        }
        self.values.push(found.value());
        matches!(found, Content::Grouped(_))
    }
}

impl Table {
    /// A table of columns of the same length that are no text; `form` says what file they come from.
    pub fn of_columns(form: &str, columns: Vec<Column>, remarks: Vec<String>) -> Self {
        let mut lines = Lines::default();
        lines.push(0, 1);
        Self { dialect: Dialect::default(), form: form.to_owned(), columns, remarks, rate: None, lines }
    }

    /// The number of rows.
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |column| column.values.len())
    }

    /// The line of a row in the file, counted from 1.
    pub fn line(&self, row: usize) -> usize {
        self.lines.of(row)
    }

    /// The place of a column, by its name as it is, or without regard to case.
    pub fn place(&self, name: &str) -> Option<usize> {
        let exact = self.columns.iter().position(|column| column.name == name);
        exact.or_else(|| self.columns.iter().position(|column| column.name.eq_ignore_ascii_case(name)))
    }

    /// The numbers as CSV, with the units in the header; cells without a number are empty.
    pub fn csv(&self) -> String {
        let name = |column: &Column| {
            let name = match column.unit.as_deref() {
                Some(unit) if !unit.is_empty() => format!("{} [{unit}]", column.name),
                _ => column.name.clone(),
            };
            if name.contains([',', '"']) { format!("\"{}\"", name.replace('"', "\"\"")) } else { name }
        };
        let mut text = mapped(&self.columns, &name).join(",") + "\n";
        for row in 0..self.rows() {
            let cell = |column: &Column| Some(column.values[row]).filter(|value| value.is_finite());
            let cells = mapped(&self.columns, &|column| cell(column).map_or(String::new(), |value| value.to_string()));
            text += &(cells.join(",") + "\n");
        }
        text
    }

    /// The last reading of each column counts.
    pub(super) fn of_rows(&self, groups: impl Iterator<Item = Vec<usize>>) -> Self {
        let (groups, mut lines): (Vec<Vec<usize>>, _) = (groups.collect(), Lines::default());
        groups.iter().enumerate().for_each(|(row, group)| lines.push(row, self.line(group[0])));
        let column = |column: &Column| {
            let last = |group: &Vec<usize>| group.iter().rev().map(|&row| column.values[row]).find(|x| !x.is_nan());
            let values = mapped(&groups, &|group| last(group).unwrap_or(f64::NAN));
            Column { values, ..column.clone() }
        };
        Self { columns: mapped(&self.columns, &column), lines, ..self.clone() }
    }

    /// Whether every cell of a column is empty or text.
    pub fn is_without_numbers(&self, place: usize) -> bool {
        self.columns[place].values.iter().all(|value| value.is_nan())
    }
}

pub(super) fn free_name(name: &str, is_taken: impl Fn(&str) -> bool) -> String {
    let numbered = (2..).map(|number| format!("{name} ({number})"));
    std::iter::once(name.to_owned()).chain(numbered).find(|name| !is_taken(name)).unwrap_or_default()
}

pub(super) fn number_names(columns: &mut [Column]) {
    for place in 1..columns.len() {
        let (before, rest) = columns.split_at_mut(place);
        rest[0].name = free_name(&rest[0].name, |name| before.iter().any(|column| column.name == name));
    }
}

#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Lines {
    blocks: Vec<(usize, usize)>,
    last: Option<usize>,
}

impl Lines {
    pub(super) fn push(&mut self, row: usize, line: usize) {
        if self.blocks.last().is_none_or(|&(first, start)| start + (row - first) != line) {
            self.blocks.push((row, line));
        }
    }

    pub(super) fn end(&mut self, rows: usize) {
        self.last = rows.checked_sub(1).map(|row| self.of(row));
    }

    fn of(&self, row: usize) -> usize {
        let block = self.blocks.partition_point(|&(first, _)| first <= row).checked_sub(1);
        let line = block.map_or(0, |block| self.blocks[block].1 + (row - self.blocks[block].0));
        self.last.map_or(line, |last| line.min(last))
    }
}

#[derive(Debug)]
pub(super) struct Rows {
    pub(super) dialect: Dialect,
    /// `None` if the cell belongs to no column; empty if lines of the dialect have the names.
    pub(super) cells: Vec<Option<(String, Option<String>)>>,
    /// The place of the first column, its first time and the step \[s\].
    pub(super) even: Vec<(usize, f64, f64)>,
    pub(super) ends: fn(&str) -> bool,
    /// The number of columns, and of the first cells of a row that do not belong to them.
    pub(super) run_on: Option<(usize, usize)>,
    pub(super) rate: Option<f64>,
    pub(super) scale: f64,
    pub(super) count: Option<usize>,
    pub(super) remarks: Vec<String>,
}

impl Rows {
    pub(super) fn of(dialect: Dialect) -> Self {
        let (cells, even, run_on, rate, count, remarks) = Default::default();
        Self { dialect, cells, even, ends: |_| false, run_on, rate, scale: 1.0, count, remarks }
    }
}

#[derive(Debug)]
pub(super) struct RowsReader {
    format: Option<&'static str>,
    rows: Rows,
    pub(super) columns: Vec<Column>,
    belongs: Vec<bool>,
    pub(super) end: Option<usize>,
    lines: Lines,
    odd: Odd,
}

/// The first line of a kind, and the number of them.
type Odd = BTreeMap<&'static str, (usize, usize)>;

const SHORT: &str = "fewer cells than the others; what is missing counts as empty";
const WORDS: &str = "words in place of numbers: no row";
const LONG: &str = "more cells than the others; those at the end are left out";
const GROUPED: &str = "thousands apart";
const DOUBTFUL: &str = "a point where commas are decimal";

fn note(odd: &mut Odd, what: &'static str, line: usize) {
    odd.entry(what).or_insert((line, 0)).1 += 1;
}

fn remark(odd: &Odd, what: &str) -> Option<String> {
    Some(match odd.get(what)? {
        (first, 1) => format!("line {first} has {what}"),
        (first, count) => format!("{count} lines have {what}, the first is line {first}"),
    })
}

/// Limits from below the rows above a line that may be their summary.
const SUMMED: usize = 20;

impl RowsReader {
    pub(super) fn new(format: Option<&'static str>, mut rows: Rows, lines: &[&str], length: usize) -> Result<Self> {
        let (dialect, cells) = (rows.dialect, std::mem::take(&mut rows.cells));
        let (belongs, header) = if cells.is_empty() {
            let width = width(&dialect, lines)?;
            (vec![true; width], dialect.header(lines, width))
        } else {
            (mapped(&cells, &Option::is_some), cells.into_iter().flatten().collect())
        };
        // The first lines give the number of rows for which columns reserve memory.
        let whole: usize = lines.iter().map(|line| line.len() + 1).sum();
        let mean = (whole.max(1) / lines.len().max(1)).max(1);
        let count = (length / mean).min(length / belongs.len().max(1) + 1);
        let column =
            |(name, unit)| Column { name, unit, values: Vec::with_capacity(count + count / 50), ..Column::default() };
        let mut columns: Vec<Column> = header.into_iter().map(column).collect();
        number_names(&mut columns);
        let (lines, odd) = Default::default();
        Ok(Self { format, rows, columns, belongs, end: None, lines, odd })
    }

    pub(super) fn line(&mut self, row: &str, line: usize) {
        let Self { rows: Rows { dialect, ends, run_on, rate, .. }, columns, belongs, end, lines, odd, .. } = self;
        let trimmed = row.trim();
        if trimmed.is_empty() || trimmed.starts_with(REMARKS) {
            return;
        }
        if ends(row) {
            *end = Some(line);
            return;
        }
        if let Some((count, apart)) = *run_on {
            let cells = dialect.delimiter.cells(trimmed.trim_end_matches([',', ';']));
            for (place, cell) in cells.skip(apart).enumerate() {
                columns[place % count].push(cell, *dialect, line);
                lines.push(columns[0].values.len() - 1, line);
            }
            return;
        }
        let is_word = |cell: &str| cell.is_empty() || dialect.decimal.read(cell, dialect.thousands) == Content::Text;
        // Behind numbers a summary has words in their place.
        let is_sum = columns.first().is_some_and(|first| first.text.is_none() && first.values.len() > SUMMED)
            && belongs.first() == Some(&true)
            && dialect.delimiter.cells(row).next().is_some_and(|cell| !cell.is_empty() && is_word(cell));
        if columns.len() > 1
            && trimmed.trim_start_matches('*').trim_start().starts_with(char::is_alphabetic)
            && (is_sum || dialect.delimiter.cells(row).all(is_word))
        {
            // Printers write the rate at the end: `Rate 1344, overflows 0`.
            *rate = rate.or_else(|| Facts::of(&[trimmed]).step.map(|step| 1.0 / step));
            // Their axes are in g.
            if trimmed.contains("overflows") {
                let axes = columns.iter_mut().filter(|column| ["X", "Y", "Z"].contains(&column.name.as_str()));
                axes.for_each(|axis| axis.unit = axis.unit.take().or(Some("g".to_owned())));
            }
            note(odd, WORDS, line);
            return;
        }
        let (mut missing, mut cells) = (false, dialect.delimiter.cells(row));
        let mut kept = columns.iter_mut();
        for &belongs in belongs.iter() {
            let cell = cells.next();
            if belongs && let Some(column) = kept.next() {
                missing |= cell.is_none();
                let cell = cell.unwrap_or_default();
                if column.push(cell, *dialect, line) {
                    note(odd, GROUPED, line);
                } else if dialect.decimal == Decimal::Comma && cell.contains('.') {
                    note(odd, DOUBTFUL, line);
                }
            }
        }
        if missing {
            note(odd, SHORT, line);
        }
        if cells.any(|cell| !cell.is_empty()) {
            note(odd, LONG, line);
        }
        if let Some(column) = columns.first() {
            lines.push(column.values.len() - 1, line);
        }
    }

    pub(super) fn finish(self, line: usize) -> Result<Table> {
        let Self { format, rows, mut columns, end, lines, odd, .. } = self;
        let Rows { dialect, even, scale, count, remarks: mut said, rate, .. } = rows;
        let form = format.map_or_else(|| dialect.to_string(), |name| format!("{name}: {dialect}"));
        if columns.iter().all(|column| column.values.iter().all(|value| value.is_nan())) {
            return Err(ImportError::NoNumbers(line));
        }
        columns.iter_mut().for_each(|column| column.values.shrink_to_fit());
        let both = odd.get(GROUPED).zip(odd.get(DOUBTFUL)).filter(|_| !dialect.thousands);
        let late = both.map(|((grouped, _), (doubtful, _))| {
            format!(
                "line {grouped} has thousands apart, but the point in line {doubtful} counts as a decimal one, because the first \
                 lines have no thousands: state `thousands = true` in the dialect"
            )
        });
        let remarks = [
            remark(&odd, SHORT),
            remark(&odd, WORDS),
            remark(&odd, LONG),
            end.map(|line| format!("line {line} begins another table; it is left out, with all below it")),
            late,
        ];
        if scale != 1.0 {
            columns.iter_mut().flat_map(|column| &mut column.values).for_each(|value| *value *= scale);
        }
        said.extend(count.and_then(|count| cut(&mut columns, count, !even.is_empty())));
        said.extend(remarks.into_iter().flatten());
        let rows = columns.first().map_or(0, |column| column.values.len());
        columns.iter_mut().for_each(|column| column.values.resize(rows, f64::NAN));
        for (nth, (place, start, step)) in even.into_iter().enumerate() {
            let name = if nth == 0 { "time".to_owned() } else { format!("time ({})", nth + 1) };
            let times = numbers(rows, &|k| start + k as f64 * step);
            columns.insert(place + nth, Column::of_header(&name, Some("s"), times));
        }
        Ok(Table { dialect, form, columns, remarks: said, rate, lines })
    }
}

fn cut(columns: &mut [Column], count: usize, is_without_times: bool) -> Option<String> {
    let rows = columns.first()?.values.len();
    let begins_again = || count > 0 && rows > count && columns[0].values[count] <= columns[0].values[count - 1];
    if rows == count || count == 0 {
        return None;
    }
    if rows < count || !(is_without_times || begins_again()) {
        return Some(format!("the header says {count} rows, but there are {rows}; all are read"));
    }
    columns.iter_mut().for_each(|column| column.values.truncate(count));
    let (parts, rest) = (rows / count, rows % count);
    let rest = if rest > 0 { format!(" and {rest} more rows") } else { String::new() };
    Some(format!(
        "the header says {count} rows, but there are {rows}: {parts} part(s) of {count}{rest}; the first part is read; for another \
         one, delete the rows before it"
    ))
}

fn width(dialect: &Dialect, lines: &[&str]) -> Result<usize> {
    let first = lines.get(dialect.data.saturating_sub(1)).copied().unwrap_or_default();
    let mut width = dialect.delimiter.cells(first).count();
    // A delimiter that ends each line begins no column.
    let ends = |line: &&&str| dialect.delimiter.cells(line).nth(width - 1).is_none_or(str::is_empty);
    let is_named = || dialect.header(lines, width)[width - 1].0 != format!("column {width}");
    let data = lines.iter().skip(dialect.data.saturating_sub(1)).filter(|line| !line.trim().is_empty());
    if width > 1 && data.take(100).all(|line| ends(&line)) && !is_named() {
        width -= 1;
    }
    if width > MOST_COLUMNS {
        return Err(ImportError::TooManyColumns(dialect.data, width));
    }
    Ok(width)
}
