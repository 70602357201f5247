//! Formats with a header that describes their numbers: rows of a table, or series. They are tried before a dialect is looked for.

mod arrays;
mod kinds;
mod rows;
mod series;
mod unpack;

use super::cell::Content;
use super::header::number_after;
use super::table::{Column, Lines, Rows, TextCell, number_names};
use super::{Decimal, Dialect, ImportError, MOST, Result, Table};

pub(super) use kinds::read_binary;
pub(super) use rows::nameless;

#[derive(Debug)]
pub(super) enum Layout {
    Rows(Rows),
    Series(Next),
}

const SERIES: [(&str, fn(&[&str]) -> bool, Next); 5] = [
    ("PEER (AT2)", |lines| lines.iter().take(6).any(|line| series::size(line).is_some()), series::peer),
    ("strong motion (CSMIP, COSMOS)", series::is_strong_motion, series::strong_motion),
    ("SLIST", |lines| lines[0].starts_with("TIMESERIES ") && lines[0].contains(", SLIST,"), series::slist),
    ("universal file, data set 58", series::is_uff58, series::uff58),
    ("SAC", series::is_sac, series::sac),
];

const ROWS: [(&str, fn(&[&str]) -> Option<Rows>); 4] = [
    ("LabVIEW measurement", rows::lvm),
    ("Campbell TOA5", rows::toa5),
    ("Rigol", rows::rigol),
    ("Tektronix", rows::tektronix),
];

pub(super) fn find(lines: &[&str]) -> Option<(&'static str, Layout)> {
    let series = SERIES.iter().find(|(_, is, _)| !lines.is_empty() && is(lines));
    let rows = || ROWS.iter().find_map(|(name, rows)| Some((*name, Layout::Rows(rows(lines)?))));
    series.map(|(name, _, next)| (*name, Layout::Series(*next))).or_else(rows)
}

fn text_after<'a>(line: &'a str, word: &str, ends: &[char]) -> Option<&'a str> {
    let place = line.to_ascii_lowercase().find(&word.to_ascii_lowercase())? + word.len();
    let text = line.get(place..)?.split(ends).next()?.trim();
    (!text.is_empty()).then_some(text)
}

fn field_width(line: &str) -> Option<usize> {
    let inner = line.rsplit_once('(')?.1.trim_start_matches(|c: char| c.is_ascii_digit());
    let width = inner.strip_prefix(|c: char| "fFeEgGiI".contains(c))?;
    let end = width.find(|c: char| !c.is_ascii_digit()).unwrap_or(width.len());
    width[..end].parse().ok().filter(|width| (1..=80).contains(width))
}

/// From all lines so far that are no numbers. The last line may end the header.
pub(super) type Next = fn(&[String]) -> Option<Series>;

#[derive(Clone, Debug, Default)]
pub(super) struct Series {
    pub(super) name: String,
    pub(super) unit: Option<String>,
    /// \[s\]
    pub(super) start: f64,
    pub(super) dt: f64,
    pub(super) count: Option<usize>,
    pub(super) width: Option<usize>,
    pub(super) no_record: Option<&'static str>,
}

const MOST_LINES: usize = 1000;

#[derive(Debug)]
pub(super) struct SeriesReader {
    format: &'static str,
    dialect: Dialect,
    next: Next,
    header: Vec<String>,
    all: Vec<(Series, Vec<f64>)>,
    is_reading: bool,
    rows: usize,
    lines: Lines,
    loose: usize,
}

impl SeriesReader {
    pub(super) fn new(format: &'static str, dialect: Dialect, next: Next) -> Self {
        let (header, all, lines) = Default::default();
        Self { format, dialect, next, header, all, is_reading: false, rows: 0, lines, loose: 0 }
    }

