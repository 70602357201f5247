//! A record from a file's columns.

use std::borrow::Borrow;

use kalmanscope_filters::catalogue::all_and;
use kalmanscope_filters::lists::mapped;
use kalmanscope_filters::{Channel, Hold, InputKind, Quantity};

use super::conditioning::{Conditioning, above_nyquist, cells_without_readings, fill, is_still, shift};
use super::guess::no_time;
use super::header::{Dimension, unit};
use super::own_times::{OwnTimes, on_one_clock};
use super::shape::{counted, unwrapped};
use super::times::{Clock, Timing};
use super::{FEWEST, ImportError, MOST, MappedColumn, Mapping, Offset, Result, Table, times};
use crate::Record;
use crate::record::Input;
use crate::resample::{Steps, mean};
use crate::task::{Work, at_once, pause};

/// A record from a file, with sentences about its making.
#[derive(Clone, Debug)]
pub struct Imported {
    /// The record.
    pub record: Record,
    /// Sentences about its making that a user should know.
    pub remarks: Vec<String>,
    /// A sensor with equal readings, or without any: there is no motion to filter.
    pub still: Option<Quantity>,
}

/// Begins to make the record of a table's columns by a mapping, with the truth of [`Channel::all`] and of `truth` where it has some.
pub fn building(
    table: impl Borrow<Table> + Send + 'static,
    mapping: Mapping,
    kind: InputKind,
    hold: Hold,
    truth: Vec<Channel>,
) -> Work<Result<Imported>> {
    Work::new(async move |_| built(table.borrow(), &mapping, kind, hold, &truth).await)
}

/// As [`building`], in one go.
///
/// # Errors
/// [`ImportError`] where a setting is impossible, a column is missing or has text or infinite numbers, the times are not usable, or too
/// few samples or too many remain.
pub fn build(table: &Table, mapping: &Mapping, kind: InputKind, hold: Hold, truth: &[Channel]) -> Result<Imported> {
    at_once(built(table, mapping, kind, hold, truth))
}

