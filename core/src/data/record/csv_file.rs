//! Records as CSV files: `t, force`, a column per sensor, and `true_…` columns where the truth is known.

use std::io::{Read, Write};

use super::{Clocks, Input, Record, RecordError, Timed};
use crate::mathematics::catalogue::all_and;
use crate::mathematics::lists::numbers;
use crate::{Channel, Hold, InputKind, PlantKind, Quantity};

impl Record {
    /// Reads a CSV file with a header. Requires the columns `t`, `force` (or `ground_acceleration`) and one for each of
    /// `sensors`. Reads `true_displacement` and similar columns as the truth, of [`Channel::all`] and of a plant, and ignores other
    /// columns and lines that begin with `#`. An empty cell or `nan` is a missing measurement.
    ///
    /// # Errors
    /// [`RecordError`] with the line and column at fault.
    pub fn read_csv(input: impl Read, sensors: &[Quantity], plant: &PlantKind) -> Result<Self, RecordError> {
        let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).from_reader(input);
        let header = reader.headers()?.clone();
        let find = |name: &str| header.iter().position(|h| h == name);
        let need = |name: &str| {
            let names = || header.iter().collect::<Vec<_>>().join(", ");
            find(name).ok_or_else(|| RecordError::Column(name.to_owned(), names()))
        };
        let time_column = need("t")?;
        let (kind, input_column) = match find(input_name(InputKind::GroundAcceleration)) {
            Some(place) if find(input_name(InputKind::Force)).is_none() => (InputKind::GroundAcceleration, place),
            _ => (InputKind::Force, need(input_name(InputKind::Force))?),
        };
        let sensor_columns = sensors.iter().map(|s| need(s.key())).collect::<Result<Vec<_>, _>>()?;
        let of_truth = |channel: Channel| Some((channel, find(&format!("true_{}", channel.key()))?));
        let (truth_channels, truth_columns): (Vec<Channel>, Vec<usize>) =
            all_and(plant.channels().iter().copied()).into_iter().filter_map(of_truth).unzip();

        let mut times = Vec::new();
        let mut input = Vec::new();
        let mut measured = vec![Vec::new(); sensor_columns.len()];
        let mut truth = vec![Vec::new(); truth_columns.len()];
        for row in reader.records() {
            let row = row?;
            let line = row.position().map_or(0, csv::Position::line);
            let cell = |column: usize, may_be_missing: bool| {
                let text = row.get(column).unwrap_or_default();
                let number = if text.is_empty() { Some(f64::NAN) } else { text.parse().ok() };
                let number = number.filter(|x: &f64| x.is_finite() || (may_be_missing && x.is_nan()));
                let allowed = if may_be_missing { "a number, `nan` or empty" } else { "a finite number" };
                number.ok_or_else(|| RecordError::Cell(line, header[column].to_owned(), text.to_owned(), allowed))
            };
            times.push((line, cell(time_column, false)?));
            let optional = [(&mut measured, &sensor_columns), (&mut truth, &truth_columns)];
            for (values, &column) in optional.into_iter().flat_map(|(values, columns)| values.iter_mut().zip(columns)) {
                values.push(cell(column, true)?);
            }
            input.push(cell(input_column, false)?);
        }
        let (start, dt) = spacing(&times)?;
        let input = Input { kind, hold: Hold::Zero, values: input };
        let measured = sensors.iter().copied().zip(measured).collect();
        Ok(Self::new(dt, input, measured)?
            .with_truth(truth_channels.into_iter().zip(truth).collect())?
            .starting_at(start))
    }

    /// Writes a file that [`Self::read_csv`] reads back bit by bit, with 17 significant digits. Of a record with the times
    /// of readings it is one with a column of times before each of its columns, without the truth, for a
    /// [`Builder`](crate::import::Builder).
    ///
    /// # Errors
    /// [`RecordError::Csv`] where `output` cannot be written.
    pub fn write_csv(&self, output: impl Write) -> Result<(), RecordError> {
        let mut writer = csv::Writer::from_writer(output);
        if let Some(clocks) = self.clocks() {
            return self.write_clocks(clocks, &mut writer);
        }
        let sensors = self.sensors.iter().map(|s| s.key().to_owned());
        let truth = self.truth_channels.iter().map(|c| format!("true_{}", c.key()));
        writer
            .write_record(["t".to_owned(), input_name(self.kind).to_owned()].into_iter().chain(sensors).chain(truth))?;
        for k in 0..self.len() {
            let columns = self.measured.iter().chain(&self.truth).map(|column| column[k]);
            let row = [self.time(k), self.input[k]].into_iter().chain(columns);
            writer.write_record(row.map(digits))?;
        }
        writer.flush().map_err(csv::Error::from)?;
        Ok(())
    }

    fn write_clocks(&self, clocks: &Clocks, writer: &mut csv::Writer<impl Write>) -> Result<(), RecordError> {
        let of_samples = || Timed { times: numbers(self.len(), &|k| k as f64), values: self.input.clone() };
        let input = clocks.input.clone().unwrap_or_else(of_samples);
        let all: Vec<&Timed> = std::iter::once(&input).chain(&clocks.readings).collect();
        let names = std::iter::once(input_name(self.kind)).chain(self.sensors.iter().map(|sensor| sensor.key()));
        let header = names.enumerate().flat_map(|(place, name)| {
            let time = if place == 0 { "t [s]".to_owned() } else { format!("t ({}) [s]", place + 1) };
            [time, name.to_owned()]
        });
        writer.write_record(header)?;
        for row in 0..all.iter().map(|timed| timed.times.len()).max().unwrap_or(0) {
            let pair = |timed: &&Timed| match (timed.times.get(row), timed.values.get(row)) {
                (Some(steps), Some(value)) => [self.time(0) + steps * self.dt, *value],
                _ => [f64::NAN; 2],
            };
            writer.write_record(all.iter().flat_map(pair).map(digits))?;
        }
        writer.flush().map_err(csv::Error::from)?;
        Ok(())
    }
}

