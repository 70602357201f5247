//! The shape of a series of values in a small plot.

use egui::{Color32, Painter, Rect, Response, Sense, Shape, Stroke, Ui, Vec2, pos2};

/// The columns of pixels.
const WIDTH: usize = 120;
const HEIGHT: f32 = 30.0;

/// The lowest and the highest value of each column of pixels, from 0 at the bottom to 1 at the top.
pub(crate) struct Spark {
    ranges: Vec<Option<(f32, f32)>>,
}

impl Spark {
    /// The shape of some values.
    pub(crate) fn new(values: &[f64]) -> Self {
        let there = values.iter().filter(|value| value.is_finite());
        let (low, high) = there.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v)));
        let span = if high > low { high - low } else { 1.0 };
        let chunk = values.len().div_ceil(WIDTH).max(1);
        let range = |chunk: &[f64]| {
            let there = chunk.iter().filter(|value| value.is_finite()).map(|value| ((value - low) / span) as f32);
            there.fold(None, |range: Option<(f32, f32)>, v| {
                Some(range.map_or((v, v), |(low, high)| (low.min(v), high.max(v))))
            })
        };
        Self { ranges: values.chunks(chunk).map(range).collect() }
    }

    /// Draws it.
    pub(crate) fn ui(&self, ui: &mut Ui, color: Color32) -> Response {
        let (response, painter) = ui.allocate_painter(Vec2::new(WIDTH as f32, HEIGHT), Sense::hover());
        self.paint(&painter, response.rect, color);
        response
    }

    /// Draws it into a rectangle.
    pub(crate) fn paint(&self, painter: &Painter, rect: Rect, color: Color32) {
        let rect = rect.shrink(1.0);
        let step = rect.width() / self.ranges.len().max(1) as f32;
        let height = |share: f32| rect.bottom() - share * rect.height();
        let mut before: Option<(f32, f32)> = None;
        for (place, range) in self.ranges.iter().enumerate() {
            if let Some((mut low, mut high)) = *range {
                // Neighbours touch, so that a slow course is a line.
                if let Some((below, above)) = before {
                    (low, high) = (low.min(above), high.max(below));
                }
                let x = rect.left() + (place as f32 + 0.5) * step;
                let ends = [pos2(x, height(low) + 0.5), pos2(x, height(high) - 0.5)];
                painter.add(Shape::line_segment(ends, Stroke::new(step.max(1.0), color)));
            }
            before = *range;
        }
    }
}