async fn built(table: &Table, mapping: &Mapping, kind: InputKind, hold: Hold, truth: &[Channel]) -> Result<Imported> {
    mapping.validate()?;
    if mapping.sensors.is_empty() {
        return Err(ImportError::NoSensor);
    }
    let mut remarks = table.remarks.clone();
    let whole = unwrapped(table, mapping, &mut remarks);
    let table = whole.as_ref().unwrap_or(table);
    let clocks = on_one_clock(table, mapping, &mut remarks)?;
    // A part is chosen before the times are checked, so that it can leave out a fault of the clock.
    let part = if clocks.is_none() { part_of(table, mapping) } else { None };
    let table = part.as_ref().unwrap_or(table);
    let (mut own, mut is_even, is_kept) = (None, true, !mapping.needs_even_steps());
    let mut timing = match (&mapping.time.column, mapping.time.rate) {
        _ if let Some(clocks) = clocks => {
            (own, is_even) = (Some(clocks.own), clocks.is_even || !is_kept);
            clocks.timing
        }
        (Some(name), _) => {
            let Clock { times, timing, .. } = Clock::of(table, place(table, name)?, &mapping.time.unit, &mut remarks)?;
            if !timing.is_even() && is_kept {
                own = Some(OwnTimes::of_rows(table, mapping, &times));
                is_even = false;
                remarks.push(timing.kept());
            }
            timing
        }
        (None, Some(rate)) => {
            remarks.extend((table.rate == Some(rate)).then(|| format!("the file says {rate} samples a second")));
            match counted(table, mapping, rate) {
                Some((name, times)) => {
                    remarks.push(format!("`{name}` counts the samples: numbers that it skips are missing rows"));
                    Timing::of_times(&times, &name, |row| table.line(row))?
                }
                None if table.rows() < FEWEST => return Err(ImportError::TooShort(table.rows())),
                None => Timing::of_steps(Steps { start: 0.0, dt: 1.0 / rate, count: table.rows() }),
            }
        }
        (None, None) => return Err(no_time(table)),
    };
    remarks.extend(timing.gaps.clone());
    if own.is_none() {
        remarks.extend(timing.remark.clone());
    }
    if let Some(dt) = mapping.time.dt.filter(|_| own.is_some() && is_kept) {
        timing = timing.at_steps(dt)?;
    } else if !is_even {
        // A reading that comes too early or too late by less than half a step is the only one in its step.
        timing.start += 0.5 * timing.dt;
    }
    remarks.extend(above_nyquist(mapping.band, 0.5 / timing.dt)?);
    let mut columns = Columns { table, conditioning: Conditioning { mapping, timing: &timing }, own, is_kept, remarks };
    let values = columns.input(hold)?;
    pause().await;
    let mut forces = Vec::new();
    for (&on, mapped) in &mapping.forces {
        forces.push((on, columns.force(&on.name(), mapped, hold, false)?));
    }
    let mut sensors = Vec::new();
    for (&quantity, mapped) in &mapping.sensors {
        sensors.push((quantity, columns.sensor(mapped)?));
        pause().await;
    }
    let truth = columns.truth(truth);
    let Steps { start, dt, .. } = columns.conditioning.steps();
    let Columns { own, mut remarks, .. } = columns;
    let still = sensors.iter().find(|(_, values)| is_still(values)).map(|(quantity, _)| *quantity);
    let said = |of: Quantity| format!("all readings of the {} are the same: there is no motion in them", of.name());
    remarks.extend(still.map(said));
    let samples = values.len();
    for (quantity, values) in &sensors {
        let read = values.iter().rposition(|value| !value.is_nan()).map_or(samples, |last| last + 1);
        if 10 * read < 9 * samples {
            let ([end, all], name) = ([read, samples].map(|count| count as f64 * dt), quantity.name());
            remarks.push(format!("the {name} has no readings after {end:.2} s of {all:.2} s: is it of another clock?"));
        }
    }
    match samples {
        ..FEWEST => return Err(ImportError::TooShort(samples)),
        FEWEST..=MOST => {}
        _ => return Err(ImportError::TooLong(samples)),
    }
    let record = Record::new(dt, Input { kind, hold, values }, sensors)?.with_truth(truth)?;
    let mut record = record.with_forces(forces)?.starting_at(start);
    if let Some(own) = own.filter(|_| is_kept) {
        record = record.with_clocks(own.clocks)?;
    }
    Ok(Imported { record, remarks, still })
}

struct Columns<'a> {
    table: &'a Table,
    conditioning: Conditioning<'a>,
    own: Option<OwnTimes>,
    /// Whether the readings may keep their times.
    is_kept: bool,
    remarks: Vec<String>,
}