fn digits(value: f64) -> String {
    if value.is_nan() { String::new() } else { format!("{value:.16e}") }
}

pub(crate) fn input_name(kind: InputKind) -> &'static str {
    match kind {
        InputKind::Force => "force",
        InputKind::GroundAcceleration => "ground_acceleration",
    }
}

/// The times are checked to a hundredth of the step.
fn spacing(times: &[(u64, f64)]) -> Result<(f64, f64), RecordError> {
    let [(_, first), .., (_, last)] = *times else {
        return Err(RecordError::TooShort(times.len()));
    };
    if last <= first {
        return Err(RecordError::NotRising(first, last));
    }
    // The mean step is rounded, but the `dt` of a file written by `write_csv` must be exact.
    let step = times[1].1 - first;
    let exact = times.iter().enumerate().all(|(k, &(_, time))| time == first + k as f64 * step);
    let dt = if exact { step } else { (last - first) / (times.len() - 1) as f64 };
    for (k, &(line, found)) in times.iter().enumerate() {
        let expected = first + k as f64 * dt;
        // The comparison also fails where the step has overflowed.
        let off = (found - expected).abs();
        if off.is_nan() || off > 0.01 * dt {
            return Err(RecordError::Spacing(line, found, expected, dt));
        }
    }
    Ok((first, dt))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SENSORS: [Quantity; 1] = [Quantity::VELOCITY];

    fn message(text: &str) -> String {
        Record::read_csv(text.as_bytes(), &SENSORS, &PlantKind::SDOF).unwrap_err().to_string()
    }

    #[test]
    fn columns_are_found_by_name_and_missing_measurements_are_nan() {
        let text = "velocity,force,t,true_velocity\n# a remark\n1,2,0.5,0.9\n,3,1.0,1\nnan,4,1.5,1.1\n";
        let record = Record::read_csv(text.as_bytes(), &SENSORS, &PlantKind::SDOF).unwrap();
        assert_eq!((record.dt(), record.time(2), record.input()), (0.5, 1.5, &[2.0, 3.0, 4.0][..]));
        assert_eq!(record.measured(0)[0], 1.0);
        assert!(record.measured(0)[1].is_nan() && record.measured(0)[2].is_nan());
        assert_eq!(record.truth(Channel::VELOCITY), Some(&[0.9, 1.0, 1.1][..]));
        assert_eq!(record.truth(Channel::DISPLACEMENT), None);
    }

    #[test]
    fn every_bit_survives_a_file() {
        let text = "t,force,velocity\n0,0.1,0.30000000000000004\n0.01,-1e-300,\n";
        let record = Record::read_csv(text.as_bytes(), &SENSORS, &PlantKind::SDOF).unwrap();
        let mut file = Vec::new();
        record.write_csv(&mut file).unwrap();
        let again = Record::read_csv(file.as_slice(), &SENSORS, &PlantKind::SDOF).unwrap();
        assert_eq!(again.measured(0)[0].to_bits(), 0.300_000_000_000_000_04_f64.to_bits());
        assert!(again.measured(0)[1].is_nan());
        assert_eq!(again.input(), record.input());
    }

    #[test]
    fn errors_say_where_and_what_is_allowed() {
        let missing = message("t,velocity\n0,1\n1,1\n");
        assert_eq!(missing, "line 1: there is no column `force`; the columns are t, velocity");
        let cell = message("t,force,velocity\n0,1,2\n1,oops,2\n");
        assert_eq!(cell, "line 3, column `force`: `oops` is not a finite number");
        let infinite = message("t,force,velocity\n0,1,inf\n1,1,2\n");
        assert_eq!(infinite, "line 2, column `velocity`: `inf` is not a number, `nan` or empty");
        let gap = message("t,force,velocity\n0,1,2\n1,1,2\n3,1,2\n");
        assert!(gap.starts_with("line 3: t = 1 s, but samples 1.5 s apart"), "{gap}");
        assert_eq!(message("t,force,velocity\n0,1,2\n"), "1 sample(s), but at least 2 are needed");
        assert!(message("t,force,velocity\n0,1,2\n0,1,2\n").starts_with("t must rise"));
        let endless = message("t,force,velocity\n-1e308,1,2\n1e308,1,2\n");
        assert!(endless.starts_with("line 2: t = -1"), "{endless}");
        assert!(message("t,force,velocity\n0,1\n").contains("line"), "{}", message("t,force,velocity\n0,1\n"));
    }
}
