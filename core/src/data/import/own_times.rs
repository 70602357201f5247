//! Readings at their own times: those that a file gives them in place of even steps, and those of files in which columns have clocks
//! (`t1, force, t2, displacement`) and of two files with a clock each.

use std::collections::BTreeMap;

use super::conditioning::mean;
use super::error::FEWEST;
use super::guess::{clocks, is_named_time, rises};
use super::table::{Column, free_name};
use super::times::{Clock, Timing};
use super::{ImportError, MappedColumn, Mapping, Offset, Table, Time, times};
use crate::Hold;
use crate::data::even_steps::Steps;
use crate::data::free_decay::side_of;
use crate::data::record::{Clocks, Timed};

/// The cells of some columns that have a number, with their times \[s\].
#[derive(Debug, Default)]
pub(super) struct OwnTimes {
    /// With the number of rows of each column that have none.
    columns: BTreeMap<String, (Timed, usize)>,
    /// Those of the record whose columns were asked for.
    pub(super) clocks: Clocks,
}

impl OwnTimes {
    /// The columns of a table that a mapping names, and those with a truth, at the times of the rows \[s\].
    pub(super) fn of_rows(table: &Table, mapping: &Mapping, times: &[f64]) -> Self {
        let mut own = Self::default();
        for mapped in mapping.input.iter().chain(mapping.sensors.values()) {
            if let Some(place) = table.place(&mapped.column) {
                own.add(&mapped.column, times, &table.columns[place].values, mapped.missing);
            }
        }
        for column in table.columns.iter().filter(|column| column.name.starts_with("true_")) {
            own.add(&column.name, times, &column.values, None);
        }
        own
    }

    /// Adds the cells of a column that are not missing.
    fn add(&mut self, name: &str, times: &[f64], values: &[f64], missing: Option<f64>) {
        let is_there = |value: f64| !value.is_nan() && Some(value) != missing;
        let cells = times.iter().zip(values).filter(|(_, value)| is_there(**value));
        let (own, values): (Vec<f64>, Vec<f64>) = cells.unzip();
        let empty = times.len() - own.len();
        self.columns.insert(name.to_owned(), (Timed { times: own, values }, empty));
    }

    /// A column in the meaning that a mapping gives it: `factor · (cell - offset)`, that much earlier, with times in steps after the
    /// first one.
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
        Timed { times, values: values.iter().map(|value| factor * (value - offset)).collect() }
    }

    /// The input of a column at the steps; a sensor's comes with [`Self::sensor`].
    pub(super) fn input(&mut self, mapped: &MappedColumn, hold: Hold, steps: Steps) -> Option<Vec<f64>> {
        let timed = self.scaled(mapped, steps);
        if timed.times.is_empty() {
            return None;
        }
        let values = (0..steps.count).map(|k| timed.at(k as f64, hold)).collect();
        self.clocks.input = Some(timed);
        Some(values)
    }

    /// The rows of a column that have no number.
    pub(super) fn empty(&self, name: &str) -> usize {
        self.columns.get(name).map_or(0, |(_, empty)| *empty)
    }

    /// The readings of a column at the ends of the steps in which they fall; NaN at a step without one.
    pub(super) fn sensor(&mut self, mapped: &MappedColumn, steps: Steps) -> Vec<f64> {
        let Timed { mut times, mut values } = self.scaled(mapped, steps);
        let in_steps = Steps { start: 0.0, dt: 1.0, count: steps.count };
        // Clocks have some decimals only.
        let end = |steps: f64| libm::ceil(steps - 1e-6);
        let at_ends = in_steps.of(&times, &values, side_of(&times, &values), end);
        // What is before the first step does not count, and what is after the last one is not part of the record.
        let from = times.partition_point(|time| *time <= -1.0);
        let to = times.partition_point(|time| *time <= steps.count as f64 - 1.0);
        (times, values) = (times[from..to.max(from)].to_vec(), values[from..to.max(from)].to_vec());
        self.clocks.readings.push(Timed { times, values });
        at_ends
    }

    /// The truth of a column at the steps, linear between its cells.
    pub(super) fn truth(&self, name: &str, steps: Steps) -> Vec<f64> {
        let timed = self.scaled(&MappedColumn::new(name), steps);
        if timed.times.is_empty() {
            return vec![f64::NAN; steps.count];
        }
        (0..steps.count).map(|k| timed.at(k as f64, Hold::First)).collect()
    }
}