impl Columns<'_> {
    fn sensor(&mut self, mapped: &MappedColumn) -> Result<Vec<f64>> {
        let values = self.mapped(mapped)?;
        Ok(match self.own.as_mut().filter(|_| self.is_kept) {
            Some(own) => own.sensor(mapped, self.conditioning.steps()),
            None => self.conditioning.sensor(values),
        })
    }

    fn input(&mut self, hold: Hold) -> Result<Vec<f64>> {
        let Some(mapped) = &self.conditioning.mapping.input else {
            if self.conditioning.mapping.forces.is_empty() {
                self.remarks.push("there is no column for the input; it counts as zero".to_owned());
            }
            return Ok(vec![0.0; self.conditioning.steps().count]);
        };
        self.force("input", mapped, hold, true)
    }

    /// The times of one that `keeps` them are the record's.
    fn force(&mut self, name: &str, mapped: &MappedColumn, hold: Hold, keeps: bool) -> Result<Vec<f64>> {
        let (timing, steps) = (self.conditioning.timing, self.conditioning.steps());
        let mut values = self.mapped(mapped)?;
        // The input's mass is found with its gain.
        if !keeps && mapped.gain == 1.0 && matches!(unit(&mapped.unit), Some((Dimension::Force, _))) {
            self.remarks
                .push(format!("the {name} is taken for a force over mass: give 1 / mass as the gain of its column"));
        }
        if let Some(own) = self.own.as_mut().filter(|_| self.is_kept) {
            let values = if keeps { own.input(mapped, hold, steps) } else { own.force(mapped, hold, steps) };
            let Some(values) = values else {
                self.remarks.push(format!("the {name} is missing in all rows; it counts as zero"));
                return Ok(vec![0.0; steps.count]);
            };
            let count = own.empty(&mapped.column);
            if count > 0 {
                let how = if hold == Hold::Zero { "stays as it was" } else { "is interpolated" };
                self.remarks.push(format!("the {name} is missing in {count} row(s); it {how} there"));
            }
            if !keeps {
                self.remarks.push(format!("the {name} counts at the samples, not at times of its own"));
            }
            return Ok(values);
        }
        if let Some((first, count)) = fill(&mut values) {
            let time = timing.start + first as f64 * timing.dt;
            let said =
                format!("the {name} is missing in {count} sample(s), the first at {time} s; it is interpolated there");
            self.remarks.push(said);
        }
        Ok(self.conditioning.input(values, hold))
    }

    /// Values at even times; empty where readings keep their times.
    fn mapped(&mut self, mapped: &MappedColumn) -> Result<Vec<f64>> {
        let (table, Conditioning { timing, .. }) = (self.table, self.conditioning);
        let column_place = place(table, &mapped.column)?;
        let column = table.columns[column_place].without_text()?;
        if let Some(row) = column.values.iter().position(|value| value.is_infinite()) {
            let (line, problem) = (table.line(row), "the number is infinite".to_owned());
            return Err(ImportError::Cell(line, column.name.clone(), problem));
        }
        self.remarks.extend(cells_without_readings(table, column_place, mapped));
        if self.own.is_some() && self.is_kept {
            return Ok(Vec::new());
        }
        let without = |missing: f64| column.values.iter().map(|&x| if x == missing { f64::NAN } else { x }).collect();
        let cells: Option<Vec<f64>> = mapped.missing.map(without);
        let Timing { start, dt, samples: count, .. } = *timing;
        let mut values = match &self.own {
            Some(own) => own.at_steps(&mapped.column, Steps { start, dt, count }),
            None => timing.spread(cells.as_ref().unwrap_or(&column.values)),
        };
        let offset = match mapped.offset {
            Offset::Number(number) => number,
            Offset::Mean(_) => mean(&values[self.conditioning.part()]),
            Offset::Part { mean: [from, to] } => {
                let place = |time: f64| libm::round((time - start) / dt).clamp(0.0, values.len() as f64) as usize;
                mean(&values[place(from)..place(to).max(place(from))])
            }
        };
        let factor = mapped.factor();
        if factor != 1.0 || offset != 0.0 {
            values.iter_mut().for_each(|value| *value = factor * (*value - offset));
        }
        shift(&mut values, mapped.delay);
        Ok(values)
    }

    fn truth(&self, truth: &[Channel]) -> Vec<(Channel, Vec<f64>)> {
        let Conditioning { mapping, timing } = self.conditioning;
        if mapping.every > 1 || mapping.interpolate > 1 {
            return Vec::new();
        }
        let of = |channel: &Channel| {
            let column = &self.table.columns[self.table.place(&format!("true_{}", channel.key()))?];
            if let Some(own) = &self.own {
                return Some((*channel, own.truth(&column.name, self.conditioning.steps())?));
            }
            let mut values = timing.spread(&column.values);
            self.conditioning.cut(&mut values);
            Some((*channel, values))
        };
        all_and(truth.iter().copied()).iter().filter_map(of).collect()
    }
}

fn part_of(table: &Table, mapping: &Mapping) -> Option<Table> {
    let ends = [mapping.from.unwrap_or(f64::NEG_INFINITY), mapping.to.unwrap_or(f64::INFINITY)];
    let column = &table.columns[table.place(mapping.time.column.as_ref()?)?];
    let times = times::of(table, column, &mapping.time.unit, &mut Vec::new());
    if (mapping.from.is_none() && mapping.to.is_none()) || times.is_sorted_by(|a, b| a < b) {
        return None;
    }
    let first = times.iter().position(|time| *time >= ends[0])?;
    let end = first + times[first..].iter().position(|time| *time > ends[1]).unwrap_or(times.len() - first);
    Some(table.of_rows((first..end).map(|row| vec![row])))
}

fn place(table: &Table, name: &str) -> Result<usize> {
    let names = || mapped(&table.columns, &|column| column.name.as_str()).join(", ");
    table.place(name).ok_or_else(|| ImportError::Column(name.to_owned(), names()))
}
