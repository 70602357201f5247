//! Input and readings of a scenario in lines that come one by one.

use kalmanscope_core::document::{self, Document};
use kalmanscope_core::import::{self, Dimension, turn};
use kalmanscope_core::{InputKind, Scenario};

use crate::line::{BadLine, StreamLine, number, number_of};

/// The time, the input and the readings of a line.
#[derive(Clone, Debug, PartialEq)]
pub struct StreamRow {
    /// \[s\]
    pub time: f64,
    /// The input in the scenario's meaning \[m/s²\]; NaN if it is not known.
    pub input: f64,
    /// A reading for each sensor of the scenario in the unit of its quantity, NaN where there is none.
    pub readings: Vec<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum LineColumn {
    /// With the seconds of its unit, if the header has one.
    Time(Option<f64>),
    Input,
    Sensor(usize),
    Other,
}

/// Reads the lines of a stream: columns under a header, or JSON objects.
#[derive(Clone, Debug)]
pub struct LineReader {
    /// The names of input and sensors.
    input: &'static str,
    sensors: Vec<&'static str>,
    /// The columns, once a header has named them, and the mark between them.
    columns: Option<(Vec<LineColumn>, char)>,
    clock: LineClock,
}

/// The times of the lines before, in the unit of the lines.
#[derive(Clone, Debug)]
struct LineClock {
    dt: f64,
    last: f64,
    step: f64,
    /// What a counter that turned over has lost.
    added: f64,
    is_asked: bool,
}

/// Steps of so many steps of the scenario are asked about; in their true unit they are at most this many.
const ODD: f64 = 500.0;
const USUAL: std::ops::Range<f64> = 0.02..50.0;

/// A step of so many steps of the scenario or more is no usual one.
const FAR: f64 = 1e10;

impl LineClock {
    /// The time \[s\] of a line, whose counter may have turned over.
    fn time(&mut self, time: f64, unit: Option<f64>) -> Result<f64, BadLine> {
        let (step, is_usual) = (time - self.last, self.step > 0.0 && self.step <= ODD * self.dt);
        match turn(self.last, time, self.step) {
            Some(range) => self.added += range,
            // The first time may be that of a clock that was not set.
            // It falls by a tenth at most: after a burst a turned counter must still lie within five of these steps.
            None if step > 0.0 && step * unit.unwrap_or(1.0) < FAR * self.dt => self.step = step.max(0.9 * self.step),
            None => {}
        }
        self.last = time;
        let steps = step / self.dt;
        let units = [("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)];
        let likely = || units.into_iter().find(|(_, size)| USUAL.contains(&(steps * size)));
        if unit.is_none()
            && !self.is_asked
            && !is_usual
            && steps > ODD
            && let Some((unit, _)) = likely()
        {
            self.is_asked = true;
            return Err(BadLine::Unit { column: "t".to_owned(), step, steps, unit });
        }
        Ok((time + self.added) * unit.unwrap_or(1.0))
    }
}

impl LineReader {
    /// The lines for the input and the sensors of a scenario.
    pub fn new(scenario: &Scenario) -> Self {
        let input = match scenario.input {
            InputKind::Force => "force",
            InputKind::GroundAcceleration => "ground_acceleration",
        };
        let sensors = scenario.sensors.iter().map(|sensor| sensor.measures.key()).collect();
        let clock = LineClock { dt: scenario.dt, last: f64::NAN, step: 0.0, added: 0.0, is_asked: false };
        Self { input, sensors, columns: None, clock }
    }

    /// The row of a line; `None` for an empty line, a comment and a header.
    ///
    /// # Errors
    /// [`BadLine`]; later lines can still be read.
    pub fn read(&mut self, bytes: &[u8]) -> Result<Option<StreamRow>, BadLine> {
        match StreamLine::of(bytes, self.columns.as_ref().map(|(_, mark)| *mark))? {
            StreamLine::Nothing => Ok(None),
            StreamLine::Object(entries) => self.of_object(&entries).map(Some),
            StreamLine::Cells(cells, mark) => self.of_cells(&cells, mark),
        }
    }

    fn at_its_time(&mut self, row: StreamRow, unit: Option<f64>) -> Result<StreamRow, BadLine> {
        if row.time.is_nan() {
            Err(BadLine::NoTime(self.known()))
        } else {
            Ok(StreamRow { time: self.clock.time(row.time, unit)?, ..row })
        }
    }

    /// The columns that are known, the time first.
    pub fn columns(&self) -> Vec<&'static str> {
        [&["t", self.input][..], &self.sensors].concat()
    }

    fn known(&self) -> String {
        self.columns().join(", ")
    }

    fn column(&self, name: &str) -> LineColumn {
        let header = import::Column::of_header(name, None, Vec::new());
        match header.name.as_str() {
            "t" | "time" => LineColumn::Time(match import::unit(header.unit.as_deref().unwrap_or_default()) {
                Some((Dimension::Time, size)) => Some(size),
                _ => None,
            }),
            _ => self.value_column(name),
        }
    }

    fn value_column(&self, name: &str) -> LineColumn {
        match name {
            name if name == "input" || name == self.input => LineColumn::Input,
            name => self.sensors.iter().position(|one| *one == name).map_or(LineColumn::Other, LineColumn::Sensor),
        }
    }

    fn nothing(&self) -> StreamRow {
        StreamRow { time: f64::NAN, input: f64::NAN, readings: vec![f64::NAN; self.sensors.len()] }
    }

    fn of_object(&mut self, entries: &[(String, Document)]) -> Result<StreamRow, BadLine> {
        let (mut row, mut unit) = (self.nothing(), None);
        for (key, value) in entries {
            let bad = || BadLine::NoNumber { key: key.clone(), value: document::to_json(value).unwrap_or_default() };
            let column = self.column(key);
            row.set(column, || number_of(value).ok_or_else(bad))?;
            unit = if let LineColumn::Time(unit) = column { unit } else { unit };
        }
        self.at_its_time(row, unit)
    }

    fn of_cells(&mut self, cells: &[&str], mark: char) -> Result<Option<StreamRow>, BadLine> {
        let Some((columns, _)) = &self.columns else {
            let columns: Vec<LineColumn> = cells.iter().map(|name| self.column(name)).collect();
            if !columns.iter().any(|column| matches!(column, LineColumn::Time(_))) {
                return Err(BadLine::NoTime(self.known().replace(", ", ",")));
            }
            if !columns.iter().any(|column| matches!(column, LineColumn::Input | LineColumn::Sensor(_))) {
                return Err(BadLine::NothingKnown(self.known()));
            }
            self.columns = Some((columns, mark));
            return Ok(None);
        };
        // Some devices end every row with a mark.
        let cells = match cells.split_last() {
            Some((&"", rest)) if rest.len() == columns.len() => rest,
            _ => cells,
        };
        if cells.len() != columns.len() {
            return Err(BadLine::Cells { found: cells.len(), expected: columns.len() });
        }
        let (mut row, mut unit) = (self.nothing(), None);
        for (cell, column) in cells.iter().zip(columns) {
            unit = if let LineColumn::Time(unit) = column { *unit } else { unit };
            let bad = || BadLine::NoNumber { key: self.name(*column), value: format!("“{cell}”") };
            let value = || if cell.is_empty() { Ok(f64::NAN) } else { number(cell, mark).ok_or_else(bad) };
            row.set(*column, value)?;
        }
        // A line without a time is refused where it is used.
        if row.time.is_nan() { Ok(Some(row)) } else { self.at_its_time(row, unit).map(Some) }
    }

    fn name(&self, column: LineColumn) -> String {
        match column {
            LineColumn::Time(_) => "t",
            LineColumn::Input => self.input,
            LineColumn::Sensor(sensor) => self.sensors[sensor],
            LineColumn::Other => "",
        }
        .to_owned()
    }
}

impl StreamRow {
    /// Sets the number of a column; other columns are not read.
    fn set(&mut self, column: LineColumn, number: impl FnOnce() -> Result<f64, BadLine>) -> Result<(), BadLine> {
        match column {
            LineColumn::Time(_) => self.time = number()?,
            LineColumn::Input => self.input = number()?,
            LineColumn::Sensor(sensor) => self.readings[sensor] = number()?,
            LineColumn::Other => {}
        }
        Ok(())
    }
}
