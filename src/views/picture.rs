//! Everything that a chart draws, as one item of the plot.

use std::ops::RangeInclusive;

use egui::mutex::Mutex;
use egui::{Color32, Context, Pos2, Rangef, Rect, Shape, Stroke, Ui, pos2};
use egui_plot::{GridMark, PlotBounds, PlotGeometry, PlotItem, PlotItemBase, PlotPoint, PlotTransform};

use super::layer::{DrawnLayer, Rung};
use super::pen::Pen;
use super::ticks::{log_tick, log_ticks, ticks};

/// How far outside the plot things are drawn at most \[points\]: the plot cuts them off, but numbers that are too large would
/// not survive on the way there.
const OUTSIDE: f32 = 4000.0;

/// Dash and gap \[points\].
const DASH: (f32, f32) = (5.0, 3.0);

/// Radius of a dot, and of one among few \[points\].
const DOT: f32 = 1.3;
const LARGE_DOT: f32 = 2.2;

/// Up to so many dots are few.
const FEW: usize = 300;

/// A chart's layers in the plot. That a point is transformed once, and nothing searched for under the pointer, is what it has
/// over an item for each.
pub(super) struct Picture<'a> {
    base: PlotItemBase,
    grid: Grid,
    layers: &'a [DrawnLayer],
    painted: &'a Painted,
}

/// The lines at round numbers and at the left and lower edge, below everything else.
#[derive(Clone, Copy)]
pub(super) struct Grid {
    /// So many of them there are at most, about, from left to right and from bottom to top.
    pub(super) counts: (f32, f32),
    /// Whether the values are logarithms, along an axis of this length \[points\].
    pub(super) logarithmic: Option<f32>,
    pub(super) color: Color32,
}

impl Grid {
    /// The marks on the vertical axis.
    pub(super) fn values(&self, bounds: (f64, f64)) -> Vec<GridMark> {
        match self.logarithmic {
            Some(length) => log_ticks(bounds, length, length / self.counts.1),
            None => ticks(bounds, self.counts.1),
        }
    }

    /// The marks on the horizontal axis.
    pub(super) fn times(&self, bounds: (f64, f64)) -> Vec<GridMark> {
        ticks(bounds, self.counts.0)
    }

    fn paint(&self, stage: &Stage, transform: &PlotTransform, pen: &mut Pen) {
        let (frame, bounds) = (transform.frame(), transform.bounds());
        let [times, values] = [0, 1].map(|axis| (bounds.min()[axis], bounds.max()[axis]));
        let stroke = |share: f32| Stroke::new(1.0, self.color.gamma_multiply(share));
        for mark in self.times(times) {
            let x = pen.on_a_pixel(stage.x(mark.value));
            pen.line(&[pos2(x, frame.top()), pos2(x, frame.bottom())], stroke(0.5));
        }
        for mark in self.values(values) {
            let y = pen.on_a_pixel(stage.y(mark.value));
            let share = if self.logarithmic.is_some() && log_tick(mark).is_empty() { 0.15 } else { 0.3 };
            pen.line(&[pos2(frame.left(), y), pos2(frame.right(), y)], stroke(share));
        }
        let (left, bottom) = (pen.on_a_pixel(frame.left() + 0.5), pen.on_a_pixel(frame.bottom() - 0.5));
        pen.line(&[pos2(left, frame.top()), pos2(left, bottom), pos2(frame.right(), bottom)], stroke(1.0));
    }
}

impl<'a> Picture<'a> {
    /// `painted` is what the last picture of the same layers has left.
    pub(super) fn new(grid: Grid, layers: &'a [DrawnLayer], painted: &'a Painted) -> Self {
        Self { base: PlotItemBase::new("picture".to_owned()), grid, layers, painted }
    }

    fn paint(&self, ctx: &Context, transform: &PlotTransform) -> Vec<Shape> {
        let stage = Stage::new(transform);
        let mut shapes = Vec::new();
        let mut pen = Pen::new(ctx);
        self.grid.paint(&stage, transform, &mut pen);
        for layer in self.layers {
            match layer {
                DrawnLayer::Band { parts, color, steep } => {
                    parts.iter().for_each(|rungs| stage.band(rungs, *color, !steep, &mut pen));
                }
                DrawnLayer::Dots { points, color } => {
                    let radius = if points.len() > FEW { DOT } else { LARGE_DOT };
                    let below = std::mem::replace(&mut pen, Pen::new(ctx));
                    shapes.push(below.into_shape());
                    shapes.extend(
                        points.iter().map(|point| Shape::circle_filled(stage.at(point.x, point.y), radius, *color)),
                    );
                }
                DrawnLayer::Line { points, color, width, dense: true, dashed: false } => {
                    stage.covered(points, Stroke::new(*width, *color), &mut pen);
                }
                DrawnLayer::Line { points, color, width, dashed, .. } => {
                    stage.line(points, Stroke::new(*width, *color), *dashed, &mut pen);
                }
                DrawnLayer::Level { value, color } => {
                    let (frame, y) = (transform.frame(), stage.y(*value));
                    if frame.y_range().contains(y) {
                        let ends = [pos2(frame.left(), y), pos2(frame.right(), y)];
                        pen.dashed(&ends, Stroke::new(1.0, *color), DASH);
                    }
                }
            }
        }
        shapes.push(pen.into_shape());
        shapes
    }
}

