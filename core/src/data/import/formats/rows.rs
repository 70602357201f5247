//! Formats with rows, of instruments and loggers: LabVIEW, Rigol, Tektronix and Campbell Scientific.

use super::Layout;
use crate::data::import::table::Rows;
use crate::data::import::unit::name_and_unit;
use crate::data::import::{Decimal, Delimiter, Dialect};
use crate::mathematics::lists::mapped;

const END: &str = "***End_of_Header***";

/// A table with commas between cells and decimal points; `data` is the first line of numbers, counted from 1.
fn rows_from(data: usize) -> Rows {
    Rows::of(Dialect { delimiter: Delimiter::Comma, decimal: Decimal::Point, data, ..Dialect::default() })
}

/// Measurement files of LabVIEW: a header of the file, one of the segment, a line of names, then rows. Not all programs that write them
/// say their separator and decimal character, or say them rightly.
///
/// Source: National Instruments (2010), Specification for the LabVIEW measurement file (.lvm).
pub(super) fn lvm(lines: &[&str]) -> Option<Layout> {
    if !lines.first()?.starts_with("LabVIEW Measurement") {
        return None;
    }
    let ends: Vec<usize> = (0..lines.len()).filter(|&place| lines[place].trim_end().starts_with(END)).take(2).collect();
    let [first, last] = *ends.as_slice() else { return None };
    // Behind the key comes the separator, which may follow the value too.
    let tag = |key: &str| {
        let mut rest = lines[..first].iter().find_map(|line| line.strip_prefix(key))?.chars();
        let (separator, value) = (rest.next()?, rest.as_str().trim());
        Some((separator, if value.len() > 1 { value.trim_end_matches(separator) } else { value }))
    };
    let of = |key: &str| tag(key).is_some_and(|(separator, word)| separator == ',' || word.starts_with("Comma"));
    let is_comma = of("Separator") || of("Writer_Version");
    let delimiter = if is_comma { Delimiter::Comma } else { Delimiter::Tab };
    let mut rows = rows_from(last + 3);
    let reads = |decimal: Decimal| {
        let cells = lines.iter().skip(last + 2).take(50).flat_map(|line| delimiter.cells(line));
        cells.filter(|cell| decimal.number(cell).is_some_and(f64::is_finite)).count()
    };
    let is_declared = tag("Decimal_Separator").is_some_and(|(_, character)| character == ",");
    let [declared, other] =
        if is_declared { [Decimal::Comma, Decimal::Point] } else { [Decimal::Point, Decimal::Comma] };
    (rows.dialect.delimiter, rows.dialect.decimal) =
        (delimiter, if reads(other) > reads(declared) { other } else { declared });
    rows.ends = |line| line.starts_with("Channels") || line.starts_with(END);
    let names: Vec<&str> = delimiter.cells(lines.get(last + 1)?).collect();
    let is_channel = |name: &str| !["X_Value", "Comment", ""].contains(&name);
    let channels = names.iter().filter(|name| is_channel(name)).count();
    let has_times = tag("X_Columns").is_none_or(|(_, columns)| columns != "No");
    // The cells of the segment's header, one a channel, or in the places of their columns.
    let segment = |key: &str, place: usize| -> Option<String> {
        let line = lines[first..last].iter().find(|line| line.starts_with(key))?;
        let cells: Vec<&str> = delimiter.cells(line).skip(1).collect();
        let filled: Vec<&str> = cells.iter().copied().filter(|cell| !cell.is_empty()).collect();
        let nth = names[..place].iter().filter(|name| is_channel(name)).count();
        let is_by_place = names.iter().filter(|name| **name == "X_Value").count() > 1 && cells.len() > channels;
        let cell = match (filled.len() == channels, is_by_place) {
            (true, _) => filled.get(nth),
            (false, true) => cells.get(place - 1),
            (false, false) => cells.get(nth),
        };
        cell.filter(|cell| !cell.is_empty()).map(|cell| (*cell).to_owned())
    };
    let number = |key: &str, place: usize| {
        let text = segment(key, place)?;
        [rows.dialect.decimal, Decimal::Point, Decimal::Comma].into_iter().find_map(|decimal| decimal.number(&text))
    };
    let places: Vec<usize> = (1..names.len()).filter(|place| is_channel(names[*place])).collect();
    let clock = |place: usize| (number("X0", place).unwrap_or(0.0), number("Delta_X", place));
    let first_clock = clock(*places.first()?);
    rows.count = places.iter().filter_map(|place| number("Samples", *place)).map(|count| count as usize).max();
    // Several columns of times are clocks of the columns behind them, unless all are the same.
    let is_one_clock = places.iter().all(|place| clock(*place) == first_clock);
    if !has_times {
        let clocks: Vec<_> = mapped(&places, &|place| clock(*place));
        let first = (0..clocks.len()).filter(|&nth| nth == 0 || clocks[nth] != clocks[nth - 1]);
        let of = |nth: usize| Some((nth, clocks[nth].0, clocks[nth].1.filter(|step| *step > 0.0)?));
        rows.even = first.map(of).collect::<Option<_>>()?;
    }
    let cell = |(place, name): (usize, &&str)| match *name {
        "X_Value" => {
            let is_kept = has_times && (place == 0 || !is_one_clock);
            is_kept.then(|| ("time".to_owned(), Some("s".to_owned())))
        }
        "Comment" | "" => None,
        name => Some((name.to_owned(), segment("Y_Unit_Label", place))),
    };
    rows.cells = names.iter().enumerate().map(cell).collect();
    Some(Layout::Rows(rows))
}

