//! A record from a file's columns.

use std::borrow::Borrow;

use kalmanscope_filters::catalogue::all_and;
use kalmanscope_filters::lists::mapped;
use kalmanscope_filters::{Channel, Hold, InputKind, Quantity};

use super::conditioning::{Conditioning, above_nyquist, cells_without_readings, fill, is_still, shift};
use super::guess::no_time;
use super::own_times::{OwnTimes, on_one_clock};
use super::shape::{counted, unwrapped};
use super::times::{Clock, Timing};
use super::{FEWEST, ImportError, MOST, MappedColumn, Mapping, Offset, Table, times};
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

/// Begins to make the record of a table's columns with the meaning that a mapping gives them, column by column. It has the truth of the
/// plant's channels too, beside [`Channel::all`], where the table has `true_…` columns of them.
pub fn building(
    table: impl Borrow<Table> + Send + 'static,
    mapping: Mapping,
    kind: InputKind,
    hold: Hold,
    truth: Vec<Channel>,
) -> Work<Result<Imported, ImportError>> {
    Work::new(async move |_| built(table.borrow(), &mapping, kind, hold, &truth).await)
}

/// As [`building`], in one go.
///
/// # Errors
/// [`ImportError`] where a setting is impossible, a column is missing or has text or infinite numbers, the times are not usable, or too
/// few samples or too many remain.
pub fn build(
    table: &Table,
    mapping: &Mapping,
    kind: InputKind,
    hold: Hold,
    truth: &[Channel],
) -> Result<Imported, ImportError> {
    at_once(built(table, mapping, kind, hold, truth))
}

