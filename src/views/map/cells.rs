//! The numbers of a map's cells, and the outcomes of the runs.

use kalmanscope_core::{Measure, ValueKind};

use crate::laboratory::Survey;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cell {
    /// The score, without the sign of an error; NaN where there is none.
    pub(super) value: f64,
    pub(super) end: End,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    Unknown,
    Stopped,
    Lost,
    Followed,
}

pub(super) fn of_filter(survey: &Survey, filter: usize, measure: Measure) -> Vec<Cell> {
    let columns = [measure, Measure::STOPPED, Measure::DIVERGED].map(|measure| survey.column(filter, measure));
    let cell = |cell: usize| {
        let Some(row) = survey.sheet.shown(cell) else { return Cell { value: f64::NAN, end: End::Unknown } };
        let [value, stopped, diverged] = columns.map(|column| column.map_or(f64::NAN, |at| row[at]));
        let value = if measure.info().kind == ValueKind::Error { value.abs() } else { value };
        let end = match (stopped == 0.0, diverged == 1.0) {
            (false, _) => End::Stopped,
            (true, true) => End::Lost,
            (true, false) => End::Followed,
        };
        Cell { value, end }
    };
    (0..survey.ensemble.cells()).map(cell).collect()
}

pub(super) fn compared(a: &[Cell], b: &[Cell], measure: Measure) -> Vec<Cell> {
    let is_ratio = measure.info().kind.is_ratio();
    let worst = |a: End, b: End| [End::Unknown, End::Stopped, End::Lost].into_iter().find(|end| [a, b].contains(end));
    let cell = |(a, b): (&Cell, &Cell)| Cell {
        value: if is_ratio { a.value / b.value } else { a.value - b.value },
        end: worst(a.end, b.end).unwrap_or(End::Followed),
    };
    a.iter().zip(b).map(cell).collect()
}
