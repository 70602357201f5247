//! What a chart shows, from every sample down to what one frame draws of it.

use std::hash::Hash;
use std::ops::Range;

use egui::{Color32, Vec2};
use egui_plot::{PlotPoint, PlotUi};
use kalmanscope_core::Record;

use super::picture::Picture;
use crate::polyline::telling;
use crate::series::{Column, central_range, reduce, reduce_between};

/// Share of the columns at either end that the vertical axis does not bend to: the first instants of a wide guess.
const OUTLIERS: f64 = 0.006;

/// How much a band's edge goes up and down on average where it is steep, as a multiple of its way across the screen.
const STEEP: f64 = 6.0;

/// A line that goes so many points up and down on its way of one point to the right is an area.
const DENSE: f64 = 16.0;

/// A quantity at every sample, NaN where there is none.
pub(super) struct Series<'a> {
    len: usize,
    reduce: Box<dyn Fn(Range<usize>, usize) -> Vec<Column> + 'a>,
}

impl<'a> Series<'a> {
    /// `value(k)` for the samples up to `len`.
    pub(super) fn new(len: usize, value: impl Fn(usize) -> f64 + 'a) -> Self {
        Self { len, reduce: Box::new(move |range, columns| reduce(range, columns, &value)) }
    }

    /// What is between the two numbers that `edges(k)` gives, the lower first.
    pub(super) fn between(len: usize, edges: impl Fn(usize) -> (f64, f64) + 'a) -> Self {
        Self { len, reduce: Box::new(move |range, columns| reduce_between(range, columns, &edges)) }
    }

    /// The series through a function that preserves order, which then is asked for the extremes only.
    pub(super) fn through(self, function: fn(f64) -> f64) -> Self {
        let Self { len, reduce } = self;
        let through = move |column: Column| {
            let (low, high) = (function(column.low), function(column.high));
            (low.is_finite() && high.is_finite()).then_some(Column { low, high, ..column })
        };
        let reduce = move |range, columns| reduce(range, columns).into_iter().filter_map(through).collect();
        Self { len, reduce: Box::new(reduce) }
    }

    fn columns(&self, record: &Record, window: (f64, f64), columns: usize) -> Vec<Column> {
        (self.reduce)(samples_in(record, window, self.len), columns)
    }
}

/// The part of the record that a plot shows.
#[derive(Clone, Copy)]
pub(super) struct Window {
    /// From when to when \[s\].
    pub(super) times: (f64, f64),
    /// The vertical axis, where the user has chosen it.
    pub(super) values: Option<(f64, f64)>,
    /// The plot's size \[points\].
    pub(super) size: Vec2,
}

impl Window {
    /// The number of its columns, a point wide each.
    fn columns(&self) -> usize {
        (self.size.x as usize).max(16)
    }

    /// Everything that a picture depends on.
    pub(super) fn key(&self) -> impl Hash + use<> {
        let bits = |(low, high): (f64, f64)| [low.to_bits(), high.to_bits()];
        (bits(self.times), self.values.map(bits), self.size.x.to_bits(), self.size.y.to_bits())
    }
}

