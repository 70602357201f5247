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
    /// The scenario's \[s\].
    dt: f64,
    last: f64,
    step: f64,
    /// What a counter that turned over has lost.
    added: f64,
    /// Whether the unit has been asked about.
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

#[cfg(test)]
mod tests {
    use super::*;

    fn lines() -> LineReader {
        LineReader::new(&Scenario::default())
    }

    fn numbers(row: Result<Option<StreamRow>, BadLine>) -> Vec<Option<f64>> {
        let StreamRow { time, input, readings } = row.expect("it can be read").expect("it has numbers");
        [time, input].into_iter().chain(readings).map(|x| (!x.is_nan()).then_some(x)).collect()
    }

    #[test]
    fn cells_stand_under_their_header_in_any_order() {
        let mut lines = lines();
        assert_eq!(lines.read("\u{feff}# a comment".as_bytes()), Ok(None));
        assert_eq!(lines.read(b"note;velocity;t;force\r\n"), Ok(None));
        assert_eq!(numbers(lines.read(b"x;0,5;1e-2;")), [Some(0.01), None, None, Some(0.5)]);
        assert_eq!(numbers(lines.read(b"x;nan;0.02;-3\n")), [Some(0.02), Some(-3.0), None, None]);
        assert_eq!(lines.read(b"1;2"), Err(BadLine::Cells { found: 2, expected: 4 }));
        let bad = lines.read(b"x;fast;0.03;").expect_err("it is no number").to_string();
        assert_eq!(bad, "`velocity` is “fast”, but must be a number");
    }

    #[test]
    fn decimal_commas_stand_between_tabs_and_blanks_too() {
        for lines_of in
            [["t\tforce\tvelocity", "0,01\t1,5\t\r\n"], ["t force velocity", "0,01 1,5 nan"], ["t;force", "0,01;1,5;"]]
        {
            let mut lines = lines();
            assert_eq!(lines.read(lines_of[0].as_bytes()), Ok(None));
            assert_eq!(numbers(lines.read(lines_of[1].as_bytes())), [Some(0.01), Some(1.5), None, None]);
        }
    }

    #[test]
    fn times_have_units_turn_over_and_are_asked_about() {
        let times = |header: &str, cells: &[f64]| -> Vec<Result<f64, BadLine>> {
            let mut lines = lines();
            assert_eq!(lines.read(header.as_bytes()), Ok(None));
            let read = |time: &f64| lines.read(format!("{time},1").as_bytes()).map(|row| row.expect("a row").time);
            cells.iter().map(read).collect()
        };
        let ms: Vec<f64> = times("t_ms,force", &[0.0, 10.0, 20.0]).into_iter().map(Result::unwrap).collect();
        assert!(ms.iter().zip([0.0, 0.01, 0.02]).all(|(a, b)| (a - b).abs() < 1e-12), "{ms:?}");
        let micros = [4_294_940_000.0, 4_294_950_000.0, 4_294_960_000.0, 2704.0, 12_704.0];
        let micros: Vec<f64> = times("t [us],force", &micros).into_iter().map(Result::unwrap).collect();
        assert!(micros.windows(2).all(|pair| (pair[1] - pair[0] - 0.01).abs() < 1e-6), "{micros:?}");
        let asked = times("t,force", &[0.0, 10.0, 20.0, 30.0]);
        let question = asked[1].clone().unwrap_err().to_string();
        assert!(question.contains("are the times ms?") && question.contains("`t_ms`"), "{question}");
        assert!(asked[2..].iter().all(Result::is_ok), "it is asked once");
    }

    #[test]
    fn objects_name_their_numbers() {
        let mut lines = lines();
        assert_eq!(
            numbers(lines.read(br#"{"t": 1, "displacement": 0.25, "who": "me"}"#)),
            [Some(1.0), None, Some(0.25), None]
        );
        assert_eq!(
            numbers(lines.read(br#"{"time": 2.5, "input": -1, "velocity": null}"#)),
            [Some(2.5), Some(-1.0), None, None]
        );
        for (line, words) in [
            (&br#"{"displacement": 1}"#[..], "no column for the time"),
            (br#"{"t": "now"}"#, "`t` is \"now\", but must be a number"),
            (br#"{"t": 1"#, "it is no JSON object"),
            (b"\xff\xfe", "it is not text"),
            (b"0.1,0.2", "a header such as `t,force,displacement,velocity` must come first"),
            (b"t,speed", "none of its columns is known"),
        ] {
            let error = lines.read(line).expect_err(words).to_string();
            assert!(error.contains(words), "{error}");
        }
        assert_eq!(lines.read(&vec![b'1'; 100_000]), Err(BadLine::TooLong));
    }
}