/// Two clocks that differ by less than this share of a step tell the same times.
const SAME: f64 = 1e-3;

/// Clocks that differ by a larger factor have other units.
const UNITS: f64 = 10.0;

/// Columns with clocks of their own.
pub(super) struct OneClock {
    /// The columns at the steps of one clock.
    pub(super) table: Table,
    /// The mapping with that clock.
    pub(super) mapping: Mapping,
    /// The columns at their own times.
    pub(super) own: OwnTimes,
    /// Whether the faster clock has even steps.
    pub(super) is_even: bool,
    /// A sentence on the clocks.
    pub(super) said: String,
}

/// The columns of a mapping at the steps of one clock, and at their own times, where they have clocks of their own. A file whose
/// clocks have no time in common is read row by row: then a sentence goes to the remarks.
///
/// # Errors
/// Those of [`join`](super::join).
pub(super) fn on_one_clock(
    table: &Table,
    mapping: &Mapping,
    remarks: &mut Vec<String>,
) -> Result<Option<OneClock>, ImportError> {
    let clocks = clocks(table);
    let stated = mapping.time.column.as_deref().and_then(|name| table.place(name));
    let Some(stated) = stated.filter(|place| clocks.contains(place)) else { return Ok(None) };
    let mut parts: Vec<(usize, Vec<(usize, &MappedColumn)>)> = Vec::new();
    for mapped in mapping.input.iter().chain(mapping.sensors.values()) {
        let Some(place) = table.place(&mapped.column) else { continue };
        let own = clocks.iter().rev().find(|clock| **clock < place).copied().unwrap_or(clocks[0]);
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
    // The stated clock names the times.
    parts.sort_by_key(|(clock, _)| (*clock != stated, *clock));
    let mut own = OwnTimes::default();
    let tables: Vec<Table> = parts.iter().map(|(clock, columns)| part(table, mapping, *clock, columns)).collect();
    for (part, (_, columns)) in tables.iter().zip(&parts) {
        let [time, values @ ..] = part.columns.as_slice() else { continue };
        let times = times::of(part, time, time.unit.as_deref().unwrap_or_default(), &mut Vec::new());
        for (column, (_, mapped)) in values.iter().zip(columns) {
            own.add(&mapped.column, &times, &column.values, None);
        }
    }
    let all: Vec<String> = parts.iter().map(|(clock, _)| format!("`{}`", table.columns[*clock].name)).collect();
    let mut is_even = true;
    let mut names = parts.iter().map(|(clock, _)| format!("the clock `{}`", table.columns[*clock].name));
    let mut tables = tables.into_iter();
    let (Some(mut whole), Some(mut name)) = (tables.next(), names.next()) else { return Ok(None) };
    for (other, other_name) in tables.zip(names) {
        match join_on_steps([&whole, &other], [&name, &other_name]) {
            Ok((table, is)) => (whole, is_even) = (table, is_even && is),
            Err(ImportError::Apart { .. }) => {
                let apart = format!(
                    "{name} and {other_name} have no time in common: the columns are read row by row, at the times of {name}"
                );
                remarks.push(apart);
                return Ok(None);
            }
            Err(error) => return Err(error),
        }
        name = format!("{name} and {other_name}");
    }
    let clock = &whole.columns[0];
    let (column, unit) = (Some(clock.name.clone()), clock.unit.clone().unwrap_or_default());
    let time = Time { column, unit, ..mapping.time.clone() };
    let said = format!(
        "the columns have clocks of their own, {}: the filters take each reading at its own time, and tell what they know at the steps \
         of the fastest one",
        all.join(" and ")
    );
    Ok(Some(OneClock { table: whole, mapping: Mapping { time, ..mapping.clone() }, own, is_even, said }))
}

/// Whether two columns tell the same times, maybe in other units.
fn is_same(table: &Table, one: usize, other: usize) -> bool {
    if one == other {
        return true;
    }
    let (Some(a), Some(b)) = (rises(table, one), rises(table, other)) else { return false };
    let spans = [&a, &b].map(|times| times[times.len() - 1] - times[0]);
    let scale = spans[1] / spans[0];
    let limit = SAME * spans[1] / (b.len() - 1) as f64;
    let is_other_unit = scale.max(1.0 / scale) > UNITS;
    let (zero, scale) = if is_other_unit { (b[0] - scale * a[0], scale) } else { (0.0, 1.0) };
    a.len() == b.len() && a.iter().zip(&b).all(|(a, b)| (zero + scale * a - b).abs() <= limit)
}

/// A clock with its columns, in which cells without a reading are empty.
fn part(table: &Table, mapping: &Mapping, clock: usize, columns: &[(usize, &MappedColumn)]) -> Table {
    let mut time = table.columns[clock].clone();
    let is_stated = mapping.time.column.as_deref() == Some(&time.name);
    if (is_stated || time.unit.is_none()) && !mapping.time.unit.is_empty() {
        time.unit = Some(mapping.time.unit.clone());
    }
    let last = |column: &Column| column.values.iter().rposition(|value| !value.is_nan()).map_or(0, |last| last + 1);
    let rows = columns.iter().map(|(place, _)| last(&table.columns[*place])).fold(last(&time), usize::max);
    time.values.truncate(rows);
    let of = |&(place, mapped): &(usize, &MappedColumn)| {
        let mut column: Column = table.columns[place].clone();
        column.values.truncate(rows);
        column.values.iter_mut().filter(|value| Some(**value) == mapped.missing).for_each(|value| *value = f64::NAN);
        column
    };
    let columns = std::iter::once(time).chain(columns.iter().map(of)).collect();
    Table { columns, remarks: Vec::new(), ..table.clone() }
}

/// The clock of a file, by the guess at its column of times.
///
/// # Errors
/// [`ImportError`] where it has none, or where its times are not usable.
fn clock_of<'a>(table: &'a Table, remarks: &mut Vec<String>) -> Result<Clock<'a>, ImportError> {
    let time = Mapping::guess(table).0.time;
    let place = time.column.and_then(|name| table.place(&name)).ok_or(ImportError::NoTime)?;
    Clock::of(table, place, &time.unit, remarks)
}

