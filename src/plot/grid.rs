//! The grid of a chart: lines at round numbers, and its left and lower edge.

use egui::{Color32, Stroke, pos2};
use egui_plot::{GridMark, PlotTransform};

use super::projection::Projection;
use super::strokes::Strokes;
use super::ticks::{log_tick, log_ticks, ticks};

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
