//! Readings at their own times: in place of even steps, by a clock for each column (`t1, force, t2, displacement`), and of two files.

use std::collections::BTreeMap;

use kalmanscope_filters::Hold;
use kalmanscope_filters::lists::{self, numbers, sort_items};

use super::guess::{clocks, is_named_time, no_time, rises};
use super::table::{Column, free_name};
use super::times::{Clock, Timing};
use super::{FEWEST, ImportError, MappedColumn, Mapping, Offset, Result, Table};
use crate::record::{Clocks, Timed};
use crate::resample::{Steps, mean, side_of};

/// Without cells that have no number; times in \[s\].
#[derive(Debug, Default)]
pub(super) struct OwnTimes {
    /// The cells of each column, and the number of those without a number.
    columns: BTreeMap<String, (Timed, usize)>,
    pub(super) clocks: Clocks,
}

impl OwnTimes {
    pub(super) fn of_rows(table: &Table, mapping: &Mapping, times: &[f64]) -> Self {
        let mut own = Self::default();
        for mapped in mapping.columns() {
            if let Some(place) = table.place(&mapped.column) {
                own.add(&mapped.column, times, &table.columns[place].values, mapped.missing);
            }
        }
        for column in table.columns.iter().filter(|column| column.name.starts_with("true_")) {
            own.add(&column.name, times, &column.values, None);
        }
        own
    }

    fn add(&mut self, name: &str, times: &[f64], values: &[f64], missing: Option<f64>) {
        let is_there = |value: f64| !value.is_nan() && Some(value) != missing;
        let cells = times.iter().zip(values).filter(|(_, value)| is_there(**value));
        let (own, values): (Vec<f64>, Vec<f64>) = cells.unzip();
        let empty = times.len() - own.len();
        self.columns.insert(name.to_owned(), (Timed { times: own, values }, empty));
    }

    /// Without the delay; times are in steps after the first one.
    fn scaled(&self, mapped: &MappedColumn, Steps { start, dt, count }: Steps) -> Timed {
        let Some((Timed { times, values }, _)) = self.columns.get(&mapped.column) else { return Timed::default() };
        let between = |from: f64, to: f64| {
            let is_in = |(time, _): &(&f64, &f64)| (from..=to).contains(*time);
            mean(&times.iter().zip(values).filter(is_in).map(|(_, value)| *value).collect::<Vec<_>>())
        };
        let offset = match mapped.offset {
            Offset::Number(number) => number,
            Offset::Mean(_) => between(start - dt, start + dt * count as f64),
            Offset::Part { mean: [from, to] } => between(from, to),
        };
        let in_steps = |time: &f64| (time - start) / dt - f64::from(mapped.delay);
        let (times, factor) = (times.iter().map(in_steps).collect(), mapped.factor());
        Timed { times, values: lists::mapped(values, &|value| factor * (value - offset)) }
    }

    pub(super) fn input(&mut self, mapped: &MappedColumn, hold: Hold, steps: Steps) -> Option<Vec<f64>> {
        let values = self.force(mapped, hold, steps)?;
        self.clocks.input = Some(self.scaled(mapped, steps));
        Some(values)
    }

    pub(super) fn force(&self, mapped: &MappedColumn, hold: Hold, steps: Steps) -> Option<Vec<f64>> {
        let timed = self.scaled(mapped, steps);
        (!timed.times.is_empty()).then(|| numbers(steps.count, &|k| timed.at(k as f64, hold)))
    }

    pub(super) fn empty(&self, name: &str) -> usize {
        self.columns.get(name).map_or(0, |(_, empty)| *empty)
    }

    /// At the ends of the steps in which the readings fall; NaN at a step without one.
    pub(super) fn sensor(&mut self, mapped: &MappedColumn, steps: Steps) -> Vec<f64> {
        let Timed { mut times, mut values } = self.scaled(mapped, steps);
        let in_steps = Steps { start: 0.0, dt: 1.0, count: steps.count };
        // Clocks have some decimals only.
        let end = |steps: f64| libm::ceil(steps - 1e-6);
        let at_ends = in_steps.of(&times, &values, side_of(&times, &values), end);
        let from = times.partition_point(|time| *time <= -1.0);
        let to = times.partition_point(|time| *time <= steps.count as f64 - 1.0);
        (times, values) = (times[from..to.max(from)].to_vec(), values[from..to.max(from)].to_vec());
        self.clocks.readings.push(Timed { times, values });
        at_ends
    }

