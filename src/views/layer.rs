//! What a chart shows, from every sample down to what one frame draws of it.

use std::hash::Hash;

use egui::{Color32, Vec2};
use egui_plot::{PlotPoint, PlotUi};
use kalmanscope_core::Record;

use super::chart::Y_AXIS;
use super::picture::{Grid, Painted, Picture};
use super::sampled::{Band, Series};
use super::vertical::vertical_range;
use crate::polyline::telling;
use crate::series::{BandColumn, Column};

/// How much a band's edge goes up and down on average where it is steep, as a multiple of its way across the screen.
const STEEP: f64 = 6.0;

/// Values nearer to each other cannot be told apart \[points\].
const ALIKE: f64 = 0.2;

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
        ((self.size.x - Y_AXIS) as usize).max(16)
    }

    /// The scale of the screen, where the vertical axis shows `range` unless the user has chosen it.
    fn scale(&self, range: Option<(f64, f64)>) -> Option<Scale> {
        let per = |(low, high): (f64, f64), length: f32| f64::from(length) / (high - low);
        Some(Scale { x: per(self.times, self.size.x), y: per(self.values.or(range)?, self.size.y) })
    }

    /// Everything that a picture depends on.
    pub(super) fn key(&self) -> impl Hash + use<> {
        let bits = |(low, high): (f64, f64)| [low.to_bits(), high.to_bits()];
        (bits(self.times), self.values.map(bits), self.size.x.to_bits(), self.size.y.to_bits())
    }
}

/// How much of the screen there is to a unit \[points\].
#[derive(Clone, Copy)]
struct Scale {
    x: f64,
    y: f64,
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
        let columns: Vec<Columns> = layers.iter().map(|layer| Columns::new(layer, record, window)).collect();
        let range = vertical_range(layers.iter().zip(&columns), least);
        // Without a scale nothing has a value.
        let layers = window.scale(range).map_or(Vec::new(), |scale| {
            layers.iter().zip(&columns).filter_map(|(layer, c)| DrawnLayer::new(layer, c, record, scale)).collect()
        });
        Self { range, layers, painted: Painted::default() }
    }

    /// Adds a grid and the layers to a plot.
    pub(super) fn show<'a>(&'a self, grid: Grid, plot: &mut PlotUi<'a>) {
        plot.add(Picture::new(grid, &self.layers, &self.painted));
    }
}

/// What a layer has in the pixel columns of a window.
pub(super) enum Columns {
    Band(Vec<BandColumn>),
    Series(Vec<Column>),
    /// The same in all.
    Level,
}

impl Columns {
    fn new(layer: &Layer<'_>, record: &Record, window: &Window) -> Self {
        let (times, columns) = (window.times, window.columns());
        match layer {
            // Half the columns do for the smooth edges of a band, and for dots as wide as two.
            Layer::Band { band, .. } => Self::Band(band.columns(record, times, columns / 2)),
            Layer::Dots { series, .. } => Self::Series(series.columns(record, times, columns / 2)),
            Layer::Line { series, .. } => Self::Series(series.columns(record, times, columns)),
            Layer::Level { .. } => Self::Level,
        }
    }
}

impl DrawnLayer {
    /// The layer on a screen of this scale, without what makes no difference there.
    fn new(layer: &Layer<'_>, columns: &Columns, record: &Record, scale: Scale) -> Option<Self> {
        Some(match (layer, columns) {
            (&Layer::Band { color, under, .. }, Columns::Band(columns)) => {
                let rungs = rungs(record, columns);
                let seen: Vec<&[Rung]> = unhidden(&rungs, f64::from(under) / scale.y).collect();
                let parts = seen.iter().map(|rungs| telling_rungs(rungs, scale)).collect();
                Self::Band { parts, color, steep: are_steep(&seen, scale) }
            }
            (&Layer::Dots { color, .. }, Columns::Series(columns)) => {
                let both = |c: &Column| [c.low, c.high].map(|value| PlotPoint::new(record.time(c.samples.0), value));
                Self::Dots { points: columns.iter().flat_map(both).collect(), color }
            }
            (&Layer::Line { color, width, dashed, .. }, Columns::Series(columns)) => {
                let points = line(record, columns, scale);
                let kept = telling(points.iter().map(|p| (scale.x * p.x, scale.y * p.y)));
                let kept: Vec<PlotPoint> = kept.into_iter().map(|i| points[i]).collect();
                let dense = is_dense(&points, &kept, scale);
                Self::Line { points: if dense { points } else { kept }, color, width, dashed, dense }
            }
            (&Layer::Level { value, color }, Columns::Level) => Self::Level { value, color },
            _ => return None,
        })
    }
}

/// Whether lines along the edges of a band would be one blur.
fn are_steep(parts: &[&[Rung]], scale: Scale) -> bool {
    let climb = |two: &[Rung]| (two[1].low - two[0].low).abs();
    let climbed: f64 = parts.iter().flat_map(|rungs| rungs.windows(2)).map(climb).sum();
    let length: f64 = parts.iter().filter_map(|rungs| Some(rungs.last()?.time - rungs.first()?.time)).sum();
    scale.y * climbed > STEEP * scale.x * length
}

/// Whether a line, of which these points are `kept`, goes up and down so much that it is an area.
fn is_dense(points: &[PlotPoint], kept: &[PlotPoint], scale: Scale) -> bool {
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return false };
    let way: f64 = points.windows(2).map(|pair| (pair[1].y - pair[0].y).abs()).sum();
    let length = scale.x * (last.x - first.x);
    let turns = || kept.windows(3).filter(|three| (three[1].y > three[0].y) != (three[2].y > three[1].y)).count();
    scale.y * way > DENSE.0 * length && turns() as f64 > DENSE.1 * length
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

/// What a band needs to look as it does.
fn telling_rungs(rungs: &[Rung], Scale { x, y }: Scale) -> Vec<Rung> {
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
/// ends, and a steep line is no staircase. Extremes that nobody can tell apart are one.
fn line(record: &Record, columns: &[Column], scale: Scale) -> Vec<PlotPoint> {
    let alike = ALIKE / scale.y;
    let mut points = Vec::with_capacity(2 * columns.len());
    for &Column { samples: (first, last), low, high, rising, .. } in columns {
        if high - low <= alike {
            points.push(PlotPoint::new(record.time(first), 0.5 * (low + high)));
        } else {
            let (begin, end) = if rising { (low, high) } else { (high, low) };
            points.extend([PlotPoint::new(record.time(first), begin), PlotPoint::new(record.time(last), end)]);
        }
    }
    points
}
