//! The layers of a chart: bands, dots, lines and levels, with every sample.

use egui::Color32;
use kalmanscope_core::Record;

use super::columns::{BandColumn, Column};
use super::series::{Band, Series};
use super::window::Window;

/// A layer of a chart, at every sample; the first of a list is the lowest.
pub(crate) enum Layer<'a> {
    /// The area between two edges. A line of width `under`, if positive, hides its middle \[points\].
    Band { band: Band<'a>, color: Color32, under: f32, filter: Option<u32> },
    /// Single values as dots.
    Dots { series: Series<'a>, color: Color32 },
    /// A line. `bounds` says whether the vertical axis includes all of it, also outliers.
    Line { series: Series<'a>, color: Color32, width: f32, dashed: bool, bounds: bool, filter: Option<u32> },
    /// A thin line from before a change. `now` is the number of the same filter's line among the chart's solid lines; where
    /// both coincide, only that one is drawn.
    Before { series: Series<'a>, color: Color32, now: usize },
    /// The same value at all times, with a label if it is not empty.
    Level { value: f64, color: Color32, label: &'static str },
}

impl<'a> Layer<'a> {
    /// A solid line. The vertical axis may leave out its outliers.
    pub(crate) fn line(series: Series<'a>, color: Color32, width: f32) -> Self {
        Self::Line { series, color, width, dashed: false, bounds: false, filter: None }
    }

    /// A dashed line. The vertical axis may leave out its outliers.
    pub(crate) fn dashed(series: Series<'a>, color: Color32, width: f32) -> Self {
        Self::Line { series, color, width, dashed: true, bounds: false, filter: None }
    }

    /// The layer as part of the filter with an id: a click on it opens that filter's diagnosis.
    pub(crate) fn of(mut self, id: u32) -> Self {
        if let Self::Band { filter, .. } | Self::Line { filter, .. } = &mut self {
            *filter = Some(id);
        }
        self
    }
}

/// The width of the line of the filter at this place; the first has the width `first`. Each line is a little thinner
/// than the one below it \[points\].
pub(crate) fn line_width(place: usize, first: f32) -> f32 {
    (first - 0.2 * place as f32).max(1.6)
}

pub(crate) enum LayerColumns {
    Band(Vec<BandColumn>),
    Series(Vec<Column>),
    Level,
}

impl LayerColumns {
    pub(crate) fn new(layer: &Layer<'_>, record: &Record, window: &Window) -> Self {
        let (times, columns) = (window.times, window.columns());
        match layer {
            // Half of the columns are enough for the smooth edges of a band, and for dots of two points.
            Layer::Band { band, .. } => Self::Band(band.columns(record, times, columns / 2)),
            Layer::Dots { series, .. } => Self::Series(series.columns(record, times, columns / 2)),
            Layer::Line { series, .. } | Layer::Before { series, .. } => {
                Self::Series(series.columns(record, times, columns))
            }
            Layer::Level { .. } => Self::Level,
        }
    }
}
