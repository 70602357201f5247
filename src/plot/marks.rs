//! Marks: the visible shapes of a layer at a given scale, without points that make no visible difference.

use std::ops::Range;

use egui::Color32;
use egui_plot::PlotPoint;
use kalmanscope_core::Record;

use super::columns::{BandColumn, Column};
use super::layers::{Layer, LayerColumns};
use super::simplify::simplify;
use super::window::Scale;

/// Limits the climb of a band's edge relative to the screen; a steeper edge has no outline, which would be a blur.
const STEEP: f64 = 6.0;

/// Values closer than this look the same \[points\].
const ALIKE: f64 = 0.2;

/// Limits the climb \[points\] and the reversals per point of width; a line above both is filled as an area, because it
/// is noise.
const DENSE: (f64, f64) = (16.0, 1.0);

/// The width of a line from before a change \[points\].
const BEFORE: f32 = 1.2;

#[derive(Clone, Copy)]
pub(crate) struct Rung {
    pub(crate) time: f64,
    pub(crate) low: f64,
    pub(crate) high: f64,
    widest: f64,
}

pub(crate) enum Mark {
    /// The parts of a band that no line hides. `steep` says whether its outline would be a blur.
    Band {
        parts: Vec<Vec<Rung>>,
        color: Color32,
        steep: bool,
        filter: Option<u32>,
    },
    Dots {
        points: Vec<PlotPoint>,
        color: Color32,
    },
    /// `dense` says whether the line reverses often enough to be drawn as an area.
    Line {
        points: Vec<PlotPoint>,
        color: Color32,
        width: f32,
        dashed: bool,
        dense: bool,
        filter: Option<u32>,
    },
    Level {
        value: f64,
        color: Color32,
    },
}

impl Mark {
    pub(crate) fn new(
        layer: &Layer<'_>,
        columns: &LayerColumns,
        run: Range<usize>,
        record: &Record,
        scale: Scale,
    ) -> Option<Self> {
        Some(match (layer, columns) {
            (&Layer::Band { color, under, filter, .. }, LayerColumns::Band(columns)) => {
                let rungs = rungs(record, columns.get(run)?);
                let seen: Vec<&[Rung]> = unhidden(&rungs, f64::from(under) / scale.y).collect();
                let parts = seen.iter().map(|rungs| simplify_band(rungs, scale)).collect();
                Self::Band { parts, color, steep: are_steep(&seen, scale), filter }
            }
            (&Layer::Dots { color, .. }, LayerColumns::Series(columns)) => {
                let both = |c: &Column| [c.low, c.high].map(|value| PlotPoint::new(record.time(c.samples.0), value));
                Self::Dots { points: columns.get(run)?.iter().flat_map(both).collect(), color }
            }
            (&Layer::Before { color, .. }, LayerColumns::Series(columns)) => {
                Self::line(record, columns.get(run)?, scale, (color, BEFORE, false, None))
            }
            (&Layer::Line { color, width, dashed, filter, .. }, LayerColumns::Series(columns)) => {
                Self::line(record, columns.get(run)?, scale, (color, width, dashed, filter))
            }
            (&Layer::Level { value, color, .. }, LayerColumns::Level) => Self::Level { value, color },
            _ => return None,
        })
    }

    fn line(
        record: &Record,
        columns: &[Column],
        scale: Scale,
        (color, width, dashed, filter): (Color32, f32, bool, Option<u32>),
    ) -> Self {
        let points = line(record, columns, scale);
        let kept = simplify(points.iter().map(|p| (scale.x * p.x, scale.y * p.y)));
        let kept: Vec<PlotPoint> = kept.into_iter().map(|i| points[i]).collect();
        let dense = is_dense(&points, &kept, scale);
        Self::Line { points: if dense { points } else { kept }, color, width, dashed, dense, filter }
    }
}

fn are_steep(parts: &[&[Rung]], scale: Scale) -> bool {
    let climb = |two: &[Rung]| (two[1].low - two[0].low).abs();
    let climbed: f64 = parts.iter().flat_map(|rungs| rungs.windows(2)).map(climb).sum();
    let length: f64 = parts.iter().filter_map(|rungs| Some(rungs.last()?.time - rungs.first()?.time)).sum();
    scale.y * climbed > STEEP * scale.x * length
}

fn is_dense(points: &[PlotPoint], kept: &[PlotPoint], scale: Scale) -> bool {
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return false };
    let way: f64 = points.windows(2).map(|pair| (pair[1].y - pair[0].y).abs()).sum();
    let length = scale.x * (last.x - first.x);
    let turns = || kept.windows(3).filter(|three| (three[1].y > three[0].y) != (three[2].y > three[1].y)).count();
    scale.y * way > DENSE.0 * length && turns() as f64 > DENSE.1 * length
}

/// A band at both ends of each column if these enclose all of it, else its extremes.
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

fn unhidden(rungs: &[Rung], line: f64) -> impl Iterator<Item = &[Rung]> {
    let runs = rungs.chunk_by(move |a, b| (a.widest > line) == (b.widest > line));
    runs.filter(move |run| run[0].widest > line)
}

fn simplify_band(rungs: &[Rung], Scale { x, y }: Scale) -> Vec<Rung> {
    let edge = |value: fn(&Rung) -> f64| simplify(rungs.iter().map(|rung| (x * rung.time, y * value(rung))));
    let mut kept = edge(|rung| rung.high);
    // The edges of a band around zero mirror each other.
    if rungs.iter().any(|rung| rung.low != -rung.high) {
        kept.extend(edge(|rung| rung.low));
        kept.sort_unstable();
        kept.dedup();
    }
    kept.into_iter().map(|i| rungs[i]).collect()
}

/// A line through the extremes of each column, in their order. Where it only rises or falls these are its ends, so that
/// a steep line has no steps. Extremes that look the same are merged.
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
