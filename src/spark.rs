//! The shape of a series of values in a small plot.

use egui::{Color32, Mesh, Painter, Pos2, Rect, Response, Sense, Shape, Stroke, Ui, Vec2, pos2, vec2};
use kalmanscope_core::FilterColor;

use crate::theme::Palette;

const WIDTH: usize = 120;
const HEIGHT: f32 = 30.0;

pub(crate) fn range(values: &[f64]) -> (f64, f64) {
    let there = values.iter().filter(|value| value.is_finite());
    there.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v)))
}

pub(crate) struct Spark {
    ranges: Vec<Option<(f32, f32)>>,
}

impl Spark {
    pub(crate) fn new(values: &[f64]) -> Self {
        Self::between(range(values), values)
    }

    pub(crate) fn between(bounds: (f64, f64), values: &[f64]) -> Self {
        Self::over(bounds, values.len(), |k| [values[k]; 2])
    }

    pub(crate) fn over((low, high): (f64, f64), len: usize, of: impl Fn(usize) -> [f64; 2]) -> Self {
        let span = if high > low { high - low } else { 1.0 };
        let chunk = len.div_ceil(WIDTH).max(1);
        let range = |begin: usize| {
            let there = (begin..len.min(begin + chunk)).flat_map(&of).filter(|value| value.is_finite());
            let shares = there.map(|value| ((value - low) / span).clamp(0.0, 1.0) as f32);
            shares.fold(None, |range: Option<(f32, f32)>, v| {
                Some(range.map_or((v, v), |(low, high)| (low.min(v), high.max(v))))
            })
        };
        Self { ranges: (0..len).step_by(chunk).map(range).collect() }
    }

    #[cfg(test)]
    pub(crate) fn is_flat(&self) -> bool {
        self.ranges.iter().flatten().all(|range| Some(range) == self.ranges.iter().flatten().next())
    }

    pub(crate) fn ui(&self, ui: &mut Ui, color: Color32) -> Response {
        let (response, painter) = ui.allocate_painter(Vec2::new(WIDTH as f32, HEIGHT), Sense::hover());
        self.paint(&painter, response.rect, color);
        response
    }

    pub(crate) fn paint(&self, painter: &Painter, rect: Rect, color: Color32) {
        painter.line(self.ends(rect).collect(), Stroke::new(1.3, color));
    }

    fn ends(&self, rect: Rect) -> impl Iterator<Item = Pos2> {
        let step = rect.width() / self.ranges.len().max(1) as f32;
        let there = self.ranges.iter().enumerate().filter_map(|(place, range)| Some((place, (*range)?)));
        there.flat_map(move |(place, (low, high))| {
            let x = rect.left() + (place as f32 + 0.5) * step;
            [low, high].map(|share| pos2(x, rect.bottom() - share * rect.height()))
        })
    }
}

#[derive(Clone, Copy)]
pub(crate) enum SparkInk {
    Text,
    Truth,
    Filter(FilterColor),
}

#[derive(Clone, Copy, PartialEq)]
pub(crate) enum SparkMark {
    Band,
    Line,
    Dots,
}

#[derive(Default)]
pub(crate) struct SparkPicture {
    pub(crate) courses: Vec<(SparkMark, SparkInk, Spark)>,
    pub(crate) cells: (usize, Vec<Color32>),
}

impl SparkPicture {
    pub(crate) fn paint(&self, painter: &Painter, rect: Rect, palette: &Palette) {
        let (up, colors) = &self.cells;
        let cell = rect.size() / vec2((colors.len() / up.max(&1)).max(1) as f32, *up as f32);
        let mut mesh = Mesh::default();
        for (place, color) in colors.iter().enumerate() {
            let at = vec2((place / up) as f32 * cell.x, -((place % up) as f32 + 1.0) * cell.y);
            mesh.add_colored_rect(Rect::from_min_size(rect.left_bottom() + at, cell), *color);
        }
        painter.add(mesh);
        for (mark, ink, spark) in &self.courses {
            let color = match ink {
                SparkInk::Text => palette.text,
                SparkInk::Truth => palette.truth.gamma_multiply(0.45),
                SparkInk::Filter(color) => palette.shade(*color),
            };
            match mark {
                SparkMark::Line => spark.paint(painter, rect, color),
                SparkMark::Dots => painter.extend(spark.ends(rect).map(|end| Shape::circle_filled(end, 1.1, color))),
                SparkMark::Band => {
                    // Triangles, since a polygon that is filled must be convex.
                    let mut mesh = Mesh::default();
                    for end in spark.ends(rect) {
                        mesh.colored_vertex(end, color.gamma_multiply(0.25));
                    }
                    for corner in (2..mesh.vertices.len() as u32).step_by(2) {
                        mesh.add_triangle(corner - 2, corner - 1, corner);
                        mesh.add_triangle(corner - 1, corner, corner + 1);
                    }
                    painter.add(mesh);
                }
            }
        }
    }
}