/// Traces of Rigol's oscilloscopes: the numbers of the samples, with start and increment of the time in the header.
///
/// Source: Rigol, DS1000Z and MSO5000 user's guides, "To store a waveform: CSV".
pub(super) fn rigol(lines: &[&str]) -> Option<Layout> {
    let [names, second, ..] = lines else { return None };
    let names: Vec<&str> = names.trim().split(',').map(str::trim).collect();
    let is_first = ["X", "Time(s)"].contains(names.first()?);
    // `X,CH1,Start,Increment,` with the two numbers below, or `Time(s),CH1(V),t0 = -1e-3, tInc = 1e-6,`.
    let below: Vec<&str> = second.trim().split(',').map(str::trim).collect();
    let number = |word: &str, short: &str| {
        let place = names.iter().position(|name| *name == word);
        let inline = names.iter().find_map(|name| name.strip_prefix(short)?.trim_start().strip_prefix('='));
        place.and_then(|place| below.get(place).copied()).or(inline)?.trim().parse::<f64>().ok()
    };
    let (start, step) = (number("Start", "t0")?, number("Increment", "tInc").filter(|step| *step > 0.0)?);
    let is_header = below.first().is_some_and(|cell| cell.starts_with(char::is_alphabetic));
    let mut rows = rows_from(if is_header { 3 } else { 2 });
    rows.even = vec![(0, start, step)];
    let cell = |(place, name): (usize, &&str)| {
        let unit = below.get(place).filter(|_| is_header).map(|unit| (*unit).to_owned());
        let (name, own) = name_and_unit(name);
        name.to_ascii_uppercase().starts_with("CH").then(|| (name, own.or(unit)))
    };
    rows.cells = names.iter().enumerate().map(cell).collect();
    is_first.then_some(Layout::Rows(rows))
}

/// Traces of Tektronix' oscilloscopes of the series TDS: settings in the first three cells of the first lines, then time and value.
///
/// Source: Tektronix, TDS2MEM storage memory module user manual, "Spreadsheet file formats".
pub(super) fn tektronix(lines: &[&str]) -> Option<Layout> {
    let cells = |line: &&str| line.split(',').map(|cell| cell.trim().trim_matches('"').to_owned()).collect::<Vec<_>>();
    let head: Vec<Vec<String>> = lines.iter().take(30).map(cells).collect();
    let begins = |place: usize, word: &str| head.get(place).is_some_and(|cells| cells[0] == word && cells.len() >= 5);
    if !(begins(0, "Record Length") && begins(1, "Sample Interval")) {
        return None;
    }
    let setting = |key: &str| {
        let line = head.iter().find(|cells| cells[0] == key)?;
        line.get(1).filter(|value| !value.is_empty()).cloned()
    };
    let mut rows = rows_from(1);
    let (time, value) =
        (("time".to_owned(), setting("Horizontal Units")), setting("Source").unwrap_or("CH1".to_owned()));
    rows.cells = vec![None, None, None, Some(time), Some((value, setting("Vertical Units")))];
    Some(Layout::Rows(rows))
}

/// Tables of Campbell Scientific's loggers: the station, names, units and processing in four lines.
///
/// Source: Campbell Scientific (2019), LoggerNet instruction manual, appendix B.1.4, "TOA5 ASCII file format".
pub(super) fn toa5(lines: &[&str]) -> Option<Layout> {
    let is_toa5 =
        lines.first()?.trim_start_matches('\u{FEFF}').trim_matches('"').starts_with("TOA5") && lines.len() > 4;
    let mut rows = rows_from(5);
    (rows.dialect.names, rows.dialect.units) = (2, 3);
    is_toa5.then_some(Layout::Rows(rows))
}
