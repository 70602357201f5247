//! The layers of a chart: bands, dots, lines and levels, with every sample.

use egui::Color32;
use kalmanscope_core::Record;

use super::columns::{BandColumn, Column};
use super::series::{Band, Series};
use super::window::Window;

/// One thing that a chart shows, at every sample; the first of a list are the lowest.
pub(crate) enum Layer<'a> {
    /// The area between two edges. A line as wide as `under`, if that is not zero, will hide the middle \[points\].
    Band { band: Band<'a>, color: Color32, under: f32 },
    /// Single values.
    Dots { series: Series<'a>, color: Color32 },
    /// A line. `bounds` says whether the vertical axis must hold all of it, outliers too.
    Line { series: Series<'a>, color: Color32, width: f32, dashed: bool, bounds: bool },
    /// The same value at all times.
    Level { value: f64, color: Color32 },
}

/// The width of the line of the filter that is drawn at this place, the first being `first` wide: each line is 0.6 points
/// thinner than the one below it, so that coinciding lines remain visible \[points\].
pub(crate) fn line_width(place: usize, first: f32) -> f32 {
    (first - 0.6 * place as f32).max(1.0)
}

/// A layer, reduced to the pixel columns of a window.
pub(crate) enum LayerColumns {
    Band(Vec<BandColumn>),
    Series(Vec<Column>),
    /// The same value in all.
    Level,
}

impl LayerColumns {
    pub(crate) fn new(layer: &Layer<'_>, record: &Record, window: &Window) -> Self {
        let (times, columns) = (window.times, window.columns());
        match layer {
            // Half the columns suffice for the smooth edges of a band, and for dots as wide as two.
            Layer::Band { band, .. } => Self::Band(band.columns(record, times, columns / 2)),
            Layer::Dots { series, .. } => Self::Series(series.columns(record, times, columns / 2)),
            Layer::Line { series, .. } => Self::Series(series.columns(record, times, columns)),
            Layer::Level { .. } => Self::Level,
        }
    }
}
