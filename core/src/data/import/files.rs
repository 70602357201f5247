//! Two files whose clocks differ, as one table.

use std::borrow::Cow;

use super::decay::side_of;
use super::limits::FEWEST;
use super::role::is_named_time;
use super::steps::Steps;
use super::table::{Column, free_name};
use super::timing::Timing;
use super::{ImportError, Mapping, Table, times};

/// The readings of a file's clock \[s\].
pub(super) struct Clock<'a> {
    /// The place of the column of times.
    pub(super) place: usize,
    pub(super) times: Cow<'a, [f64]>,
    pub(super) timing: Timing,
}

impl<'a> Clock<'a> {
    /// The clock of a file, by the guess at its column of times.
    ///
    /// # Errors
    /// [`ImportError`] where it has none, or where its times are not usable.
    pub(super) fn of(table: &'a Table, remarks: &mut Vec<String>) -> Result<Self, ImportError> {
        let time = Mapping::guess(table).0.time;
        let place = time.column.and_then(|name| table.place(&name)).ok_or(ImportError::NoTime)?;
        let column = &table.columns[place];
        if let Some(text) = &column.text {
            let (line, text) = (text.line, text.text.clone());
            return Err(ImportError::Text { line, column: column.name.clone(), text });
        }
        let times = times::of(table, column, &time.unit, remarks);
        let timing = Timing::of_times(&times, &column.name, |row| table.line(row))?;
        Ok(Self { place, times, timing })
    }

    /// The first time and the last one \[s\].
    pub(super) fn ends(&self) -> [f64; 2] {
        [self.times[0], self.times[self.times.len() - 1]]
    }
}

/// Two tables at the steps of one clock.
#[derive(Clone, Debug)]
pub(super) struct Joined {
    /// The table; its first column has the times.
    pub(super) table: Table,
    /// Whether the times of the faster clock are even.
    pub(super) is_even: bool,
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
        let clocks = [Clock::of(first, remarks)?, Clock::of(second, remarks)?];
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
            if column.text.is_some() || table.is_without_numbers(place) {
                remarks.push(format!("`{}` has text, or no numbers: it is left out", column.name));
                continue;
            }
            add(&column.name, column.unit.clone(), column.values.clone());
        }
    }
    let seconds = common.seconds();
    remarks.push(format!("the first file and the second file have {seconds:.3} s in common; each keeps its times"));
    Ok(Table::of_columns("two files with clocks of their own", columns, remarks))
}

/// Two tables at the steps of the faster clock, where they have time in common. Even times keep their readings. Every other reading
/// goes to its nearest step, shifted along the cubic through its neighbours; cells without a reading, which must be NaN, are missing.
///
/// # Errors
/// Those of [`join`].
pub(super) fn join_on_steps(
    [first, second]: [&Table; 2],
    offset: f64,
    names: [&str; 2],
) -> Result<Joined, ImportError> {
    let mut remarks: Vec<String> = [first, second].into_iter().flat_map(|table| table.remarks.clone()).collect();
    let common = Common::new([first, second], offset, &mut remarks)?;
    let seconds = common.seconds();
    let Common { clocks, fast, part, steps } = common;
    let (dt, added) = (steps.dt, [0.0, offset]);
    let mut columns = vec![Column {
        name: first.columns[clocks[0].place].name.clone(),
        unit: Some("s".to_owned()),
        values: (0..part.len()).map(|k| steps.start + dt * k as f64).collect(),
        ..Column::default()
    }];
    for (file, table) in [first, second].into_iter().enumerate() {
        let clock = &clocks[file];
        for (place, column) in table.columns.iter().enumerate().filter(|(place, _)| *place != clock.place) {
            if column.text.is_some() || table.is_without_numbers(place) {
                remarks.push(format!("`{}` has text, or no numbers: it is left out", column.name));
                continue;
            }
            let values = if file == fast && clock.timing.is_exact() {
                clock.timing.spread(&column.values)[part.clone()].to_vec()
            } else {
                let (times, values) = known(&clock.times, &column.values, added[file]);
                steps.of(&times, &values, side_of(&times, &values))
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
    Ok(Joined { table: Table::of_columns("two clocks as one", columns, remarks), is_even })
}

/// The readings that are numbers, and their times with an offset.
pub(super) fn known(times: &[f64], values: &[f64], offset: f64) -> (Vec<f64>, Vec<f64>) {
    times.iter().zip(values).filter(|(_, value)| value.is_finite()).map(|(time, value)| (time + offset, *value)).unzip()
}
