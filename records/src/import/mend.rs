//! Faults of times with one cure: counters that turn over, double or unsorted rows, first rows far off, clocks set back, parts that repeat.

use std::cmp::Ordering;

use kalmanscope_filters::lists::{mapped, median, places, sorted_places};

use super::guess::{clocks, is_named_time, seldom_falls};
use super::header::{Dimension, unit};
use super::times::{DAY, EPOCHS, median_step};
use super::{Column, Table};

/// Limits from below the distance of first rows from the others, over the time of these.
const APART: f64 = 1e3;

/// Limits how often a clock is set back; times that go back more often are none.
const SET_BACK: usize = 3;

/// Limits the share of times with several rows up to which these are events, and the rows at an event.
const EVENTS: (f64, usize) = (0.1, 4);

pub(super) fn mend(mut table: Table) -> Table {
    with_fractions(&mut table);
    let named = places(table.columns.len(), &|place| is_named_time(&table.columns[place]));
    let falls = |place: &usize| {
        let values = &table.columns[*place].values;
        !seldom_falls(values) && seldom_falls(&mapped(values, &|time| -time))
    };
    if !named.is_empty() && named.iter().all(falls) {
        let name = table.columns[named[0]].name.clone();
        table = table.of_rows((0..table.rows()).rev().map(|row| vec![row]));
        let said = format!("the times in `{name}` fall, the newest first: the rows are read from last to first");
        table.remarks.push(said);
    }
    for &place in &named {
        let column = &mut table.columns[place];
        let mut times = column.values.clone();
        let steps = times.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0);
        let Some(step) = median(steps.collect()) else { continue };
        let turned = with_turns(&mut times, |before, now| turn(before, now, step));
        if let Some((row, range)) = turned.filter(|_| seldom_falls(&times)) {
            column.values = times;
            let (name, line) = (column.name.clone(), table.line(row));
            table.remarks.push(format!("`{name}` turns over at {range} in line {line}: its times continue from there"));
        }
    }
    let midnight = |before: f64, now: f64| (now < before - 0.5 * DAY).then_some(DAY);
    for &place in &named {
        if table.columns[place].is_time_of_day
            && let Some((row, _)) = with_turns(&mut table.columns[place].values, midnight)
        {
            table.remarks.push(format!("the times pass midnight in line {}", table.line(row)));
        }
    }
    // Rows that one clock has twice may be others of another clock.
    match named.first() {
        Some(&place) if clocks(&table).len() < 2 => rows_mended(table, place),
        None => without_first_rows(table),
        _ => table,
    }
}

fn with_fractions(table: &mut Table) {
    let size = |column: &Column| {
        let word = column.unit.as_deref().or(column.name.rsplit(|c: char| !c.is_alphanumeric()).next())?;
        let size = unit(word).filter(|(of, size)| *of == Dimension::Time && *size < 1.0)?.1;
        column.values.iter().all(|x| x.fract() == 0.0 && (0.0..1.0).contains(&(x * size))).then_some(size)
    };
    let is_whole = |column: &Column| {
        let is_second = column.unit.as_deref().is_none_or(|text| unit(text) == Some((Dimension::Time, 1.0)));
        let is_repeated = column.values.windows(2).any(|pair| pair[0] == pair[1]);
        is_named_time(column) && is_second && is_repeated && column.values.iter().all(|time| time.fract() == 0.0)
    };
    let of = |pair: &[Column]| size(&pair[1]).filter(|_| is_whole(&pair[0]));
    let found = table.columns.windows(2).enumerate().find_map(|(place, pair)| Some((place, of(pair)?)));
    let Some((place, size)) = found else { return };
    let fractions = table.columns.remove(place + 1);
    let time = &mut table.columns[place];
    time.values.iter_mut().zip(&fractions.values).for_each(|(time, fraction)| *time += size * fraction);
    let said = format!("`{}` has the fractions of the seconds in `{}`: they are one time", fractions.name, time.name);
    table.remarks.push(said);
}