    /// Linear between the cells.
    pub(super) fn truth(&self, name: &str, steps: Steps) -> Option<Vec<f64>> {
        self.columns.get(name)?;
        let timed = self.scaled(&MappedColumn::new(name), steps);
        if timed.times.is_empty() {
            return Some(vec![f64::NAN; steps.count]);
        }
        Some(numbers(steps.count, &|k| timed.at(k as f64, Hold::First)))
    }

    /// Shifted along the cubic through the neighbours; NaN at a step without a cell.
    pub(super) fn at_steps(&self, name: &str, steps: Steps) -> Vec<f64> {
        let of = |(Timed { times, values }, _): &(Timed, usize)| {
            steps.of(times, values, side_of(times, values), libm::round)
        };
        self.columns.get(name).map_or_else(|| vec![f64::NAN; steps.count], of)
    }
}

pub(super) struct OneClock {
    pub(super) timing: Timing,
    pub(super) own: OwnTimes,
    pub(super) is_even: bool,
}

/// `None` where a mapping's columns have one clock.
pub(super) fn on_one_clock(table: &Table, mapping: &Mapping, remarks: &mut Vec<String>) -> Result<Option<OneClock>> {
    let clocks = clocks(table);
    let stated = mapping.time.column.as_deref().and_then(|name| table.place(name));
    let is_clock = |place: &usize| clocks.iter().any(|(_, clock)| clock == place);
    let Some(stated) = stated.filter(is_clock) else { return Ok(None) };
    let mut parts: Vec<(usize, Vec<(usize, &MappedColumn)>)> = Vec::new();
    for mapped in mapping.columns() {
        let Some(place) = table.place(&mapped.column) else { continue };
        let own = clocks.iter().find(|(of, _)| *of == place).map_or(stated, |(_, clock)| *clock);
        let clock = parts.iter().map(|(clock, _)| *clock).chain([stated]).find(|other| is_same(table, *other, own));
        let clock = clock.unwrap_or(own);
        match parts.iter_mut().find(|(other, _)| *other == clock) {
            Some((_, columns)) => columns.push((place, mapped)),
            None => parts.push((clock, vec![(place, mapped)])),
        }
    }
    if parts.iter().all(|(clock, _)| *clock == stated) {
        return Ok(None);
    }
    let rank = |clock: usize| (clock != stated, clock);
    sort_items(&mut parts, |a, b| rank(a.0).cmp(&rank(b.0)));
    let (mut own, mut all) = (OwnTimes::default(), Vec::new());
    for (place, columns) in &parts {
        let time = &table.columns[*place];
        let is_unit_stated = (*place == stated || time.unit.is_none()) && !mapping.time.unit.is_empty();
        let unit = if is_unit_stated { &mapping.time.unit } else { time.unit.as_deref().unwrap_or_default() };
        let mut said = Vec::new();
        let clock = Clock::of(table, *place, unit, &mut said)?;
        let below =
            |(place, _): &(usize, _)| table.columns[*place].values[clock.times.len()..].iter().any(|x| !x.is_nan());
        let is_other = clock.times.len() < table.rows() && !columns.iter().any(below);
        remarks.extend(said.into_iter().skip(usize::from(is_other)));
        for (place, mapped) in columns {
            own.add(&mapped.column, &clock.times, &table.columns[*place].values, mapped.missing);
        }
        all.push((clock, 0.0));
    }
    let names: Vec<String> = parts.iter().map(|(clock, _)| format!("`{}`", table.columns[*clock].name)).collect();
    let (names, stated) = (names.join(" and "), &table.columns[stated].name);
    let Some((steps, fast)) = common(&all) else {
        // Rows of clocks of unequal length do not belong together.
        let is_longer = |(clock, _): &&(Clock<'_>, f64)| clock.times.len() != all[0].0.times.len();
        if let Some((other, _)) = all.iter().find(is_longer) {
            return Err(ImportError::Apart(all[0].0.ends(), other.ends()));
        }
        remarks.push(format!(
            "the clocks {names} have no time in common: the columns are read row by row, at the times of `{stated}`"
        ));
        return Ok(None);
    };
    remarks.push(if mapping.needs_even_steps() {
        let (seconds, dt, fast) = (steps.seconds(), steps.dt, &table.columns[parts[fast].0].name);
        format!(
            "the clocks {names} have {seconds:.3} s in common, at the steps of the clock `{fast}`, {dt} s apart; the readings of others, \
             and all with uneven times, move to the nearest step"
        )
    } else {
        format!(
            "each column has its own clock, {names}: the filters use each reading at its own time, and report at the \
             steps of the fastest clock"
        )
    });
    let is_even = all[fast].0.timing.is_even();
    Ok(Some(OneClock { timing: Timing::of_steps(steps), own, is_even }))
}

fn is_same(table: &Table, one: usize, other: usize) -> bool {
    if one == other {
        return true;
    }
    let (Some(a), Some(b)) = (rises(table, one), rises(table, other)) else { return false };
    let spans = [&a, &b].map(|times| times[times.len() - 1] - times[0]);
    let scale = spans[1] / spans[0];
    let limit = 1e-3 * spans[1] / (b.len() - 1) as f64;
    let is_other_unit = scale.max(1.0 / scale) > 10.0;
    let (zero, scale) = if is_other_unit { (b[0] - scale * a[0], scale) } else { (0.0, 1.0) };
    a.len() == b.len() && a.iter().zip(&b).all(|(a, b)| (zero + scale * a - b).abs() <= limit)
}

fn clock_of<'a>(table: &'a Table, remarks: &mut Vec<String>) -> Result<Clock<'a>> {
    let time = Mapping::guess(table).0.time;
    let place = time.column.and_then(|name| table.place(&name)).ok_or_else(|| no_time(table))?;
    Clock::of(table, place, &time.unit, remarks)
}

