//! The layers of a chart, their columns, their range of values, and where a curve has a gap.

use std::hash::Hash;
use std::ops::Range;

use egui::{Color32, Vec2};
use kalmanscope_core::Record;

use super::medium::Y_AXIS;
use super::series::{Band, BandColumn, Column, Series, central_range};

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
    pub(crate) fn line(series: Series<'a>, color: Color32, width: f32) -> Self {
        Self::Line { series, color, width, dashed: false, bounds: false, filter: None }
    }

    pub(crate) fn dashed(series: Series<'a>, color: Color32, width: f32) -> Self {
        Self::Line { series, color, width, dashed: true, bounds: false, filter: None }
    }

    pub(crate) fn zero(color: Color32) -> Self {
        Self::Level { value: 0.0, color, label: "" }
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

#[derive(Clone, Copy)]
pub(crate) struct Window {
    /// Beginning and end \[s\].
    pub(crate) times: (f64, f64),
    pub(crate) values: Option<(f64, f64)>,
    pub(crate) size: Vec2,
}

impl Window {
    pub(crate) fn columns(&self) -> usize {
        ((self.size.x - Y_AXIS) as usize).max(16)
    }

    /// The scale of the screen. The vertical axis shows `range` unless the user has chosen another.
    pub(crate) fn scale(&self, range: Option<(f64, f64)>) -> Option<Scale> {
        let per = |(low, high): (f64, f64), length: f32| f64::from(length) / (high - low);
        Some(Scale { x: per(self.times, self.size.x), y: per(self.values.or(range)?, self.size.y) })
    }

    pub(crate) fn key(&self) -> impl Hash + use<> {
        let bits = |(low, high): (f64, f64)| [low.to_bits(), high.to_bits()];
        (bits(self.times), self.values.map(bits), self.size.x.to_bits(), self.size.y.to_bits())
    }
}

#[derive(Clone, Copy)]
pub(crate) struct Scale {
    pub(crate) x: f64,
    pub(crate) y: f64,
}

/// A curve breaks at a gap of at least `SAMPLES` samples that is `DISTANCES` times as long as the mean distance between columns.
/// So the curve of a sensor with a slow clock does not break.
const SAMPLES: usize = 10;
const DISTANCES: usize = 8;

pub(super) fn unbroken(columns: &LayerColumns, run: Range<usize>) -> Vec<Range<usize>> {
    match columns {
        LayerColumns::Band(all) => parts(run, all.len(), |place| all[place].samples),
        LayerColumns::Series(all) => parts(run, all.len(), |place| all[place].samples),
        LayerColumns::Level => vec![run],
    }
}

/// The unbroken parts of a run among `count` columns; `samples` gives the first and the last sample of each.
fn parts(run: Range<usize>, count: usize, samples: impl Fn(usize) -> (usize, usize)) -> Vec<Range<usize>> {
    let distances = count.saturating_sub(1);
    if run.is_empty() || distances == 0 {
        return vec![run];
    }
    let whole = samples(distances).0 - samples(0).0;
    let (mut parts, mut begin) = (Vec::new(), run.start);
    for place in run.start + 1..run.end {
        let gap = samples(place).0 - samples(place - 1).1;
        if gap >= SAMPLES && gap * distances > DISTANCES * whole {
            parts.push(begin..place);
            begin = place;
        }
    }
    parts.push(begin..run.end);
    parts
}

/// Share of the values at either end that the axis ignores, such as the first instants of a wide guess.
const OUTLIERS: f64 = 0.006;

/// Limits the pieces of a layer; the range uses the extremes of each piece.
const PIECES: usize = 250;

pub(crate) fn value_range<'a>(
    layers: impl Iterator<Item = (&'a Layer<'a>, &'a LayerColumns)>,
    least: Option<(f64, f64)>,
) -> Option<(f64, f64)> {
    let (mut whole, mut robust, mut dots) = (Vec::new(), Vec::with_capacity(16 * PIECES), Vec::new());
    for (layer, columns) in layers {
        let values = match layer {
            Layer::Line { bounds: true, .. } => &mut whole,
            Layer::Dots { .. } => &mut dots,
            _ => &mut robust,
        };
        match columns {
            LayerColumns::Band(columns) => add_extremes(columns, |column| (column.low, column.high), values),
            LayerColumns::Series(columns) => add_extremes(columns, |column| (column.low, column.high), values),
            LayerColumns::Level => {}
        }
    }
    let all = whole.into_iter().map(|x| (x, x)).chain(central_range(robust, OUTLIERS)).chain(least);
    let (low, high) =
        all.reduce(|(low, high), (l, h)| (low.min(l), high.max(h))).or_else(|| central_range(dots, OUTLIERS))?;
    let margin = 0.06 * (high - low).max(1e-9 + 0.02 * high.abs());
    Some((low - margin, high + margin))
}

fn add_extremes<T>(columns: &[T], edges: impl Fn(&T) -> (f64, f64), extremes: &mut Vec<f64>) {
    for piece in columns.chunks(columns.len() / PIECES + 1) {
        let both = piece.iter().map(&edges).reduce(|(low, high), (l, h)| (low.min(l), high.max(h)));
        extremes.extend(both.into_iter().flat_map(|(low, high)| [low, high]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_gap_breaks_a_curve_and_a_slow_clock_does_not() {
        let of = |samples: &[usize]| parts(0..samples.len(), samples.len(), |place| (samples[place], samples[place]));
        let slow: Vec<usize> = (0..50).map(|k| 14 * k).collect();
        assert_eq!(of(&slow).len(), 1);
        let fast: Vec<usize> = (0..200).filter(|k| !(90..120).contains(k)).collect();
        assert_eq!(of(&fast), [0..90, 90..170]);
        let uneven: Vec<usize> = (0..200).filter(|k| k % 3 != 1 && !(50..58).contains(k)).collect();
        assert_eq!(of(&uneven).len(), 1);
        assert_eq!([&[][..], &[3], &[3, 90]].map(|samples| of(samples).len()), [1; 3]);
    }
}