/// The steps of the faster clock that two tables have in common.
struct Common<'a> {
    clocks: [Clock<'a>; 2],
    /// The place of the faster one.
    fast: usize,
    /// The steps among those of the faster clock.
    part: std::ops::Range<usize>,
    steps: Steps,
}

impl<'a> Common<'a> {
    /// Of two tables; `offset` is added to the times of the second one \[s\].
    fn new([first, second]: [&'a Table; 2], offset: f64, remarks: &mut Vec<String>) -> Result<Self, ImportError> {
        let clocks = [clock_of(first, remarks)?, clock_of(second, remarks)?];
        let added = [0.0, offset];
        let fast = usize::from(clocks[1].timing.dt < clocks[0].timing.dt);
        let Timing { start, dt, samples, .. } = clocks[fast].timing;
        let start = start + added[fast];
        let ends: [[f64; 2]; 2] = std::array::from_fn(|file| clocks[file].ends().map(|time| time + added[file]));
        // Half a step beyond its ends, the slower file has a nearest step.
        let from = libm::ceil((ends[0][0].max(ends[1][0]) - start) / dt - 0.5).max(0.0);
        let to = libm::floor((ends[0][1].min(ends[1][1]) - start) / dt + 0.5).min((samples - 1) as f64);
        if to - from + 1.0 < FEWEST as f64 {
            return Err(ImportError::Apart { first: ends[0], second: ends[1] });
        }
        let part = from as usize..to as usize + 1;
        let steps = Steps { start: start + from * dt, dt, count: part.len() };
        Ok(Self { clocks, fast, part, steps })
    }

    /// The time that both have \[s\].
    fn seconds(&self) -> f64 {
        (self.steps.count - 1) as f64 * self.steps.dt
    }
}

/// Both files as one table, each with its column of times and its columns behind it. `offset` is added to the times of the second file
/// \[s\]. Nothing is moved: a [`Builder`](super::Builder) gives each column its own times.
///
/// # Errors
/// [`ImportError`] where a file has no usable times, or where they have no time in common.
pub fn join(first: &Table, second: &Table, offset: f64) -> Result<Table, ImportError> {
    let mut remarks: Vec<String> = [first, second].into_iter().flat_map(|table| table.remarks.clone()).collect();
    let common = Common::new([first, second], offset, &mut remarks)?;
    let rows = common.clocks.iter().map(|clock| clock.times.len()).max().unwrap_or(0);
    let mut columns: Vec<Column> = Vec::new();
    let mut add = |name: &str, unit: Option<String>, mut values: Vec<f64>| {
        let name = free_name(name, |name| columns.iter().any(|column| column.name == name));
        values.resize(rows, f64::NAN);
        columns.push(Column { name, unit, values, ..Column::default() });
    };
    for ((table, clock), added) in [first, second].into_iter().zip(&common.clocks).zip([0.0, offset]) {
        let own = &table.columns[clock.place];
        let name = if is_named_time(own) { &own.name } else { "time" };
        add(name, Some("s".to_owned()), clock.times.iter().map(|time| time + added).collect());
        for (place, column) in table.columns.iter().enumerate().filter(|(place, _)| *place != clock.place) {
            if !is_usable(table, place, &mut remarks) {
                continue;
            }
            add(&column.name, column.unit.clone(), column.values.clone());
        }
    }
    let seconds = common.seconds();
    remarks.push(format!("the first file and the second file have {seconds:.3} s in common; each keeps its times"));
    Ok(Table::of_columns("two files with clocks of their own", columns, remarks))
}

/// Whether a column has numbers, and no text; otherwise that is said.
fn is_usable(table: &Table, place: usize, remarks: &mut Vec<String>) -> bool {
    let column = &table.columns[place];
    let is_left_out = column.text.is_some() || table.is_without_numbers(place);
    remarks.extend(is_left_out.then(|| format!("`{}` has text, or no numbers: it is left out", column.name)));
    !is_left_out
}

/// Two tables at the steps of the faster clock, where they have time in common. Even times keep their readings. Every other reading
/// goes to its nearest step, shifted along the cubic through its neighbours; cells without a reading, which must be NaN, are missing.
/// Says too whether the times of the faster clock are even.
///
/// # Errors
/// Those of [`join`].
fn join_on_steps([first, second]: [&Table; 2], names: [&str; 2]) -> Result<(Table, bool), ImportError> {
    let mut remarks: Vec<String> = [first, second].into_iter().flat_map(|table| table.remarks.clone()).collect();
    let common = Common::new([first, second], 0.0, &mut remarks)?;
    let seconds = common.seconds();
    let Common { clocks, fast, part, steps } = common;
    let dt = steps.dt;
    let mut columns = vec![Column {
        name: first.columns[clocks[0].place].name.clone(),
        unit: Some("s".to_owned()),
        values: (0..part.len()).map(|k| steps.start + dt * k as f64).collect(),
        ..Column::default()
    }];
    for (file, table) in [first, second].into_iter().enumerate() {
        let clock = &clocks[file];
        for (place, column) in table.columns.iter().enumerate().filter(|(place, _)| *place != clock.place) {
            if !is_usable(table, place, &mut remarks) {
                continue;
            }
            let values = if file == fast && clock.timing.is_exact() {
                clock.timing.spread(&column.values)[part.clone()].to_vec()
            } else {
                let known = clock.times.iter().zip(&column.values).filter(|(_, value)| value.is_finite());
                let (times, values): (Vec<f64>, Vec<f64>) = known.unzip();
                steps.of(&times, &values, side_of(&times, &values), libm::round)
            };
            let name = free_name(&column.name, |name| columns.iter().any(|column| column.name == name));
            columns.push(Column { name, unit: column.unit.clone(), values, ..Column::default() });
        }
    }
    let slow_dt = clocks[1 - fast].timing.dt;
    let [one, other] = names;
    let (quick, slow) = (names[fast], names[1 - fast]);
    remarks.push(format!(
        "{one} and {other} have {seconds:.3} s in common, at the steps of {quick}, {dt} s apart; the readings of {slow}, about \
         {slow_dt} s apart, and all with uneven times go to the nearest step"
    ));
    let is_even = clocks[fast].timing.is_even();
    Ok((Table::of_columns("two clocks as one", columns, remarks), is_even))
}

#[cfg(test)]
mod tests {
    use std::fmt::Write as _;

