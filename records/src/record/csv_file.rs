//! Records as CSV files: `t, force`, a column per sensor, and `true_…` columns where the truth is known.

use std::io::Write;

use kalmanscope_filters::InputKind;
use kalmanscope_filters::lists::numbers;

use super::{Clocks, Record, RecordError, Timed};

impl Record {
    /// Writes a file that a [`build`](crate::import::build) reads back bit by bit, with 17 significant digits. Of a record
    /// with the times of readings it is one with a column of times before each of its columns, without the truth.
    ///
    /// # Errors
    /// [`RecordError::Csv`] where `output` cannot be written.
    pub fn write_csv(&self, output: impl Write) -> Result<(), RecordError> {
        let mut writer = csv::Writer::from_writer(output);
        match self.clocks() {
            Some(clocks) => self.write_clocks(clocks, &mut writer)?,
            None => self.write_samples(&mut writer)?,
        }
        Ok(writer.flush().map_err(csv::Error::from)?)
    }

    fn write_samples(&self, writer: &mut csv::Writer<impl Write>) -> Result<(), csv::Error> {
        let sensors = self.sensors.iter().map(|s| s.key().to_owned());
        let truth = self.truth_channels.iter().map(|c| format!("true_{}", c.key()));
        writer
            .write_record(["t".to_owned(), input_name(self.kind).to_owned()].into_iter().chain(sensors).chain(truth))?;
        for k in 0..self.len() {
            let columns = self.measured.iter().chain(&self.truth).map(|column| column[k]);
            let row = [self.time(k), self.input[k]].into_iter().chain(columns);
            writer.write_record(row.map(digits))?;
        }
        Ok(())
    }

    fn write_clocks(&self, clocks: &Clocks, writer: &mut csv::Writer<impl Write>) -> Result<(), csv::Error> {
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