async fn built(
    table: &Table,
    mapping: &Mapping,
    kind: InputKind,
    hold: Hold,
    truth: &[Channel],
) -> Result<Imported, ImportError> {
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
                None => Timing::of_rate(rate, table.rows())?,
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
    let mut sensors = Vec::new();
    for (&quantity, mapped) in &mapping.sensors {
        sensors.push((quantity, columns.sensor(mapped)?));
        pause().await;
    }
    let truth = columns.truth(truth);
    let Steps { start, dt, .. } = columns.conditioning.steps();
    let Columns { own, mut remarks, .. } = columns;
    let still = sensors.iter().find(|(_, values)| is_still(values)).map(|(quantity, _)| *quantity);
    remarks.extend(
        still.map(|quantity| {
            format!("all readings of the {} are the same: there is no motion in them", quantity.name())
        }),
    );
    let samples = values.len();
    for (quantity, values) in &sensors {
        let read = values.iter().rposition(|value| !value.is_nan()).map_or(samples, |last| last + 1);
        if 10 * read < 9 * samples {
            let ([end, all], name) = ([read, samples].map(|count| count as f64 * dt), quantity.name());
            remarks.push(format!("the {name} has no readings after {end:.2} s of {all:.2} s: is it of another clock?"));
        }
    }
    if samples < FEWEST {
        return Err(ImportError::TooShort(samples));
    }
    if samples > MOST {
        return Err(ImportError::TooLong(samples));
    }
    let mut record = Record::new(dt, Input { kind, hold, values }, sensors)?.with_truth(truth)?.starting_at(start);
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
    fn sensor(&mut self, mapped: &MappedColumn) -> Result<Vec<f64>, ImportError> {
        let values = self.mapped(mapped)?;
        Ok(match self.own.as_mut().filter(|_| self.is_kept) {
            Some(own) => own.sensor(mapped, self.conditioning.steps()),
            None => self.conditioning.sensor(values),
        })
    }

    fn input(&mut self, hold: Hold) -> Result<Vec<f64>, ImportError> {
        let Conditioning { mapping, timing } = self.conditioning;
        let steps = self.conditioning.steps();
        let Some(mapped) = &mapping.input else {
            self.remarks.push("there is no column for the input; it counts as zero".to_owned());
            return Ok(vec![0.0; steps.count]);
        };
        let mut values = self.mapped(mapped)?;
        if let Some(own) = self.own.as_mut().filter(|_| self.is_kept) {
            let Some(values) = own.input(mapped, hold, steps) else {
                self.remarks.push("the input is missing in all rows; it counts as zero".to_owned());
                return Ok(vec![0.0; steps.count]);
            };
            let count = own.empty(&mapped.column);
            if count > 0 {
                let how = if hold == Hold::Zero { "stays as it was" } else { "is interpolated" };
                self.remarks.push(format!("the input is missing in {count} row(s); it {how} there"));
            }
            return Ok(values);
        }
        if let Some((first, count)) = fill(&mut values) {
            let time = timing.start + first as f64 * timing.dt;
            self.remarks.push(format!(
                "the input is missing in {count} sample(s), the first at {time} s; it is interpolated there"
            ));
        }
        Ok(self.conditioning.input(values, hold))
    }

    /// Values at even times; empty where readings keep their times.
    fn mapped(&mut self, mapped: &MappedColumn) -> Result<Vec<f64>, ImportError> {
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

fn place(table: &Table, name: &str) -> Result<usize, ImportError> {
    let names = || mapped(&table.columns, &|column| column.name.as_str()).join(", ");
    table.place(name).ok_or_else(|| ImportError::Column(name.to_owned(), names()))
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::read;
    use super::*;

    pub(in super::super) fn import(text: &str, change: impl Fn(&mut Mapping)) -> Result<Imported, ImportError> {
        let table = read(text.as_bytes(), None)?;
        let (mut mapping, kind) = Mapping::guess(&table);
        change(&mut mapping);
        build(&table, &mapping, kind, Hold::First, &[])
    }

    pub(in super::super) const TEXT: &str = "t,force,displacement\n0,1,2\n0.1,2,3\n0.2,,4\n0.3,4,\n0.4,5,6\n";

    #[test]
    fn units_gain_offset_and_delay_are_applied() {
        let imported = import("t in ms;force;x (mm)\n0;1;5\n10;2;7\n20;3;9\n", |mapping| {
            let input = mapping.input.as_mut().unwrap();
            (input.gain, input.offset) = (-2.0, Offset::MEAN);
            mapping.sensors.get_mut(&Quantity::DISPLACEMENT).unwrap().delay = 1;
        });
        let record = imported.unwrap().record;
        assert_eq!((record.dt(), record.hold()), (0.01, Hold::First));
        assert_eq!(record.input(), [2.0, 0.0, -2.0]);
        assert!((record.measured(0)[0] - 0.007).abs() < 1e-15 && (record.measured(0)[1] - 0.009).abs() < 1e-15);
        assert!(record.measured(0)[2].is_nan());
    }

    #[test]
    fn gaps_in_the_input_are_filled_and_those_in_a_sensor_stay() {
        let Imported { record, remarks, .. } = import(TEXT, |_| {}).unwrap();
        assert_eq!(record.input(), [1.0, 2.0, 3.0, 4.0, 5.0]);
        assert!(record.measured(0)[3].is_nan());
        assert_eq!(remarks, ["the input is missing in 1 sample(s), the first at 0.2 s; it is interpolated there"]);
    }

    #[test]
    fn an_input_without_a_number_at_irregular_times_is_said_and_zero() {
        let text = "t,force,x\n0,,1\n0.1,,2\n0.25,,3\n0.31,,4\n0.5,,5\n";
        let Imported { record, remarks, .. } = import(text, |mapping| {
            mapping.input = Some(MappedColumn::new("force"));
            mapping.sensors = [(Quantity::DISPLACEMENT, MappedColumn::new("x"))].into();
        })
        .unwrap();
        assert!(record.clocks().is_some() && record.input().iter().all(|input| *input == 0.0));
        assert!(remarks.iter().any(|remark| remark.contains("missing in all rows")), "{remarks:?}");
    }

    #[test]
    fn what_cannot_be_used_is_said_with_line_and_column() {
        type Case = (&'static str, fn(&mut Mapping), &'static str);
        let cases: [Case; 9] = [
            ("t,force,x\n0,1,2\n1,2,oops\n2,3,4\n", |_| {}, "line 3, column `x`: `oops` is not a number"),
            ("t,force,x\n0,1,2\n1,2,1e999\n2,3,4\n", |_| {}, "line 3, column `x`: the number is infinite"),
            ("t,x\n0,1\n", |_| {}, "1 row(s)"),
            ("force,x\n2,1\n1,3\n", |_| {}, "the file has no column of times: state the sample rate"),
            ("time,f,x\nT+1,1,2\nT+2,3,1\n", |_| {}, "the file has no column of times: `time` has `T+1` in line 2"),
            ("t,force,x\n0,1,2\n0.1,2,3\n,2,3\n0.5,2,4\n", |_| {}, "line 4, column `t`: a time is missing: state the"),
            (TEXT, |m| m.input = Some(MappedColumn::new("load")), "there is no column `load`; the columns are t, "),
            (TEXT, |m| m.sensors.clear(), "no column is chosen for a sensor"),
            (TEXT, |m| m.from = Some(9.0), "0 row(s)"),
        ];
        for (text, change, said) in cases {
            let found = import(text, change).unwrap_err().to_string();
            assert!(found.starts_with(said), "{found}");
        }
    }

    #[test]
    fn times_without_a_unit_are_asked_about_where_they_are_slow() {
        let remarks = import("t,force,x\n0,1,2\n5,2,3\n10,1,4\n", |_| {}).unwrap().remarks;
        assert_eq!(remarks.len(), 1);
        assert!(remarks[0].contains("0.2 samples a second: are they ms?"), "{remarks:?}");
        for (first, step, unit, dt) in [
            (0.0, 10.0, "ms, 100 samples a second", 0.01),
            (3e8, 500.0, "µs, 2000 samples a second (in ms 2 a second)", 5e-4),
            (112_500_000.0, 20_000.0, "µs", 0.02),
            (1.7145648e18, 2e7, "ns since 1970", 0.02),
            (1.7145648e12, 5.0, "ms since 1970", 0.005),
            (45_413.5, 0.02 / 86_400.0, "days of a spreadsheet", 0.02),
            (739_000.25, 0.05 / 86_400.0, "days of MATLAB", 0.05),
            (2_460_431.75, 0.05 / 86_400.0, "Julian days", 0.05),
            (1.3359024e17, 1e5, "as Windows counts them", 0.01),
            (0.25, 0.02 / 86_400.0, "days of a spreadsheet", 0.02),
            (0.0, 2e-7, "5000000 samples a second: are they days?", 2e-7),
        ] {
            let rows = (0..50).map(|k| format!("{},{k},{}\n", first + step * f64::from(k), k % 7));
            let Imported { record, remarks, .. } =
                import(&("time,force,x\n".to_owned() + &rows.collect::<String>()), |_| {}).unwrap();
            assert!((record.dt() / dt - 1.0).abs() < 1e-3, "{} for {dt}: {remarks:?}", record.dt());
            assert!(remarks.iter().any(|remark| remark.contains(unit)), "{unit}: {remarks:?}");
        }
        let text = "t,force,x\n0,1,2\n10,2,3\n20,1,4\n";
        let said = import(text, |mapping| mapping.time.unit = "s".to_owned()).unwrap();
        assert_eq!((said.remarks.len(), said.record.dt()), (0, 10.0));
        assert_eq!(import(text, |mapping| mapping.time.unit = "ms".to_owned()).unwrap().record.dt(), 0.01);
        let unknown = import(text, |mapping| mapping.time.unit = "ticks".to_owned()).unwrap().remarks;
        assert!(unknown[0].contains("`ticks` is not a known unit of time"), "{unknown:?}");
    }

    #[test]
    fn a_counter_says_which_rows_are_missing_and_a_part_is_chosen_before_the_check() {
        let at_rate = |mapping: &mut Mapping| {
            (mapping.time.column, mapping.time.rate) = (None, Some(50.0));
            mapping.input = Some(MappedColumn::new("force"));
            mapping.sensors = [(Quantity::DISPLACEMENT, MappedColumn::new("x"))].into();
        };
        for count in [|k: u32| k, |k| 10 * k + 5, |k| (k + 230) % 256] {
            let rows = (0..40).filter(|k| k % 10 != 3).map(|k| format!("{},{},{}\n", count(k), k % 3, k % 7));
            let text = format!("count,force,x\n{}", rows.collect::<String>());
            let Imported { record, remarks, .. } = import(&text, at_rate).unwrap();
            assert_eq!((record.len(), record.dt()), (40, 0.02));
            assert!(record.measured(0)[3].is_nan() && record.measured(0)[4] == 4.0, "{remarks:?}");
            assert!(remarks.iter().any(|remark| remark.starts_with("`count` counts the samples")), "{remarks:?}");
        }
        let times = (0..60).map(|k| if k < 30 { f64::from(k) } else { f64::from((k * 7) % 30) });
        let rows = times.map(|time| format!("{},1,{}\n", 0.1 * time, time)).collect::<String>();
        let part = |mapping: &mut Mapping| mapping.to = Some(2.0);
        let text = format!("time,force,x\n{rows}");
        assert!(import(&text, |_| {}).is_err());
        assert_eq!(import(&text, part).unwrap().record.len(), 21);
    }

    #[test]
    fn blank_times_at_the_end_are_the_end_and_midnight_is_passed() {
        let imported = import("t,force,x\n0,1,2\n0.1,2,3\n0.2,2,4\n,3,5\n,4,\n", |_| {}).unwrap();
        assert_eq!((imported.record.len(), imported.record.input()), (3, &[1.0, 2.0, 2.0][..]));
        assert_eq!(imported.remarks, ["the times end in line 4: 2 row(s) below it are left out"]);
        let night = "when,force,x\n23:59:59.5,1,2\n23:59:59.75,2,3\n00:00:00,3,4\n00:00:00.25,4,5\n";
        let Imported { record, remarks, .. } = import(night, |_| {}).unwrap();
        assert_eq!((record.len(), record.dt()), (4, 0.25));
        assert_eq!(remarks, ["the times pass midnight in line 4"]);
    }

    #[test]
    fn the_truth_of_a_simulated_record_comes_along() {
        let text = "t,force,displacement,true_velocity\n0,1,2,5\n1,2,3,6\n2,1,2,7\n";
        let record = import(text, |_| {}).unwrap().record;
        assert_eq!(record.truth(Channel::VELOCITY), Some(&[5.0, 6.0, 7.0][..]));
    }
}