    use super::super::Imported;
    use super::super::builder::tests::import;
    use crate::Quantity;

    /// `t1, force, t2, x` with 100 and 30 readings a second, the second clock from a time on.
    fn text(from: f64) -> String {
        let mut text = "t1 [s],force [N],t2 [ms],displacement [mm]\n".to_owned();
        for k in 0..600 {
            let (one, other) = (0.01 * f64::from(k), from + f64::from(k) / 30.0);
            let force = libm::sin(3.0 * one);
            let more =
                if k < 160 { format!("{:.6},{:.9}", 1e3 * other, libm::cos(2.0 * other)) } else { ",".to_owned() };
            writeln!(text, "{one:.2},{force:.9},{more}").unwrap();
        }
        text
    }

    #[test]
    fn columns_with_times_of_their_own_are_at_their_times() {
        let Imported { record, remarks, .. } = import(&text(0.2), |_| {}).unwrap();
        assert_eq!(remarks.len(), 1, "{remarks:?}");
        assert!((record.dt() - 0.01).abs() < 1e-12, "the steps of the faster clock");
        assert!(remarks[0].starts_with("the columns have clocks of their own, `t1` and `t2`"), "{remarks:?}");
        let (measured, mut there) = (record.measured_quantity(Quantity::DISPLACEMENT).unwrap(), 0);
        for (k, (input, measured)) in record.input().iter().zip(measured).enumerate() {
            let time = record.time(k);
            assert!((input - libm::sin(3.0 * time)).abs() < 1e-6, "the input at {time} s");
            if !measured.is_nan() {
                assert!((measured - 1e-3 * libm::cos(2.0 * time)).abs() < 1e-6, "the reading at {time} s");
                there += 1;
            }
        }
        let clocks = record.clocks().unwrap();
        assert_eq!(clocks.readings[0].times.len(), 160);
        for (k, (step, value)) in clocks.readings[0].times.iter().zip(&clocks.readings[0].values).enumerate() {
            let time = 0.2 + k as f64 / 30.0;
            assert!((record.time(0) + step * record.dt() - time).abs() < 1e-6, "its time is kept");
            assert!((value - 1e-3 * libm::cos(2.0 * time)).abs() < 1e-9, "the reading is the file's");
        }
        assert!((155..=161).contains(&there), "{there} readings");
    }

