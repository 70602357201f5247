//! A chart's drawing as one plot item.

use std::ops::Range;

use egui::mutex::Mutex;
use egui::{Color32, Context, Pos2, Rangef, Rect, Shape, Stroke, Ui, pos2};
use egui_plot::{GridMark, PlotPoint, PlotTransform, PlotUi};
use kalmanscope_core::Record;

use super::axes::{log_tick, log_ticks, ticks};
use super::coinciding::drawn_runs;
use super::decoration::{Decoration, Paint};
use super::layers::{Layer, LayerColumns, Window, unbroken, value_range};
use super::marks::{Mark, Rung};
use super::strokes::Strokes;

/// Radius of a dot, and of a dot among few \[points\].
const DOT: f32 = 1.3;
const LARGE_DOT: f32 = 2.2;

/// Limits the number of dots that are large.
const FEW: usize = 300;

pub(crate) struct DrawingItem<'a> {
    grid: Grid,
    marks: &'a [Mark],
    painted: &'a PaintedShapes,
}

impl<'a> DrawingItem<'a> {
    /// `painted` keeps the shapes of the last frame.
    pub(crate) fn new(grid: Grid, marks: &'a [Mark], painted: &'a PaintedShapes) -> Self {
        Self { grid, marks, painted }
    }

    fn paint(&self, ctx: &Context, transform: &PlotTransform) -> Vec<Shape> {
        let projection = Projection::new(transform);
        let mut shapes = Vec::new();
        let mut strokes = Strokes::new(ctx);
        self.grid.paint(&projection, transform, &mut strokes);
        for mark in self.marks {
            match mark {
                Mark::Band { parts, color, steep, .. } => {
                    parts.iter().for_each(|rungs| projection.band(rungs, *color, !steep, &mut strokes));
                }
                Mark::Dots { points, color } => {
                    let radius = if points.len() > FEW { DOT } else { LARGE_DOT };
                    let below = std::mem::replace(&mut strokes, Strokes::new(ctx));
                    shapes.push(below.into_shape());
                    shapes.extend(
                        points
                            .iter()
                            .map(|point| Shape::circle_filled(projection.at(point.x, point.y), radius, *color)),
                    );
                }
                Mark::Line { points, color, width, dense: true, dashed: false, .. } => {
                    projection.dense_line(points, Stroke::new(*width, *color), &mut strokes);
                }
                Mark::Line { points, color, width, dashed, .. } => {
                    projection.line(points, Stroke::new(*width, *color), *dashed, &mut strokes);
                }
                Mark::Level { value, color } => {
                    let (frame, y) = (transform.frame(), projection.y(*value));
                    if frame.y_range().contains(y) {
                        let ends = [pos2(frame.left(), y), pos2(frame.right(), y)];
                        strokes.dashed(&ends, Stroke::new(1.0, *color), DASH);
                    }
                }
            }
        }
        shapes.push(strokes.into_shape());
        shapes
    }
}

#[derive(Default)]
pub(crate) struct PaintedShapes(Mutex<Option<(Place, Vec<Shape>)>>);

/// The plot's position and range, and the size of a pixel.
type Place = (Rect, [f64; 2], [f64; 2], f32);

impl Paint for DrawingItem<'_> {
    fn shapes(&self, ui: &Ui, transform: &PlotTransform, shapes: &mut Vec<Shape>) {
        let bounds = transform.bounds();
        let place = (*transform.frame(), bounds.min(), bounds.max(), ui.pixels_per_point());
        let mut painted = self.painted.0.lock();
        if painted.as_ref().is_none_or(|(before, _)| *before != place) {
            *painted = Some((place, self.paint(ui.ctx(), transform)));
        }
        shapes.extend(painted.iter().flat_map(|(_, shapes)| shapes.iter().cloned()));
    }
}

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

#[derive(Clone, Copy)]
pub(crate) struct Grid {
    pub(crate) counts: (f32, f32),
    /// For logarithms, the length of the axis \[points\].
    pub(crate) logarithmic: Option<f32>,
    pub(crate) color: Color32,
}

impl Grid {
    pub(crate) fn values(&self, bounds: (f64, f64)) -> Vec<GridMark> {
        match self.logarithmic {
            Some(length) => log_ticks(bounds, length, length / self.counts.1),
            None => ticks(bounds, self.counts.1),
        }
    }

    pub(crate) fn times(&self, bounds: (f64, f64)) -> Vec<GridMark> {
        ticks(bounds, self.counts.0)
    }

    pub(crate) fn paint(&self, projection: &Projection, transform: &PlotTransform, strokes: &mut Strokes) {
        let (frame, bounds) = (transform.frame(), transform.bounds());
        let [times, values] = [0, 1].map(|axis| (bounds.min()[axis], bounds.max()[axis]));
        let stroke = |share: f32| Stroke::new(1.0, self.color.gamma_multiply(share));
        for mark in self.times(times) {
            let x = strokes.on_a_pixel(projection.x(mark.value));
            strokes.line(&[pos2(x, frame.top()), pos2(x, frame.bottom())], stroke(0.5));
        }
        for mark in self.values(values) {
            let y = strokes.on_a_pixel(projection.y(mark.value));
            let share = if self.logarithmic.is_some() && log_tick(mark).is_empty() { 0.15 } else { 0.3 };
            strokes.line(&[pos2(frame.left(), y), pos2(frame.right(), y)], stroke(share));
        }
        let (left, bottom) = (strokes.on_a_pixel(frame.left() + 0.5), strokes.on_a_pixel(frame.bottom() - 0.5));
        strokes.line(&[pos2(left, frame.top()), pos2(left, bottom), pos2(frame.right(), bottom)], stroke(1.0));
    }
}

#[derive(Default)]
pub(crate) struct Drawing {
    pub(super) marks: Vec<Mark>,
    painted: PaintedShapes,
    pub(crate) range: Option<(f64, f64)>,
}

impl Drawing {
    pub(crate) fn new(layers: &[Layer<'_>], record: &Record, window: &Window, least: Option<(f64, f64)>) -> Self {
        let columns: Vec<LayerColumns> = layers.iter().map(|layer| LayerColumns::new(layer, record, window)).collect();
        let range = value_range(layers.iter().zip(&columns), least);
        // Without a range there are no values to draw.
        let marks = window.scale(range).map_or(Vec::new(), |scale| {
            let runs = drawn_runs(layers, &columns, record, scale);
            let of_layer = |((layer, columns), runs): ((&Layer<'_>, &LayerColumns), Vec<Range<usize>>)| {
                let parts = runs.into_iter().flat_map(|run| unbroken(columns, run));
                parts.filter_map(|run| Mark::new(layer, columns, run, record, scale)).collect::<Vec<_>>()
            };
            layers.iter().zip(&columns).zip(runs).flat_map(of_layer).collect()
        });
        Self { range, marks, painted: PaintedShapes::default() }
    }

    pub(crate) fn show<'a>(&'a self, grid: Grid, plot: &mut PlotUi<'a>) {
        plot.add(Decoration::new("drawing", DrawingItem::new(grid, &self.marks, &self.painted)));
    }
}