/// What layers have come to on screen, and where: as long as it is the same place nothing need be painted again.
#[derive(Default)]
pub(super) struct Painted(Mutex<Option<(Place, Vec<Shape>)>>);

/// Where a plot is, what it shows, and the size of a pixel.
type Place = (Rect, [f64; 2], [f64; 2], f32);

impl PlotItem for Picture<'_> {
    fn shapes(&self, ui: &Ui, transform: &PlotTransform, shapes: &mut Vec<Shape>) {
        let bounds = transform.bounds();
        let place = (*transform.frame(), bounds.min(), bounds.max(), ui.pixels_per_point());
        let mut painted = self.painted.0.lock();
        if painted.as_ref().is_none_or(|(before, _)| *before != place) {
            *painted = Some((place, self.paint(ui.ctx(), transform)));
        }
        shapes.extend(painted.iter().flat_map(|(_, shapes)| shapes.iter().cloned()));
    }

    fn initialize(&mut self, _: RangeInclusive<f64>) {}

    fn color(&self) -> Color32 {
        Color32::TRANSPARENT
    }

    fn allow_hover(&self) -> bool {
        false
    }

    fn geometry(&self) -> PlotGeometry<'_> {
        PlotGeometry::None
    }

    /// The chart sets the plot's bounds.
    fn bounds(&self) -> PlotBounds {
        PlotBounds::NOTHING
    }

    fn base(&self) -> &PlotItemBase {
        &self.base
    }

    fn base_mut(&mut self) -> &mut PlotItemBase {
        &mut self.base
    }
}

/// Where values stand on screen.
struct Stage {
    /// Screen position of the value at the middle of the plot, that value, and points per unit; for each axis.
    x: [f64; 3],
    y: [f64; 3],
    /// What is kept of the vertical axis.
    seen: (f32, f32),
}

impl Stage {
    fn new(transform: &PlotTransform) -> Self {
        let frame = transform.frame();
        let [per_x, per_y] = transform.dpos_dvalue();
        let middle = transform.bounds().center();
        Self {
            x: [f64::from(transform.position_from_point_x(middle.x)), middle.x, per_x],
            y: [f64::from(transform.position_from_point_y(middle.y)), middle.y, per_y],
            seen: (frame.top() - OUTSIDE, frame.bottom() + OUTSIDE),
        }
    }

    fn x(&self, value: f64) -> f32 {
        let [position, middle, per_unit] = self.x;
        (position + (value - middle) * per_unit) as f32
    }

    fn y(&self, value: f64) -> f32 {
        let [position, middle, per_unit] = self.y;
        ((position + (value - middle) * per_unit) as f32).clamp(self.seen.0, self.seen.1)
    }

    fn at(&self, x: f64, y: f64) -> Pos2 {
        pos2(self.x(x), self.y(y))
    }

    fn line(&self, points: &[PlotPoint], stroke: Stroke, dashed: bool, pen: &mut Pen) {
        let path: Vec<Pos2> = points.iter().map(|point| self.at(point.x, point.y)).collect();
        if dashed { pen.dashed(&path, stroke, DASH) } else { pen.line(&path, stroke) }
    }

    /// What a line covers that goes up and down in every pixel column.
    fn covered(&self, points: &[PlotPoint], stroke: Stroke, pen: &mut Pen) {
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
        // What is under it is still seen.
        let fill = stroke.color.gamma_multiply(0.8);
        let columns: Vec<[Pos2; 2]> =
            columns.iter().map(|&(x, range)| [pos2(x, range.max), pos2(x, range.min)]).collect();
        outlined(&columns, fill, stroke, pen);
    }

    fn band(&self, rungs: &[Rung], color: Color32, with_outline: bool, pen: &mut Pen) {
        let at = |rung: &Rung| [self.at(rung.time, rung.low), self.at(rung.time, rung.high)];
        let columns: Vec<[Pos2; 2]> = rungs.iter().map(at).collect();
        let fill = color.gamma_multiply(0.22);
        if with_outline {
            outlined(&columns, fill, Stroke::new(0.7, color.gamma_multiply(0.6)), pen);
        } else {
            pen.area(&columns, fill);
        }
    }
}

/// Fills what is between the ends of columns, and draws a line along both.
fn outlined(columns: &[[Pos2; 2]], fill: Color32, outline: Stroke, pen: &mut Pen) {
    pen.area(columns, fill);
    for end in 0..2 {
        let edge: Vec<Pos2> = columns.iter().map(|ends| ends[end]).collect();
        pen.line(&edge, outline);
    }
}
