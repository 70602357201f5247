//! The past positions of the masses, as pens would draw them on a strip of paper that moves downwards.

use egui::{Align2, Color32, Painter, Pos2, Rect, Shape, Stroke, pos2, vec2};
use kalmanscope_core::Record;

use super::stage::Stage;
use crate::plot::strokes::Strokes;
use crate::theme::Palette;

/// Speed of the paper \[points/s\].
const SPEED: f32 = 64.0;

const POINTS: usize = 160;
const ALL_POINTS: usize = 2000;

pub(super) struct Trail<'a> {
    stage: &'a Stage,
    painter: Painter,
    paper: Rect,
    record: &'a Record,
    now: usize,
    first: usize,
    stride: usize,
}

impl<'a> Trail<'a> {
    pub(super) fn new(
        stage: &'a Stage,
        painter: &Painter,
        paper: Rect,
        record: &'a Record,
        now: usize,
        lines: usize,
    ) -> Self {
        let samples = (f64::from(paper.height() / SPEED) / record.dt()).min(1e7) as usize;
        let first = now.saturating_sub(samples);
        let points = (ALL_POINTS / lines.max(1)).clamp(POINTS / 2, POINTS);
        let stride = samples.div_ceil(points).max(1);
        Self { stage, painter: painter.with_clip_rect(paper), paper, record, now, first, stride }
    }

    /// The samples that are drawn, the newest first. The choice of samples does not change with time, so that
    /// lines do not shimmer.
    fn samples(&self) -> impl Iterator<Item = usize> {
        let Self { now, first, stride, .. } = *self;
        let older = (first / stride..now.div_ceil(stride)).rev().map(move |i| i * stride);
        std::iter::once(now).chain(older)
    }

    fn at(&self, mass: usize, x: f64, k: usize) -> Pos2 {
        let age = (self.record.time(self.now) - self.record.time(k)) as f32;
        pos2(self.stage.place(mass, x), self.paper.top() + SPEED * age)
    }

    pub(super) fn paper(&self, palette: &Palette) {
        let now = self.record.time(self.now);
        let Self { painter, paper, stage, .. } = self;
        let grid = Stroke::new(1.0, palette.grid.gamma_multiply(0.35));
        for mass in 0..stage.masses() {
            painter.vline(stage.rest(mass), paper.y_range(), grid);
        }
        // Multiplies instead of subtracting one by one: far from zero, subtracting a second changes nothing.
        let seconds = (0..=(paper.height() / SPEED).max(0.0) as usize).map(|age| now.floor() - age as f64);
        for second in seconds.take_while(|second| *second >= self.record.time(0)) {
            let y = paper.top() + SPEED * (now - second) as f32;
            painter.hline((stage.wall)..=(paper.right() - 8.0), y, grid);
            let at = pos2(stage.wall, y) + vec2(2.0, -1.0);
            let label = if second.abs() < 1e9 { format!("{second} s") } else { format!("{second:e} s") };
            painter.text(at, Align2::LEFT_BOTTOM, label, stage.font(), palette.weak);
        }
    }

    /// Draws the path of a mass with the displacement `x(k)` \[m\] at sample k.
    pub(super) fn line(&self, mass: usize, width: f32, color: Color32, x: impl Fn(usize) -> Option<f64>) {
        let at = |k| Some(self.at(mass, x(k).filter(|x| x.is_finite())?, k));
        let points: Vec<Pos2> = self.samples().filter_map(at).collect();
        let mut strokes = Strokes::new(self.painter.ctx());
        strokes.line(&points, Stroke::new(width * self.stage.unit.min(1.5), color));
        self.painter.add(strokes.into_shape());
    }

    /// Draws a band around a path; its middle and half width at sample k are `x(k)` \[m\].
    pub(super) fn band(&self, mass: usize, color: Color32, x: impl Fn(usize) -> Option<(f64, f64)>) {
        let at = |k| {
            let (middle, half) = x(k)?;
            Some([self.at(mass, middle - half, k), self.at(mass, middle + half, k)])
        };
        let edges: Vec<[Pos2; 2]> = self.samples().filter_map(at).collect();
        let mut strokes = Strokes::new(self.painter.ctx());
        strokes.area(&edges, color);
        self.painter.add(strokes.into_shape());
    }

    pub(super) fn dots(&self, mass: usize, readings: &[f64], color: Color32) {
        let dot = |k: usize| {
            let x = readings.get(k).filter(|x| x.is_finite())?;
            Some(Shape::circle_filled(self.at(mass, *x, k), 1.5, color))
        };
        self.painter.extend(self.samples().filter_map(dot));
    }
}