/// Wristbands write the time of the start there, and the samples a second.
fn without_first_rows(table: Table) -> Table {
    let numbers = (0..table.columns.len()).filter(|&place| !table.is_without_numbers(place));
    let columns: Vec<&[f64]> = numbers.map(|place| table.columns[place].values.as_slice()).collect();
    let apart = |values: &&[f64]| if values.len() > 8 { first_rows_apart(values) } else { None };
    let first = columns.first().and_then(apart);
    let Some(first) = first.filter(|_| columns.iter().all(|of| apart(of) == first)) else { return table };
    let rate = columns[0][first];
    let begins = (1.0..=1e5).contains(&rate)
        && rate.fract() == 0.0
        && columns.iter().all(|values| values[first] == rate && EPOCHS.contains(&values[first - 1]));
    let rows = first + usize::from(begins);
    let mut kept = table.of_rows((rows..table.rows()).map(|row| vec![row]));
    kept.rate = begins.then_some(rate).or(kept.rate);
    kept.remarks.push(if begins {
        format!("the first {rows} rows are the start time and the sample rate, {rate} samples a second")
    } else {
        format!("the numbers of the first {rows} row(s) are far from all others: these rows are left out")
    });
    kept
}

/// Counters of 16 and 32 bits that count a decimal part of their column's unit, and the week of GPS.
fn ranges() -> impl Iterator<Item = f64> {
    let bits = [65_536.0, 4_294_967_296.0].into_iter();
    bits.flat_map(|range| [1.0, 1e-3, 1e-6, 1e-9].map(|unit| range * unit)).chain([604_800.0, 6.048e8])
}

/// The range at whose end a counter with a usual step turns over between two times. `None` if it does not.
pub fn turn(before: f64, now: f64, step: f64) -> Option<f64> {
    let passed = |range: f64| (0.0..5.0 * step).contains(&(now + range - before));
    let is_at_the_end = |range: f64| {
        [0.0, -0.5 * range].iter().any(|low| (low + range - 5.0 * step..=low + range).contains(&before) && now >= *low)
    };
    if now < before { ranges().find(|&range| passed(range) && is_at_the_end(range)) } else { None }
}

fn with_turns(times: &mut [f64], turn: impl Fn(f64, f64) -> Option<f64>) -> Option<(usize, f64)> {
    let (mut added, mut first, mut before) = (0.0, None, f64::NAN);
    for (row, time) in times.iter_mut().enumerate() {
        if let Some(range) = turn(before, *time) {
            added += range;
            first.get_or_insert((row, range));
        }
        before = if time.is_nan() { before } else { *time };
        *time += added;
    }
    first
}

