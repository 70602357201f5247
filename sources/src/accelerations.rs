//! Time and three accelerations in lines that come one by one.

use kalmanscope_core::import::{Column, Table, ThreeAxes};
use thiserror::Error;

use crate::line::{StreamLine, number, number_of};

/// The lines after which the meaning of the columns is settled: with names, and without.
const NAMED: usize = 3;
const UNNAMED: usize = 40;

/// Reads accelerations from lines whose columns have names, or are four numbers of which one rises, or three axes alone.
#[derive(Clone, Debug, Default)]
pub struct Accelerations {
    names: Option<Vec<String>>,
    /// The rows before their meaning is settled; each has the time of its arrival behind it.
    waiting: Vec<Vec<f64>>,
    meaning: Option<Meaning>,
    readings: Vec<[f64; 4]>,
    left_out: usize,
}

#[derive(Clone, Debug)]
struct Meaning {
    axes: ThreeAxes,
    /// The number of cells in a row, the time of arrival among them.
    width: usize,
    first: f64,
}

/// The reason why lines have no accelerations.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum NoAxes {
    /// Columns have no names from which they could be known, and are not three axes with gravity.
    #[error(
        "a line must have the time and three accelerations, named such as `t,ax,ay,az`, or three accelerations; there are {0} columns"
    )]
    Unknown(usize),
}

const ARRIVAL: &str = "arrival";

impl Accelerations {
    /// Takes in a line that arrived at some time \[s\]. Lines without numbers are left out.
    ///
    /// # Errors
    /// [`NoAxes`] once enough lines have come.
    pub fn take(&mut self, line: &[u8], arrival: f64) -> Result<(), NoAxes> {
        let (names, row) = match StreamLine::of(line, None) {
            Err(_) | Ok(StreamLine::Nothing) => (None, None),
            Ok(StreamLine::Object(entries)) => {
                let number = |(key, value): (String, _)| Some((key, number_of(&value).filter(|x| !x.is_nan())?));
                let mut entries: Vec<(String, f64)> = entries.into_iter().filter_map(number).collect();
                // Objects may have their keys in any order.
                entries.sort_by(|a, b| a.0.cmp(&b.0));
                let (names, row) = entries.into_iter().unzip();
                (Some(names), Some(row))
            }
            Ok(StreamLine::Cells(mut cells, mark)) => {
                // Some devices end every row with a mark.
                cells.pop_if(|last| last.is_empty());
                let row: Vec<f64> = cells.iter().filter_map(|cell| number(cell, mark)).collect();
                let names = || cells.iter().map(|&cell| cell.to_owned()).collect::<Vec<_>>();
                (row.is_empty().then(names), (row.len() == cells.len()).then_some(row))
            }
        };
        match (names, row) {
            // A device that starts again sends its header again.
            // Fewer words than axes are a message of the device, not a header.
            (Some(names), None) if self.meaning.is_none() && names.len() > 2 => {
                (self.names, self.waiting) = (Some(names), Vec::new());
            }
            // An object with other keys has its numbers elsewhere.
            (Some(names), Some(_)) if self.names.as_ref().is_some_and(|known| *known != names) => self.left_out += 1,
            (names, Some(mut row)) => {
                row.push(arrival);
                if self.meaning.is_none() && self.names.is_none() {
                    self.names = names;
                }
                return self.row(row);
            }
            (_, None) => self.left_out += 1,
        }
        Ok(())
    }

    fn row(&mut self, row: Vec<f64>) -> Result<(), NoAxes> {
        if let Some(meaning) = &self.meaning {
            if row.len() == meaning.width {
                self.readings.push(meaning.reading(&row));
            } else {
                self.left_out += 1;
            }
            return Ok(());
        }
        // Rows of another width are the end of an earlier line, or noise.
        if self.waiting.last().is_some_and(|last| last.len() != row.len()) {
            self.left_out += self.waiting.len();
            self.waiting.clear();
        }
        self.waiting.push(row);
        let enough = if self.names.is_some() { NAMED } else { UNNAMED };
        if self.waiting.len() < enough {
            return Ok(());
        }
        let width = self.waiting[0].len();
        let Some(meaning) = self.meaning() else { return Err(NoAxes::Unknown(width - 1)) };
        self.readings.extend(self.waiting.drain(..).map(|row| meaning.reading(&row)));
        self.meaning = Some(meaning);
        Ok(())
    }

    /// The meaning of the columns, from their names and from the waiting rows.
    fn meaning(&self) -> Option<Meaning> {
        let width = self.waiting[0].len();
        let named = self.names.clone().filter(|names| names.len() + 1 == width);
        let columns = |names: Vec<String>, places: std::ops::Range<usize>| {
            let of = |(name, place): (String, usize)| {
                let values = self.waiting.iter().map(|row| row[place]).collect();
                Column::of_header(&name, None, values)
            };
            names.into_iter().zip(places).map(of).collect::<Vec<_>>()
        };
        let axes = |columns| ThreeAxes::of(&Table::of_columns("lines", columns, Vec::new()));
        let axes = match named {
            // The device's own time comes first, since the arrival jitters with the connection.
            Some(mut names) => axes(columns(names.clone(), 0..width - 1)).or_else(|| {
                names.push(format!("{ARRIVAL} (s)"));
                axes(columns(names, 0..width))
            }),
            None if width == 4 => {
                let names = ["ax", "ay", "az", "t (s)"].map(str::to_owned).to_vec();
                axes(columns(names, 0..width))
            }
            None => {
                let names = (1..width).map(|place| format!("column {place}")).collect();
                axes(columns(names, 0..width - 1))
            }
        };
        let axes = axes?;
        Some(Meaning { axes, width, first: self.waiting[0][axes.time.0] })
    }

    /// Takes the readings that have come since the last call: the time since the first one \[s\], and accelerations along three axes
    /// \[m/s²\].
    pub fn readings(&mut self) -> Vec<[f64; 4]> {
        std::mem::take(&mut self.readings)
    }

    /// How many lines were left out.
    pub fn left_out(&self) -> usize {
        self.left_out
    }
}

impl Meaning {
    fn reading(&self, row: &[f64]) -> [f64; 4] {
        let ThreeAxes { time: (time, second), axes: (axes, unit) } = self.axes;
        let [x, y, z] = axes.map(|axis| unit * row[axis]);
        [second * (row[time] - self.first), x, y, z]
    }
}
