//! Marks: the visible shapes of a layer at a given scale, without points that make no visible difference.

use std::ops::Range;

use egui::Color32;
use egui_plot::PlotPoint;
use kalmanscope_core::Record;

use super::layers::{Layer, LayerColumns, Scale};
use super::series::{BandColumn, Column};

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

/// Limits the distance of an omitted point from the line \[points of the screen\].
const TOLERANCE: f64 = 0.35;

/// The indices of the points that a polyline needs for the same picture, including its ends. Coordinates are in points
/// of the screen.
///
/// After a kept point, points are omitted while a single line passes them within the tolerance and they lead away from
/// the kept point. Williams (1978), An efficient algorithm for the piecewise linear approximation of planar curves.
pub(crate) fn simplify(points: impl IntoIterator<Item = (f64, f64)>) -> Vec<usize> {
    let mut points = points.into_iter().enumerate();
    let mut kept = Vec::with_capacity(points.size_hint().0);
    let Some((_, first)) = points.next() else { return kept };
    kept.push(0);
    let mut cone = Cone::at(first);
    let mut last = (0, first);
    for (i, point) in points {
        if !cone.narrow(point) {
            kept.push(last.0);
            cone = Cone::at(last.1);
            cone.narrow(point);
        }
        last = (i, point);
    }
    if last.0 > 0 {
        kept.push(last.0);
    }
    kept
}

struct Cone {
    apex: (f64, f64),
    reach: f64,
    edges: Option<[(f64, f64); 2]>,
}

impl Cone {
    fn at(apex: (f64, f64)) -> Self {
        Self { apex, reach: 0.0, edges: None }
    }

    fn narrow(&mut self, point: (f64, f64)) -> bool {
        let (x, y) = (point.0 - self.apex.0, point.1 - self.apex.1);
        let distance = (x * x + y * y).sqrt();
        if distance <= TOLERANCE && self.edges.is_none() {
            return true;
        }
        // A peak, because the line turns back.
        if distance < self.reach {
            return false;
        }
        // The edges on either side, scaled by `distance` to avoid a division.
        let (along, across) = ((x * distance, y * distance), (-y * TOLERANCE, x * TOLERANCE));
        let mut right = (along.0 - across.0, along.1 - across.1);
        let mut left = (along.0 + across.0, along.1 + across.1);
        if let Some([least, most]) = self.edges {
            if cross(least, (x, y)) < 0.0 || cross((x, y), most) < 0.0 {
                return false;
            }
            right = if cross(least, right) > 0.0 { right } else { least };
            left = if cross(left, most) > 0.0 { left } else { most };
        }
        self.reach = distance;
        self.edges = Some([right, left]);
        true
    }
}

fn cross(a: (f64, f64), b: (f64, f64)) -> f64 {
    a.0 * b.1 - a.1 * b.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_lines_need_their_ends() {
        let line: Vec<_> = (0..100).map(|i| (f64::from(i), 0.5 * f64::from(i))).collect();
        assert_eq!(simplify(line.iter().copied()), [0, 99]);
        assert_eq!(simplify(line[..2].iter().copied()), [0, 1]);
        assert_eq!(simplify(line[..1].iter().copied()), [0]);
        assert!(simplify([]).is_empty());
    }

    #[test]
    fn peaks_and_corners_stay() {
        let corner = [(0.0, 0.0), (5.0, 0.0), (10.0, 0.0), (10.0, 5.0), (10.0, 10.0)];
        assert_eq!(simplify(corner), [0, 2, 4]);
        let needle = [(0.0, 0.0), (1.0, 0.0), (1.0, 30.0), (1.0, 10.0), (1.0, 0.0), (9.0, 0.0)];
        assert_eq!(simplify(needle), [0, 1, 2, 4, 5]);
    }

    #[test]
    fn no_point_is_far_from_the_line() {
        let wave: Vec<_> = (0..800).map(|i| (0.5 * f64::from(i), 40.0 * (0.05 * f64::from(i)).sin())).collect();
        let kept = simplify(wave.iter().copied());
        assert!(kept.len() < wave.len() / 3, "{} points are left", kept.len());
        for ends in kept.windows(2) {
            let (a, b) = (wave[ends[0]], wave[ends[1]]);
            let along = (b.0 - a.0, b.1 - a.1);
            for point in &wave[ends[0]..ends[1]] {
                let off = cross(along, (point.0 - a.0, point.1 - a.1)).abs() / along.0.hypot(along.1);
                assert!(off < 2.0 * TOLERANCE, "{off}");
            }
        }
    }
}