fn rows_mended(mut table: Table, place: usize) -> Table {
    let values = &table.columns[place].values;
    let count = values.iter().rposition(|time| !time.is_nan()).map_or(0, |last| last + 1);
    let mut times = values[..count].to_vec();
    if count < 4 || times.iter().any(|time| !time.is_finite()) {
        return table;
    }
    let (name, mut said) = (table.columns[place].name.clone(), Vec::new());
    let mut rows: Vec<usize> = (0..count).collect();
    if let Some(first) = first_rows_apart(&times) {
        said.push(format!("the first {first} time(s) in `{name}` are far from all others: these rows are left out"));
        rows.drain(..first);
    }
    let step = median_step(&rows.iter().map(|&row| times[row]).collect::<Vec<f64>>());
    let backward: Vec<usize> = (1..rows.len()).filter(|&k| times[rows[k]] < times[rows[k - 1]]).collect();
    if !backward.is_empty() && step > 0.0 {
        let line = |k: usize| table.line(rows[k]);
        let begins = |&k: &usize| (times[rows[k]] - times[rows[0]]).abs() <= 3.0 * step;
        if let Some(sorted) = in_order(&times, &rows, step) {
            let first = line(backward[0] - 1);
            said.push(format!("the rows from line {first} on are not in the order of their times: they are sorted"));
            rows = sorted;
        } else if backward.iter().all(begins) {
            let ends = [&[0], &backward[..], &[rows.len()]].concat();
            let parts = ends.windows(2).map(|ends| ends[0]..ends[1]);
            let longest = parts.rev().max_by_key(ExactSizeIterator::len).unwrap_or(0..rows.len());
            let (begin, first, last, parts) =
                (line(backward[0]), line(longest.start), line(longest.end - 1), ends.len() - 1);
            said.push(format!(
                "the times in `{name}` begin again in line {begin}: of {parts} parts the longest is read, lines {first} to {last}; to \
                 read another, save it as a file"
            ));
            rows = rows[longest].to_vec();
        } else if backward.len() <= SET_BACK {
            for &k in &backward {
                let shift = times[rows[k - 1]] + step - times[rows[k]];
                let back = format!("set back by {shift:.3} of its unit in line {}", line(k));
                said.push(format!("the clock `{name}` is {back}: the times continue by a usual step"));
                rows[k..].iter().for_each(|&row| times[row] += shift);
            }
        }
    }
    let groups = of_one_time(&table, place, &times, &rows).unwrap_or_else(|| mapped(&rows, &|row| vec![*row]));
    if groups.len() < rows.len() {
        let first = groups.iter().find(|group| group.len() > 1).map_or(0, |group| group[1]);
        let (more, line) = (rows.len() - groups.len(), table.line(first));
        let before = format!("{more} rows have the time of the row before them, the first is line {line}");
        said.push(before + ": their last reading counts");
    }
    if said.is_empty() {
        return table;
    }
    let groups = groups.into_iter().chain((count..table.rows()).map(|row| vec![row]));
    table.columns[place].values[..count].copy_from_slice(&times);
    table.remarks.extend(said);
    table.of_rows(groups)
}

fn first_rows_apart(times: &[f64]) -> Option<usize> {
    (1..=3.min(times.len() - 3)).find(|&first| {
        let rest = &times[first..];
        let ends =
            rest.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &time| [low.min(time), high.max(time)]);
        let span = ends[1] - ends[0];
        span > 0.0 && times[..first].iter().all(|time| (time - rest[0]).abs() > APART * span)
    })
}

/// `None` unless each row is near its place and the sorted times have usual steps.
fn in_order(times: &[f64], rows: &[usize], step: f64) -> Option<Vec<usize>> {
    let sorted = sorted_places(rows.len(), &|one, other| times[rows[one]].total_cmp(&times[rows[other]]));
    let is_near = sorted.iter().enumerate().all(|(place, &before)| place.abs_diff(before) <= 64);
    let sorted: Vec<usize> = sorted.into_iter().map(|place| rows[place]).collect();
    let usual = 0.2 * step..100.0 * step;
    let has_steps = sorted.windows(2).all(|pair| usual.contains(&(times[pair[1]] - times[pair[0]])));
    (is_near && has_steps).then_some(sorted)
}

/// `None` where many times have several rows with unlike readings: then they are rounded.
fn of_one_time(table: &Table, place: usize, times: &[f64], rows: &[usize]) -> Option<Vec<Vec<usize>>> {
    let groups: Vec<Vec<usize>> = rows.chunk_by(|a, b| times[*a] == times[*b]).map(<[usize]>::to_vec).collect();
    let others = || table.columns.iter().enumerate().filter(|(other, _)| *other != place);
    let is_unlike = |pair: &[usize]| {
        others()
            .map(|(_, column)| (column.values[pair[0]], column.values[pair[1]]))
            .any(|(a, b)| a.partial_cmp(&b).is_some_and(Ordering::is_ne))
    };
    let unlike = groups.iter().filter(|group| group.windows(2).any(is_unlike)).count();
    let is_short = groups.iter().all(|group| group.len() <= EVENTS.1);
    (unlike == 0 || (is_short && unlike as f64 <= EVENTS.0 * groups.len() as f64)).then_some(groups)
}
