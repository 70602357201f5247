//! What a chart shows, from every sample down to what one frame draws of it.

use std::hash::Hash;

use egui::{Color32, Vec2};
use egui_plot::{PlotPoint, PlotUi};
use kalmanscope_core::Record;

use super::picture::{Painted, Picture};
use super::sampled::{Band, Series};
use super::vertical::vertical_range;
use crate::polyline::telling;
use crate::series::{BandColumn, Column};

/// How much a band's edge goes up and down on average where it is steep, as a multiple of its way across the screen.
const STEEP: f64 = 6.0;

/// A line that goes so many points up and down, and turns so often, on its way of one point to the right is an area: noise is,
/// waves are not.
const DENSE: (f64, f64) = (16.0, 1.0);

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
    /// What is between two edges. A line as wide as `under`, if it is not zero, will hide the middle \[points\].
    Band { band: Band<'a>, color: Color32, under: f32 },
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
    painted: Painted,
    /// What the vertical axis should show.
    pub(super) range: Option<(f64, f64)>,
}

/// A band at one time.
#[derive(Clone, Copy)]
pub(super) struct Rung {
    pub(super) time: f64,
    pub(super) low: f64,
    pub(super) high: f64,
    /// How wide it is at most.
    widest: f64,
}

/// A layer of it.
pub(super) enum DrawnLayer {
    /// Those parts of a band that no line hides. `steep` says whether lines along its edges would be one blur.
    Band {
        parts: Vec<Vec<Rung>>,
        color: Color32,
        under: f32,
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
        Self { range, layers, painted: Painted::default() }
    }

    /// Adds the layers to a plot.
    pub(super) fn show<'a>(&'a self, plot: &mut PlotUi<'a>) {
        plot.add(Picture::new(&self.layers, &self.painted));
    }
}

impl DrawnLayer {
    fn new(layer: &Layer<'_>, record: &Record, window: (f64, f64), columns: usize) -> Self {
        match layer {
            Layer::Band { band, color, under } => {
                // Half the columns do for the smooth edges of a band.
                let rungs = rungs(record, &band.columns(record, window, columns / 2));
                Self::Band { parts: vec![rungs], color: *color, under: *under, steep: false }
            }
            Layer::Dots { series, color } => {
                let columns = series.columns(record, window, columns / 2);
                let both = |c: &Column| [c.low, c.high].map(|value| PlotPoint::new(record.time(c.samples.0), value));
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
            Self::Band { parts, under, steep, .. } => {
                let seen: Vec<&[Rung]> =
                    parts.iter().flat_map(|rungs| unhidden(rungs, f64::from(*under) / y)).collect();
                let climb = |two: &[Rung]| (two[1].low - two[0].low).abs();
                let climbed: f64 = seen.iter().flat_map(|rungs| rungs.windows(2)).map(climb).sum();
                let length: f64 = seen.iter().filter_map(|rungs| Some(rungs.last()?.time - rungs.first()?.time)).sum();
                *steep = y * climbed > STEEP * x * length;
                *parts = seen.into_iter().map(|rungs| telling_rungs(rungs, (x, y))).collect();
            }
            Self::Line { points, dense, .. } => {
                let (Some(first), Some(last)) = (points.first(), points.last()) else { return };
                let way: f64 = points.windows(2).map(|pair| (pair[1].y - pair[0].y).abs()).sum();
                let length = x * (last.x - first.x);
                let kept = telling(points.iter().map(|p| (x * p.x, y * p.y)));
                let turns = kept.windows(3).filter(|three| {
                    let [before, at, after] = [0, 1, 2].map(|i| points[three[i]].y);
                    (at > before) != (after > at)
                });
                *dense = y * way > DENSE.0 * length && turns.count() as f64 > DENSE.1 * length;
                if !*dense {
                    *points = kept.into_iter().map(|i| points[i]).collect();
                }
            }
            Self::Dots { .. } | Self::Level { .. } => {}
        }
    }
}

/// A band at both ends of each column where they hold all of it; where they do not, its extremes.
fn rungs(record: &Record, columns: &[BandColumn]) -> Vec<Rung> {
    let mut rungs = Vec::with_capacity(2 * columns.len());
    for &BandColumn { samples: (first, last), low, high, ends, widest } in columns {
        let at = |k, (low, high)| Rung { time: record.time(k), low, high, widest };
        match ends.filter(|_| first < last) {
            Some([begin, end]) => rungs.extend([at(first, begin), at(last, end)]),
            None => rungs.push(at(first, (low, high))),
        }
    }
    rungs
}

/// The parts of a band that are wider than a line along its middle.
fn unhidden(rungs: &[Rung], line: f64) -> impl Iterator<Item = &[Rung]> {
    let runs = rungs.chunk_by(move |a, b| (a.widest > line) == (b.widest > line));
    runs.filter(move |run| run[0].widest > line)
}

/// What a band needs to look as it does on a screen of this scale.
fn telling_rungs(rungs: &[Rung], (x, y): (f64, f64)) -> Vec<Rung> {
    let edge = |value: fn(&Rung) -> f64| telling(rungs.iter().map(|rung| (x * rung.time, y * value(rung))));
    let mut kept = edge(|rung| rung.high);
    // One edge tells all of a band around zero.
    if rungs.iter().any(|rung| rung.low != -rung.high) {
        kept.extend(edge(|rung| rung.low));
        kept.sort_unstable();
        kept.dedup();
    }
    kept.into_iter().map(|i| rungs[i]).collect()
}

/// A line through the extremes of each column, in the order in which they come: where it only rises or falls these are its
/// ends, and a steep line is no staircase.
fn line(record: &Record, columns: &[Column]) -> Vec<PlotPoint> {
    let mut points = Vec::with_capacity(2 * columns.len());
    for column in columns {
        let (low, high) = (column.low, column.high);
        let (first, second) = if column.rising { (low, high) } else { (high, low) };
        points.push(PlotPoint::new(record.time(column.samples.0), first));
        if first != second {
            points.push(PlotPoint::new(record.time(column.samples.1), second));
        }
    }
    points
}
