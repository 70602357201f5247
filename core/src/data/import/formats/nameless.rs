//! Numbers without names: one series in lines of several numbers, or one number a line. The header may say step, unit and scale.

use super::super::Dialect;
use super::super::error::MOST_COLUMNS;
use super::super::guess::channel_code;
use super::super::header::Facts;
use super::super::table::Rows;
use super::super::unit::{Dimension, unit};
use crate::Quantity;
use crate::mathematics::lists::{mapped, numbers};

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
        rows.remarks.push("the numbers of a line are times and values in turn, and run on in the next line".to_owned());
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
            "the numbers of a line are one series that runs on in the next line: neighbours in it differ by {percent} % of what those \
             below each other do"
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

/// Whether lines have times and values in turn, as those of finite elements do: their times rise by even steps, also from line to line.
fn are_pairs(body: &[Vec<f64>]) -> bool {
    let is_even = |row: &&Vec<f64>| row.len() % 2 == usize::from(row.last().is_some_and(|last| last.is_nan()));
    let whole = body.len() > 4 && body[0].len() > 3 && body.iter().all(|row| is_even(&row));
    let times: Vec<f64> = body.iter().flat_map(|row| row.chunks_exact(2).map(|pair| pair[0])).collect();
    let step = times.get(1).map_or(0.0, |second| second - times[0]);
    whole && step > 0.0 && times.windows(2).all(|pair| (pair[1] - pair[0] - step).abs() < 0.5 * step)
}

/// The mean difference of neighbours in lines over that of neighbours in columns; `None` where this may be a table of channels.
///
/// In one series all steps are alike, that between two lines too, and every column has the same spread. Channels that move together differ
/// by more from row to row than from one to the next.
fn agreement(body: &[Vec<f64>]) -> Option<f64> {
    /// The fewest lines, and the fewest numbers in one.
    const FEWEST: [usize; 2] = [8, 3];
    /// The most that steps and spreads may differ.
    const ALIKE: f64 = 2.0;
    const CLEAR: f64 = 0.6;
    let width = body.first().map_or(0, Vec::len);
    let whole = body.iter().take_while(|row| row.len() == width).count();
    // Only the last line may be shorter.
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
