//! Rows of instruments and loggers (LabVIEW, Rigol, Tektronix, Campbell Scientific), and numbers without names.

use kalmanscope_filters::Quantity;
use kalmanscope_filters::lists::{mapped, numbers};

use crate::import::guess::channel_code;
use crate::import::header::{Dimension, Facts, name_and_unit, unit};
use crate::import::table::Rows;
use crate::import::{Decimal, Delimiter, Dialect, MOST_COLUMNS};

const END: &str = "***End_of_Header***";

fn rows_from(data: usize) -> Rows {
    Rows::of(Dialect { delimiter: Delimiter::Comma, decimal: Decimal::Point, data, ..Dialect::default() })
}

/// Keys may be missing or wrong. Source: National Instruments (2010), Specification for the LabVIEW measurement file (.lvm).
pub(super) fn lvm(lines: &[&str]) -> Option<Rows> {
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
    Some(rows)
}

/// Source: Rigol, DS1000Z and MSO5000 user's guides, "To store a waveform: CSV".
pub(super) fn rigol(lines: &[&str]) -> Option<Rows> {
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
    is_first.then_some(rows)
}

/// Of the series TDS. Source: Tektronix, TDS2MEM storage memory module user manual, "Spreadsheet file formats".
pub(super) fn tektronix(lines: &[&str]) -> Option<Rows> {
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
    Some(rows)
}

/// Source: Campbell Scientific (2019), LoggerNet instruction manual, appendix B.1.4, "TOA5 ASCII file format".
pub(super) fn toa5(lines: &[&str]) -> Option<Rows> {
    let is_toa5 =
        lines.first()?.trim_start_matches('\u{FEFF}').trim_matches('"').starts_with("TOA5") && lines.len() > 4;
    let mut rows = rows_from(5);
    (rows.dialect.names, rows.dialect.units) = (2, 3);
    is_toa5.then_some(rows)
}

pub(in super::super) fn nameless(dialect: Dialect, lines: &[&str]) -> Rows {
    let mut rows = Rows::of(dialect);
    let (header, body) = lines.split_at(dialect.data.saturating_sub(1).min(lines.len()));
    let cells = |line: &&str| -> Vec<f64> {
        dialect.delimiter.cells(line).map(|cell| dialect.decimal.number(cell).unwrap_or(f64::NAN)).collect()
    };
    let rows_of = body.iter().filter(|line| !line.trim().is_empty()).take_while(|line| !is_title_of_next(line));
    let body: Vec<Vec<f64>> = rows_of.take(1000).map(cells).collect();
    let name = dialect.names.checked_sub(1).and_then(|place| header.get(place)).map(|line| line.trim());
    // A line of words with a number among them, or a key and its value, names no columns.
    let is_title = |line: &str| {
        line.contains([':', '='])
            || dialect.delimiter.cells(line).any(|cell| dialect.decimal.number(cell).is_some_and(f64::is_finite))
    };
    let name = name.filter(|line| !line.is_empty() && !is_title(line));
    let width = body.first().map_or(0, Vec::len);
    let facts = Facts::of(header);
    if name.is_none() && are_pairs(&body) {
        rows.remarks.push("the numbers of a line are times and values in turn, across lines".to_owned());
        rows.cells =
            [("time", Some("s")), ("value", None)].map(|(a, b)| Some((a.to_owned(), b.map(str::to_owned)))).into();
        (rows.run_on, rows.ends, rows.dialect.names) = (Some((2, 0)), is_title_of_next, 0);
        return rows;
    }
    // Lines may be numbered, or begin with the number of their first value.
    let counts = |row: usize, by: usize| body[row][0] - body[row - 1][0] == by as f64;
    let is_numbered =
        body.len() > 1 && width > 2 && [1, width - 1].iter().any(|by| (1..body.len()).all(|row| counts(row, *by)));
    let apart = usize::from(is_numbered);
    let values: Vec<Vec<f64>> = mapped(&body, &|row| row[apart.min(row.len())..].to_vec());
    let is_line = body.len() == 1 && width > MOST_COLUMNS;
    let agreement = if name.is_none() { agreement(&values).or(is_line.then_some(0.0)) } else { None };
    rows.rate = facts.step.map(|step| 1.0 / step);
    if agreement.is_none() && !(width == 1 && (facts.step.is_some() || (name.is_none() && dialect.names > 0))) {
        return rows;
    }
    let kind = match facts.unit.as_deref().and_then(unit) {
        Some((Dimension::Acceleration, _)) => Some("acceleration"),
        Some((Dimension::Velocity, _)) => Some("velocity"),
        Some((Dimension::Length, _)) => Some("displacement"),
        _ => ["acceleration", "velocity", "displacement"]
            .into_iter()
            .find(|kind| header.iter().any(|line| line.to_lowercase().contains(&kind[..5]))),
    };
    // Seismic Handler writes the letters of a channel's code apart.
    let letter = |key: &str| header.iter().find_map(|line| line.strip_prefix(key)).map(str::trim);
    let apart_code: String = ["CHAN1:", "CHAN2:", "COMP:"].into_iter().filter_map(letter).collect();
    let codes = || header.iter().flat_map(|line| line.split_whitespace()).chain([apart_code.as_str()]);
    let kind = kind.or_else(|| codes().find_map(channel_code).map(Quantity::key));
    let said = [
        facts.step.map(|step| format!("a step of {step} s")),
        facts.unit.as_ref().map(|unit| format!("the unit {unit}")),
        facts.scale.map(|scale| format!("a scale of {scale}")),
    ];
    let said: Vec<String> = said.into_iter().flatten().collect();
    if let Some(share) = agreement {
        let percent = libm::round(100.0 * share);
        rows.remarks.push(format!(
            "the numbers of a line are one series that continues in the next line: neighbours differ by {percent} % of \
             the step between lines"
        ));
        rows.ends = is_title_of_next;
    }
    if !said.is_empty() {
        rows.remarks.push(format!("the header says {}: so it is read", said.join(", ")));
    }
    if name.is_none() {
        rows.cells = vec![Some((kind.unwrap_or("column 1").to_owned(), facts.unit))];
        rows.dialect.names = 0;
    }
    rows.run_on = agreement.map(|_| (1, apart));
    (rows.even, rows.scale) = (facts.step.map(|step| (0, 0.0, step)).into_iter().collect(), facts.scale.unwrap_or(1.0));
    rows
}

