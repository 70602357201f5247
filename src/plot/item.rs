//! A chart's drawing as one plot item.

use egui::mutex::Mutex;
use egui::{Context, Rect, Shape, Stroke, Ui, pos2};
use egui_plot::PlotTransform;

use super::decoration::Paint;
use super::grid::Grid;
use super::marks::Mark;
use super::projection::{DASH, Projection};
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
