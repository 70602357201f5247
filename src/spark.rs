//! The shape of a series of values in a small plot.

use egui::{Color32, Mesh, Painter, Rect, Response, Sense, Ui, Vec2};

const WIDTH: usize = 120;
const HEIGHT: f32 = 30.0;

pub(crate) fn range(values: &[f64]) -> (f64, f64) {
    let there = values.iter().filter(|value| value.is_finite());
    there.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v)))
}

/// The lowest and the highest value of each column of pixels, from 0 at the bottom to 1 at the top.
pub(crate) struct Spark {
    ranges: Vec<Option<(f32, f32)>>,
}

impl Spark {
    pub(crate) fn new(values: &[f64]) -> Self {
        Self::between(range(values), values)
    }

    pub(crate) fn between((low, high): (f64, f64), values: &[f64]) -> Self {
        let span = if high > low { high - low } else { 1.0 };
        let chunk = values.len().div_ceil(WIDTH).max(1);
        let range = |chunk: &[f64]| {
            let there = chunk
                .iter()
                .filter(|value| value.is_finite())
                .map(|value| ((value - low) / span).clamp(0.0, 1.0) as f32);
            there.fold(None, |range: Option<(f32, f32)>, v| {
                Some(range.map_or((v, v), |(low, high)| (low.min(v), high.max(v))))
            })
        };
        Self { ranges: values.chunks(chunk).map(range).collect() }
    }

    pub(crate) fn ui(&self, ui: &mut Ui, color: Color32) -> Response {
        let (response, painter) = ui.allocate_painter(Vec2::new(WIDTH as f32, HEIGHT), Sense::hover());
        self.paint(&painter, response.rect, color);
        response
    }

    pub(crate) fn paint(&self, painter: &Painter, rect: Rect, color: Color32) {
        let rect = rect.shrink(1.0);
        let step = rect.width() / self.ranges.len().max(1) as f32;
        let height = |share: f32| rect.bottom() - share * rect.height();
        let mut mesh = Mesh::default();
        let mut before: Option<(f32, f32)> = None;
        for (place, range) in self.ranges.iter().enumerate() {
            if let Some((mut low, mut high)) = *range {
                // Neighbours touch, so that a slow course is a line.
                if let Some((below, above)) = before {
                    (low, high) = (low.min(above), high.max(below));
                }
                let x = rect.left() + (place as f32 + 0.5) * step;
                // Each column has its pixel where the course is flat: a segment or a rectangle would lose it by rounding.
                let (top, bottom) = (height(high) - 0.5, height(low) + 0.5);
                let half = 0.5 * step.max(1.0);
                mesh.add_colored_rect(Rect::from_x_y_ranges(x - half..=x + half, top..=bottom), color);
            }
            before = *range;
        }
        painter.add(mesh);
    }
}

pub(crate) struct Picture {
    pub(crate) course: Spark,
    pub(crate) truth: Option<Spark>,
}

impl Picture {
    pub(crate) fn paint(&self, painter: &Painter, rect: Rect, [color, faint]: [Color32; 2]) {
        self.truth.iter().for_each(|truth| truth.paint(painter, rect, faint));
        self.course.paint(painter, rect, color);
    }
}