fn is_title_of_next(line: &str) -> bool {
    line.trim_start().trim_start_matches('*').starts_with(char::is_alphabetic)
}

fn are_pairs(body: &[Vec<f64>]) -> bool {
    let is_even = |row: &&Vec<f64>| row.len() % 2 == usize::from(row.last().is_some_and(|last| last.is_nan()));
    let whole = body.len() > 4 && body[0].len() > 3 && body.iter().all(|row| is_even(&row));
    let times: Vec<f64> = body.iter().flat_map(|row| row.chunks_exact(2).map(|pair| pair[0])).collect();
    let step = times.get(1).map_or(0.0, |second| second - times[0]);
    whole && step > 0.0 && times.windows(2).all(|pair| (pair[1] - pair[0] - step).abs() < 0.5 * step)
}

/// `None` for a table of channels: these differ more from row to row, while in a series all steps and spreads are alike.
fn agreement(body: &[Vec<f64>]) -> Option<f64> {
    const FEWEST: [usize; 2] = [8, 3];
    const ALIKE: f64 = 2.0;
    const CLEAR: f64 = 0.6;
    let width = body.first().map_or(0, Vec::len);
    let whole = body.iter().take_while(|row| row.len() == width).count();
    if width < FEWEST[1] || whole < FEWEST[0] || whole + 1 < body.len() {
        return None;
    }
    let body = &body[..whole];
    let mean = |of: &dyn Fn(usize) -> f64| (0..whole - 1).map(of).sum::<f64>() / (whole - 1) as f64;
    let next = |row: usize, place: usize| if place + 1 < width { body[row][place + 1] } else { body[row + 1][0] };
    let steps = |place: usize| mean(&|row| (next(row, place) - body[row][place]).abs());
    let below = |place: usize| mean(&|row| (body[row + 1][place] - body[row][place]).abs());
    let spread = |place: usize| {
        let middle = mean(&|row| body[row][place]);
        mean(&|row| (body[row][place] - middle).abs())
    };
    let of_all = |of: &dyn Fn(usize) -> f64| numbers(width, &of);
    let are_alike = |all: &[f64]| {
        let [least, most] = all.iter().fold([f64::INFINITY, 0.0], |[a, b], x| [f64::min(a, *x), f64::max(b, *x)]);
        most <= ALIKE * least && most > 0.0
    };
    let (steps, below, spreads) = (of_all(&steps), of_all(&below), of_all(&spread));
    let share = steps.iter().sum::<f64>() / below.iter().sum::<f64>();
    (share < CLEAR && are_alike(&steps) && are_alike(&spreads)).then_some(share)
}
