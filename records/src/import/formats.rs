//! Formats with a header that describes their numbers. They are tried before a dialect is looked for.
//!
//! A row of [`FORMATS`] recognises a file by its first lines, and lays it out: rows of a table, or series behind headers.

mod arrays;
mod kinds;
mod rows;
mod series;
mod unpack;

use super::cell::Content;
use super::header::number_after;
use super::table::{Column, Lines, Rows, TextCell, number_names};
use super::{Decimal, Dialect, ImportError, MOST, Table};

pub(super) use kinds::read_binary;
pub(super) use rows::nameless;
use unpack::NumberForm;

#[derive(Debug)]
pub(super) enum Layout {
    Rows(Rows),
    Series(Next),
}

type Find = fn(&[&str]) -> Option<Layout>;

const FORMATS: [(&str, Find); 9] = [
    ("PEER (AT2)", series::peer),
    ("strong motion (CSMIP, COSMOS)", series::strong_motion),
    ("SLIST", series::slist),
    ("universal file, data set 58", series::uff58),
    ("SAC", series::sac),
    ("LabVIEW measurement", rows::lvm),
    ("Campbell TOA5", rows::toa5),
    ("Rigol", rows::rigol),
    ("Tektronix", rows::tektronix),
];

pub(super) fn find(lines: &[&str]) -> Option<(&'static str, Layout)> {
    FORMATS.iter().find_map(|(name, find)| Some((*name, find(lines)?)))
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
    pub(super) has_times: bool,
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

    pub(super) fn line(&mut self, text: &str, line: usize) -> Result<(), ImportError> {
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
            if !(series.dt > 0.0 && series.dt.is_finite() && series.start.is_finite() || series.has_times) {
                return Ok(());
            }
            all.push((series, Vec::new()));
            (*is_reading, *loose) = (true, 0);
        } else if !all.is_empty() && numbers(text, None).is_some_and(|numbers| numbers.len() > 1) {
            *loose += 1;
        }
        Ok(())
    }

    /// `size` counts all bytes; the form 2 is that of IEEE.
    fn bytes(&mut self, bytes: &[u8], size: usize, is_big: bool, form: usize) {
        let Some((series, values)) = self.all.last_mut().filter(|_| self.is_reading) else { return };
        self.is_reading = false;
        let points = series.count.unwrap_or(0) / if series.has_times { 2 } else { 1 };
        // A time may have fewer bytes than its value.
        let sizes: &[usize] = match (series.has_times, size.checked_div(points)) {
            (false, Some(4)) => &[4],
            (false, Some(8)) => &[8],
            (true, Some(8)) => &[4, 4],
            (true, Some(12)) => &[4, 8],
            (true, Some(16)) => &[8, 8],
            _ => &[],
        };
        let width = sizes.iter().sum();
        let reason = match form {
            2 if width > 0 && size == points * width => None,
            2 => Some("has another number of bytes than its header says"),
            _ => Some("has numbers of VAX or IBM, which are not read"),
        };
        series.no_record = series.no_record.or(reason);
        if series.no_record.is_none() {
            for mut point in bytes.chunks_exact(width) {
                for &size in sizes {
                    values.push(NumberForm { kind: 'f', size, is_big }.number(&point[..size]));
                    point = &point[size..];
                }
            }
            self.lines.push(self.rows, self.rows + 1);
            self.rows = self.rows.max(values.len());
        }
    }

    pub(super) fn finish(self, lines: usize) -> Result<Table, ImportError> {
        let Self { format, dialect, all, loose, rows: read, lines: mut known, .. } = self;
        // Series that continue each other have more rows than lines.
        known.end(read);
        let mut remarks = Vec::new();
        let mut columns: Vec<Column> = Vec::new();
        let mut times: Option<Vec<f64>> = None;
        let usable = |(series, values): &&(Series, Vec<f64>)| series.no_record.is_none() && values.len() > 1;
        let Some((first, _)) = all.iter().find(usable) else {
            let reason = all.iter().find_map(|(series, _)| Some(format!("`{}` {}", series.name, series.no_record?)));
            return Err(reason.map_or(ImportError::NoNumbers(lines), |reason| ImportError::NoRecord(reason, all.len())));
        };
        let origin = all.iter().filter(usable).map(|(series, _)| series.start).fold(first.start, f64::min);
        let (dt, has_times) = (first.dt, first.has_times);
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
            // A time without its value is no row.
            let (own, values): (Vec<f64>, Vec<f64>) = if series.has_times {
                values.chunks_exact(2).map(|pair| (pair[0], pair[1])).unzip()
            } else {
                (Vec::new(), values.clone())
            };
            if series.has_times != has_times
                || (has_times && times.as_ref().is_some_and(|times| *times != own))
                || (!has_times && (series.dt - dt).abs() > 1e-9 * dt)
            {
                remarks.push(format!("`{name}` has other times than `{}`; it is left out", first.name));
                continue;
            }
            let place = if has_times { 0.0 } else { libm::round((series.start - origin) / dt) };
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
            if has_times {
                times.get_or_insert(own);
            }
        }
        if loose > 0 {
            remarks.push(format!("{loose} line(s) of numbers behind the last series are left out"));
        }
        number_names(&mut columns);
        let rows = columns.iter().map(|column| column.values.len()).max().unwrap_or(0);
        columns.iter_mut().for_each(|column| column.values.resize(rows, f64::NAN));
        let apart = if has_times { " with their times".to_owned() } else { format!(", {dt} s apart") };
        let form = format!("{format}: {} series of {rows} numbers{apart}", columns.len());
        let even = || (0..rows).map(|k| k as f64 * dt).collect();
        columns.insert(0, Column::of_header("time", Some("s"), times.unwrap_or_else(even)));
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_numbers_of_headers_are_found() {
        assert_eq!(number_after("NPTS=  7807, DT=   .0050 SEC,", "dt="), Some(0.005));
        assert_eq!(number_after("at 0.010 sec.", "at"), Some(0.01));
        assert_eq!(number_after("DT", "dt"), None);
        assert_eq!(text_after("units=cm/sec2(04),Format=(1E15.6)", "units=", &['(', ',']), Some("cm/sec2"));
        assert_eq!([field_width("in cm/sec2. (8f10.5)"), field_width("Format=(1E15.6)")], [Some(10), Some(15)]);
        assert_eq!([field_width("(10I8)"), field_width("(x)"), field_width("f10")], [Some(8), None, None]);
    }

    #[test]
    fn usual_tables_have_no_format() {
        for text in
            ["t,x\n0,1\n1,2\n", "X,CH1\n0,1\n", "Record Length\n1\n", "NPTS and DT of this file:\n1 2\n", "-1\n2\n3\n"]
        {
            let lines: Vec<&str> = text.lines().collect();
            assert!(find(&lines).is_none(), "{text}");
        }
    }

    #[test]
    fn numbers_abut_only_where_their_width_is_known() {
        assert_eq!(numbers(" 1.5  -2.5E+1 3D2", None), Some(vec![1.5, -25.0, 300.0]));
        assert_eq!(numbers("12345.67812345.679", Some(9)), Some(vec![12345.678, 12345.679]));
        assert_eq!(numbers("  1.5-2.5", Some(5)), Some(vec![1.5, -2.5]));
        assert_eq!(numbers("1.5 2.5 3.5", Some(10)), Some(vec![1.5, 2.5, 3.5]), "narrower than told");
        assert_eq!(
            [numbers("1.5 oops", None), numbers("", None), numbers("End of data", Some(10))],
            [const { None }; 3]
        );
        assert!(numbers("  ********", Some(10)).unwrap()[0].is_nan());
    }
}