/// One thing that a chart shows; the first are the lowest.
pub(super) enum Layer<'a> {
    /// What is between the edges of a series.
    Band { series: Series<'a>, color: Color32 },
    /// Single values.
    Dots { series: Series<'a>, color: Color32 },
    /// A line. `bounds` says whether the vertical axis must hold all of it, outliers too.
    Line { series: Series<'a>, color: Color32, width: f32, dashed: bool, bounds: bool },
    /// The same value at all times.
    Level { value: f64, color: Color32 },
}

/// The width of a filter's line, that of the `first` and then less from filter to filter: where all agree, each still shows
/// beside the narrower one above it \[points\].
pub(super) fn line_width(place: usize, first: f32) -> f32 {
    (first - 0.6 * place as f32).max(1.0)
}

/// A chart's layers, reduced to the pixel columns of a window.
pub(super) struct Drawn {
    layers: Vec<DrawnLayer>,
    /// What the vertical axis should show.
    pub(super) range: Option<(f64, f64)>,
}

/// A layer of it. The edges of a band are times with the lowest and the highest value there.
pub(super) enum DrawnLayer {
    /// `steep` says whether lines along its edges would be one blur.
    Band {
        edges: Vec<[f64; 3]>,
        color: Color32,
        steep: bool,
    },
    Dots {
        points: Vec<PlotPoint>,
        color: Color32,
    },
    /// `dense` says whether it goes up and down so much that it is an area.
    Line {
        points: Vec<PlotPoint>,
        color: Color32,
        width: f32,
        dashed: bool,
        bounds: bool,
        dense: bool,
    },
    Level {
        value: f64,
        color: Color32,
    },
}

impl Drawn {
    /// Reduces `layers` to what the window shows. `least` is the least that the vertical axis shows.
    pub(super) fn new(layers: &[Layer<'_>], record: &Record, window: &Window, least: Option<(f64, f64)>) -> Self {
        let mut layers: Vec<DrawnLayer> =
            layers.iter().map(|layer| DrawnLayer::new(layer, record, window.times, window.columns())).collect();
        let range = vertical_range(&layers, least);
        if let Some(values) = window.values.or(range) {
            let scale = |(low, high): (f64, f64), length: f32| f64::from(length) / (high - low);
            let scale = (scale(window.times, window.size.x), scale(values, window.size.y));
            for layer in &mut layers {
                layer.simplify(scale);
            }
        }
        Self { range, layers }
    }

    /// Adds the layers to a plot.
    pub(super) fn show<'a>(&'a self, plot: &mut PlotUi<'a>) {
        plot.add(Picture::new(&self.layers));
    }
}

impl DrawnLayer {
    fn new(layer: &Layer<'_>, record: &Record, window: (f64, f64), columns: usize) -> Self {
        match layer {
            Layer::Band { series, color } => {
                // Half the columns do for the smooth edges of a band.
                let columns = series.columns(record, window, columns / 2);
                let edges = columns.iter().map(|c| [record.time(c.sample), c.low, c.high]).collect();
                Self::Band { edges, color: *color, steep: false }
            }
            Layer::Dots { series, color } => {
                let columns = series.columns(record, window, columns / 2);
                let both = |c: &Column| [c.low, c.high].map(|value| PlotPoint::new(record.time(c.sample), value));
                Self::Dots { points: columns.iter().flat_map(both).collect(), color: *color }
            }
            Layer::Line { series, color, width, dashed, bounds } => Self::Line {
                points: line(record, &series.columns(record, window, columns)),
                color: *color,
                width: *width,
                dashed: *dashed,
                bounds: *bounds,
                dense: true,
            },
            Layer::Level { value, color } => Self::Level { value: *value, color: *color },
        }
    }

    /// Leaves out points that make no difference at so many points of the screen a unit.
    fn simplify(&mut self, (x, y): (f64, f64)) {
        match self {
            Self::Band { edges, steep, .. } => {
                let climbed: f64 = edges.windows(2).map(|pair| (pair[1][1] - pair[0][1]).abs()).sum();
                let width = edges.last().zip(edges.first()).map_or(0.0, |(last, first)| last[0] - first[0]);
                *steep = y * climbed > STEEP * x * width;
                let edge = |value: usize| telling(edges.iter().map(|edge| (x * edge[0], y * edge[value])));
                let mut kept = edge(1);
                kept.extend(edge(2));
                kept.sort_unstable();
                kept.dedup();
                *edges = kept.into_iter().map(|i| edges[i]).collect();
            }
            Self::Line { points, dense, .. } => {
                let (Some(first), Some(last)) = (points.first(), points.last()) else { return };
                let way: f64 = points.windows(2).map(|pair| (pair[1].y - pair[0].y).abs()).sum();
                *dense = y * way > DENSE * x * (last.x - first.x);
                if !*dense {
                    let kept = telling(points.iter().map(|p| (x * p.x, y * p.y)));
                    *points = kept.into_iter().map(|i| points[i]).collect();
                }
            }
            Self::Dots { .. } | Self::Level { .. } => {}
        }
    }
}

/// All of the lines that count, and the rest but for its outermost columns; dots only where there is nothing else.
fn vertical_range(layers: &[DrawnLayer], least: Option<(f64, f64)>) -> Option<(f64, f64)> {
    let (mut whole, mut robust, mut dots) = (Vec::new(), Vec::new(), Vec::new());
    for layer in layers {
        match layer {
            DrawnLayer::Band { edges, .. } => robust.extend(some(edges).flat_map(|[_, low, high]| [*low, *high])),
            DrawnLayer::Line { points, bounds: true, .. } => whole.extend(points.iter().map(|p| p.y)),
            DrawnLayer::Line { points, .. } => robust.extend(some(points).map(|p| p.y)),
            DrawnLayer::Dots { points, .. } => dots.extend(some(points).map(|p| p.y)),
            DrawnLayer::Level { .. } => {}
        }
    }
    let robust = central_range(robust.into_iter().filter(|x| x.is_finite()).collect(), OUTLIERS);
    let all = whole.into_iter().filter(|x| x.is_finite()).map(|x| (x, x)).chain(robust).chain(least);
    let (low, high) =
        all.reduce(|(low, high), (l, h)| (low.min(l), high.max(h))).or_else(|| central_range(dots, OUTLIERS))?;
    let margin = 0.06 * (high - low).max(1e-9 + 0.02 * high.abs());
    Some((low - margin, high + margin))
}

/// So many values, evenly spaced, as it takes to know where most are.
fn some<T>(values: &[T]) -> impl Iterator<Item = &T> {
    values.iter().step_by(values.len() / 200 + 1)
}

/// The samples that the window shows, one more at either side, as far as there are any.
fn samples_in(record: &Record, (from, to): (f64, f64), len: usize) -> Range<usize> {
    let index = |time: f64| ((time - record.time(0)) / record.dt()).clamp(0.0, len as f64);
    let first = index(from).floor() as usize;
    let last = (index(to).ceil() as usize + 1).min(len);
    first.saturating_sub(1).min(last)..last
}

/// A line through the extremes of each column, in the order in which they come.
fn line(record: &Record, columns: &[Column]) -> Vec<PlotPoint> {
    let mut points = Vec::with_capacity(2 * columns.len());
    for column in columns {
        let x = record.time(column.sample);
        let (first, second) = if column.rising { (column.low, column.high) } else { (column.high, column.low) };
        points.push(PlotPoint::new(x, first));
        if first != second {
            points.push(PlotPoint::new(x, second));
        }
    }
    points
}