    pub(super) fn line(&mut self, text: &str, line: usize) -> Result<()> {
        let Self { next, header, all, is_reading, rows, lines, loose, .. } = self;
        if text.trim().is_empty() && *is_reading {
            return Ok(());
        }
        if let Some((series, values)) = all.last_mut().filter(|_| *is_reading) {
            if let Some(numbers) = numbers(text, series.width) {
                let before = values.len();
                values.extend(numbers);
                values.truncate(series.count.unwrap_or(usize::MAX));
                for row in before.max(*rows)..values.len() {
                    lines.push(row, line);
                    *rows = row + 1;
                }
                *is_reading = series.count.is_none_or(|count| values.len() < count);
                if values.len() > 2 * MOST {
                    return Err(ImportError::TooLong(values.len()));
                }
                return Ok(());
            }
            // A number that cannot be read is no end of a series.
            if text.trim_start().starts_with(|c: char| c.is_ascii_digit() || c == '.')
                && series.count.is_some_and(|count| values.len() < count)
                && !text.contains(char::is_alphabetic)
            {
                let text = text.trim().chars().take(40).collect();
                return Err(TextCell { line, text }.error(&series.name));
            }
            *is_reading = false;
        }
        if header.len() >= MOST_LINES {
            header.drain(..MOST_LINES / 2);
        }
        header.push(text.trim_end().to_owned());
        if let Some(series) = next(header) {
            let has_clock = series.dt > 0.0 && series.dt.is_finite() && series.start.is_finite();
            if !has_clock && series.no_record.is_none() {
                return Ok(());
            }
            all.push((series, Vec::new()));
            (*is_reading, *loose) = (true, 0);
        } else if !all.is_empty() && numbers(text, None).is_some_and(|numbers| numbers.len() > 1) {
            *loose += 1;
        }
        Ok(())
    }

    pub(super) fn finish(self, lines: usize) -> Result<Table> {
        let Self { format, dialect, all, loose, rows: read, lines: mut known, .. } = self;
        // Series that continue each other have more rows than lines.
        known.end(read);
        let mut remarks = Vec::new();
        let mut columns: Vec<Column> = Vec::new();
        let usable = |(series, values): &&(Series, Vec<f64>)| series.no_record.is_none() && values.len() > 1;
        let Some((first, _)) = all.iter().find(usable) else {
            let reason = all.iter().find_map(|(series, _)| Some(format!("`{}` {}", series.name, series.no_record?)));
            return Err(reason.map_or(ImportError::NoNumbers(lines), |reason| ImportError::NoRecord(reason, all.len())));
        };
        let origin = all.iter().filter(usable).map(|(series, _)| series.start).fold(first.start, f64::min);
        let dt = first.dt;
        for (series, values) in &all {
            let name = &series.name;
            if let Some(reason) = series.no_record {
                remarks.push(format!("`{name}` {reason}; it is left out"));
                continue;
            }
            if let Some(count) = series.count.filter(|count| *count != values.len()) {
                remarks.push(format!("`{name}` has {} numbers, but its header says {count}", values.len()));
            }
            let missing = values.iter().filter(|value| value.is_nan()).count();
            if missing > 0 {
                remarks.push(format!("`{name}` has no reading in {missing} place(s)"));
            }
            if (series.dt - dt).abs() > 1e-9 * dt {
                remarks.push(format!("`{name}` has other times than `{}`; it is left out", first.name));
                continue;
            }
            let place = libm::round((series.start - origin) / dt);
            if place + values.len() as f64 > MOST as f64 {
                return Err(ImportError::TooLong((place.min(1e15) as usize).saturating_add(values.len())));
            }
            let place = place as usize;
            // A later series of the same name continues the column.
            let same = columns.iter().position(|column| column.name == *name && column.values.len() <= place);
            let column = same.unwrap_or_else(|| {
                columns.push(Column { name: name.clone(), unit: series.unit.clone(), ..Column::default() });
                columns.len() - 1
            });
            columns[column].values.resize(place, f64::NAN);
            columns[column].values.extend(values);
        }
        if loose > 0 {
            remarks.push(format!("{loose} line(s) of numbers behind the last series are left out"));
        }
        number_names(&mut columns);
        let rows = columns.iter().map(|column| column.values.len()).max().unwrap_or(0);
        columns.iter_mut().for_each(|column| column.values.resize(rows, f64::NAN));
        let form = format!("{format}: {} series of {rows} numbers, {dt} s apart", columns.len());
        let times = (0..rows).map(|k| k as f64 * dt).collect();
        columns.insert(0, Column::of_header("time", Some("s"), times));
        Ok(Table { dialect, form, columns, remarks, rate: None, lines: known })
    }
}

/// `None` if the line has other text. Numbers of a known width may abut.
pub(super) fn numbers(line: &str, width: Option<usize>) -> Option<Vec<f64>> {
    let number = |text: &str| match Decimal::Point.read(text.trim(), false) {
        Content::Number(value) => Some(value),
        Content::Missing | Content::Word => Some(f64::NAN),
        _ => None,
    };
    let line = line.trim_end();
    let apart: Vec<&str> = line.split_whitespace().collect();
    let fields = width.map_or(0, |width| line.len().div_ceil(width));
    if apart.len() >= fields && !apart.is_empty() {
        return apart.into_iter().map(number).collect();
    }
    let width = width.filter(|_| line.is_ascii() && !line.is_empty())?;
    (0..fields).map(|k| number(line.get(k * width..((k + 1) * width).min(line.len()))?)).collect()
}
