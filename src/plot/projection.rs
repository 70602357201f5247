//! Positions of values on screen, and outlines through them.

use egui::{Color32, Pos2, Rangef, Stroke, pos2};
use egui_plot::{PlotPoint, PlotTransform};

use super::marks::Rung;
use super::strokes::Strokes;

/// Limits the distance from the plot at which things are drawn: the plot clips them, and larger coordinates would lose
/// digits \[points\].
const OUTSIDE: f32 = 4000.0;

/// Dash and gap \[points\].
pub(crate) const DASH: (f32, f32) = (5.0, 3.0);

pub(crate) struct Projection {
    x: [f64; 3],
    y: [f64; 3],
    /// Positions on the vertical axis are clamped to this range.
    clamp: (f32, f32),
}

impl Projection {
    pub(crate) fn new(transform: &PlotTransform) -> Self {
        let frame = transform.frame();
        let [per_x, per_y] = transform.dpos_dvalue();
        let middle = transform.bounds().center();
        Self {
            x: [f64::from(transform.position_from_point_x(middle.x)), middle.x, per_x],
            y: [f64::from(transform.position_from_point_y(middle.y)), middle.y, per_y],
            clamp: (frame.top() - OUTSIDE, frame.bottom() + OUTSIDE),
        }
    }

    pub(crate) fn x(&self, value: f64) -> f32 {
        let [position, middle, per_unit] = self.x;
        (position + (value - middle) * per_unit) as f32
    }

    pub(crate) fn y(&self, value: f64) -> f32 {
        let [position, middle, per_unit] = self.y;
        ((position + (value - middle) * per_unit) as f32).clamp(self.clamp.0, self.clamp.1)
    }

    pub(crate) fn at(&self, x: f64, y: f64) -> Pos2 {
        pos2(self.x(x), self.y(y))
    }

    pub(crate) fn line(&self, points: &[PlotPoint], stroke: Stroke, dashed: bool, strokes: &mut Strokes) {
        let path: Vec<Pos2> = points.iter().map(|point| self.at(point.x, point.y)).collect();
        if dashed { strokes.dashed(&path, stroke, DASH) } else { strokes.line(&path, stroke) }
    }

    pub(crate) fn dense_line(&self, points: &[PlotPoint], stroke: Stroke, strokes: &mut Strokes) {
        let mut columns: Vec<(f32, Rangef)> = Vec::with_capacity(points.len());
        let mut before = points.first().map_or(0.0, |point| self.y(point.y));
        for point in points {
            let Pos2 { x, y } = self.at(point.x, point.y);
            match columns.last_mut() {
                Some((left, range)) if x < *left + 1.0 => *range = Rangef::new(range.min.min(y), range.max.max(y)),
                _ => columns.push((x, Rangef::new(y.min(before), y.max(before)))),
            }
            before = y;
        }
        // Transparent, so that lines under it remain visible.
        let fill = stroke.color.gamma_multiply(0.8);
        let columns: Vec<[Pos2; 2]> =
            columns.iter().map(|&(x, range)| [pos2(x, range.max), pos2(x, range.min)]).collect();
        outlined(&columns, fill, stroke, strokes);
    }

    pub(crate) fn band(&self, rungs: &[Rung], color: Color32, with_outline: bool, strokes: &mut Strokes) {
        let at = |rung: &Rung| [self.at(rung.time, rung.low), self.at(rung.time, rung.high)];
        let columns: Vec<[Pos2; 2]> = rungs.iter().map(at).collect();
        let fill = color.gamma_multiply(0.22);
        if with_outline {
            outlined(&columns, fill, Stroke::new(0.7, color.gamma_multiply(0.6)), strokes);
        } else {
            strokes.area(&columns, fill);
        }
    }
}

fn outlined(columns: &[[Pos2; 2]], fill: Color32, outline: Stroke, strokes: &mut Strokes) {
    strokes.area(columns, fill);
    for end in 0..2 {
        let edge: Vec<Pos2> = columns.iter().map(|ends| ends[end]).collect();
        strokes.line(&edge, outline);
    }
}
