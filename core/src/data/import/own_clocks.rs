//! A file in which columns have times of their own: `t1, force, t2, displacement`.

use super::files::{Joined, join_on_steps};
use super::limits::FEWEST;
use super::own_times::{OwnTimes, times_of};
use super::role::is_named_time;
use super::{Column, ImportError, MappedColumn, Mapping, Table, Time, times};

/// Two clocks that differ by less than this share of a step tell the same times.
const SAME: f64 = 1e-3;

/// Clocks that differ by a larger factor have other units.
const UNITS: f64 = 10.0;

/// The places of the columns of times that have columns of numbers of their own behind them; two or more, or none.
pub(super) fn clocks(table: &Table) -> Vec<usize> {
    let is_clock = |place: usize| is_named_time(&table.columns[place]) && rises(table, place).is_some();
    let named: Vec<usize> = (0..table.columns.len()).filter(|place| is_clock(*place)).collect();
    let has_numbers = |(nth, place): (usize, usize)| {
        let end = named.get(nth + 1).copied().unwrap_or(table.columns.len());
        (place + 1..end).any(|column| !table.is_without_numbers(column)).then_some(place)
    };
    let found: Vec<usize> = named.iter().copied().enumerate().filter_map(has_numbers).collect();
    if found.len() > 1 { found } else { Vec::new() }
}

/// The times of a column \[s\], if they rise.
fn rises(table: &Table, place: usize) -> Option<Vec<f64>> {
    let column = &table.columns[place];
    let times = times::of(table, column, column.unit.as_deref().unwrap_or_default(), &mut Vec::new());
    let is_clock = column.text.is_none() && times.len() >= FEWEST && times.windows(2).all(|pair| pair[1] > pair[0]);
    is_clock.then(|| times.into_owned())
}

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
    for (clock, columns) in &parts {
        let times = of_part(table, mapping, *clock);
        for (_, mapped) in columns {
            own.add(table, &mapped.column, &times, mapped.missing);
        }
    }
    let all: Vec<String> = parts.iter().map(|(clock, _)| format!("`{}`", table.columns[*clock].name)).collect();
    let mut is_even = true;
    let mut names = parts.iter().map(|(clock, _)| format!("the clock `{}`", table.columns[*clock].name));
    let mut tables = parts.iter().map(|(clock, columns)| part(table, mapping, *clock, columns));
    let (Some(mut whole), Some(mut name)) = (tables.next(), names.next()) else { return Ok(None) };
    for (other, other_name) in tables.zip(names) {
        match join_on_steps([&whole, &other], 0.0, [&name, &other_name]) {
            Ok(Joined { table, is_even: is, .. }) => (whole, is_even) = (table, is_even && is),
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

/// The times of a clock \[s\].
fn of_part(table: &Table, mapping: &Mapping, clock: usize) -> Vec<f64> {
    let column = &table.columns[clock];
    let is_stated = mapping.time.column.as_deref() == Some(&column.name) && !mapping.time.unit.is_empty();
    let unit = if is_stated { &mapping.time.unit } else { column.unit.as_deref().unwrap_or_default() };
    times_of(table, &column.name, unit)
}

/// A clock with its columns, in which cells without a reading are empty.
fn part(table: &Table, mapping: &Mapping, clock: usize, columns: &[(usize, &MappedColumn)]) -> Table {
    let mut time = table.columns[clock].clone();
    if mapping.time.column.as_deref() == Some(&time.name) && !mapping.time.unit.is_empty() {
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

#[cfg(test)]
mod tests {
    use std::fmt::Write as _;

    use super::super::{Builder, read};
    use super::*;
    use crate::{Hold, Quantity};

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

    fn import(text: &str) -> (crate::Record, Vec<String>) {
        let table = read(text.as_bytes(), None).unwrap();
        let (mapping, kind) = Mapping::guess(&table);
        let imported = Builder::new(&table, &mapping, kind, Hold::First).unwrap().finish().unwrap();
        (imported.record, imported.remarks)
    }

    #[test]
    fn columns_with_times_of_their_own_are_at_their_times() {
        let (record, remarks) = import(&text(0.2));
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
            let (record, remarks) = import(text);
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
        let (record, remarks) = import(text);
        assert_eq!((record.dt(), record.measured(0)), (0.1, &[2.0, 3.0, 4.0, 5.0, 3.0][..]));
        assert!(remarks[0].contains("`t` and the clock `stamp` have no time in common"), "{remarks:?}");
    }
}