/// The steps of the fastest clock, and its place. Each clock has seconds that are added to its times.
fn common(clocks: &[(Clock<'_>, f64)]) -> Option<(Steps, usize)> {
    let all = clocks.iter().enumerate();
    let (fast, (clock, added)) = all.min_by(|(_, (a, _)), (_, (b, _))| a.timing.dt.total_cmp(&b.timing.dt))?;
    let Timing { start, dt, samples, .. } = clock.timing;
    let start = start + added;
    let ends = || clocks.iter().map(|(clock, added)| clock.ends().map(|time| time + added));
    let latest = ends().map(|[first, _]| first).fold(f64::NEG_INFINITY, f64::max);
    let earliest = ends().map(|[_, last]| last).fold(f64::INFINITY, f64::min);
    // A slower clock has a nearest step up to half a step beyond its ends.
    let from = libm::ceil((latest - start) / dt - 0.5).max(0.0);
    let to = libm::floor((earliest - start) / dt + 0.5).min((samples - 1) as f64);
    let count = to - from + 1.0;
    (count >= FEWEST as f64).then_some((Steps { start: start + from * dt, dt, count: count as usize }, fast))
}

/// Both files as one table, each with its column of times and its columns behind it. `offset` is added to the times of the second file
/// \[s\]. Nothing is moved: [`build`](super::build) gives each column its own times.
///
/// # Errors
/// [`ImportError`] where a file has no usable times, or where they have no time in common.
pub fn join(first: &Table, second: &Table, offset: f64) -> Result<Table> {
    let mut remarks: Vec<String> = [first, second].into_iter().flat_map(|table| table.remarks.clone()).collect();
    let clocks = [(clock_of(first, &mut remarks)?, 0.0), (clock_of(second, &mut remarks)?, offset)];
    let Some((steps, _)) = common(&clocks) else {
        let [first, second] = clocks.map(|(clock, added)| clock.ends().map(|time| time + added));
        return Err(ImportError::Apart(first, second));
    };
    let rows = clocks.iter().map(|(clock, _)| clock.times.len()).max().unwrap_or(0);
    let mut columns: Vec<Column> = Vec::new();
    let mut add = |name: &str, unit: Option<String>, mut values: Vec<f64>| {
        let name = free_name(name, |name| columns.iter().any(|column| column.name == name));
        values.resize(rows, f64::NAN);
        columns.push(Column { name, unit, values, ..Column::default() });
    };
    for (table, (clock, added)) in [first, second].into_iter().zip(&clocks) {
        let own = &table.columns[clock.place];
        let name = if is_named_time(own) { &own.name } else { "time" };
        add(name, Some("s".to_owned()), clock.times.iter().map(|time| time + added).collect());
        for (place, column) in table.columns.iter().enumerate().filter(|(place, _)| *place != clock.place) {
            if column.text.is_some() || table.is_without_numbers(place) {
                remarks.push(format!("`{}` has text, or no numbers: it is left out", column.name));
            } else {
                add(&column.name, column.unit.clone(), column.values.clone());
            }
        }
    }
    let seconds = steps.seconds();
    remarks.push(format!("the first file and the second file have {seconds:.3} s in common; each keeps its times"));
    Ok(Table::of_columns("two files with clocks of their own", columns, remarks))
}