    #[test]
    fn one_clock_that_stands_twice_changes_nothing() {
        let once = "t,force,displacement\n0,1,2\n0.1,2,3\n0.2,1,4\n0.3,0,5\n0.4,1,3\n";
        let twice = "t,force,time,displacement\n0,1,0,2\n0.1,2,0.1,3\n0.2,1,0.2,4\n0.3,0,0.3,5\n0.4,1,0.4,3\n";
        let in_ms = "t [s],force,time [ms],displacement\n0,1,0,2\n0.1,2,100,3\n0.2,1,200,4\n0.3,0,300,5\n0.4,1,400,3\n";
        let of = |text: &str| {
            let Imported { record, remarks, .. } = import(text, |_| {}).unwrap();
            assert_eq!(remarks, Vec::<String>::new());
            (record.dt(), record.input().to_vec(), record.measured(0).to_vec())
        };
        assert_eq!(of(once), of(twice));
        assert_eq!(of(once), of(in_ms));
    }

    #[test]
    fn clocks_without_a_common_time_are_read_row_by_row_which_is_said() {
        let text =
            "t,force,stamp,displacement\n0,1,1000,2\n0.1,2,1000.11,3\n0.2,1,1000.2,4\n0.3,0,1000.3,5\n0.4,1,1000.4,3\n";
        let Imported { record, remarks, .. } = import(text, |_| {}).unwrap();
        assert_eq!((record.dt(), record.measured(0)), (0.1, &[2.0, 3.0, 4.0, 5.0, 3.0][..]));
        assert!(remarks[0].contains("`t` and the clock `stamp` have no time in common"), "{remarks:?}");
    }
}
