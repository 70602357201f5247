//! What is painted over and under a chart's curves: missing readings, bad parts and jumps, labels of levels.

use std::ops::RangeInclusive;

use egui::{Align2, Color32, Rect, Shape, Stroke, TextStyle, Ui, pos2, vec2};
use egui_plot::{PlotBounds, PlotGeometry, PlotItem, PlotItemBase, PlotTransform};

use crate::session::Session;
use crate::theme::Palette;
use crate::trouble::Gap;
use crate::visibility::Visibility;

pub(super) trait Paint {
    fn shapes(&self, ui: &Ui, transform: &PlotTransform, shapes: &mut Vec<Shape>);
}

pub(super) struct Decoration<P> {
    base: PlotItemBase,
    paint: P,
}

impl<P: Paint> Decoration<P> {
    pub(super) fn new(name: &str, paint: P) -> Self {
        Self { base: PlotItemBase::new(name.to_owned()), paint }
    }
}

impl<P: Paint> PlotItem for Decoration<P> {
    fn shapes(&self, ui: &Ui, transform: &PlotTransform, shapes: &mut Vec<Shape>) {
        self.paint.shapes(ui, transform, shapes);
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

/// The height of a mark, and its width at least \[points\].
const MARK: (f32, f32) = (5.0, 2.0);

const GROUND: f32 = 0.45;

/// The distance between a mark and its words, and of words from each other \[points\].
const APART: f32 = 5.0;

/// The least height of a plot with words \[points\].
const ENOUGH: f32 = 80.0;

pub(super) struct Gaps {
    gaps: Vec<Gap>,
    worded: bool,
    colors: [Color32; 3],
}

impl Gaps {
    pub(super) fn of(gaps: &[Gap], worded: bool, palette: &Palette) -> Self {
        let colors = [palette.faint.gamma_multiply(GROUND), palette.weak, palette.ground.gamma_multiply(0.8)];
        Self { gaps: gaps.to_vec(), worded, colors }
    }
}

impl Paint for Gaps {
    fn shapes(&self, ui: &Ui, transform: &PlotTransform, shapes: &mut Vec<Shape>) {
        let frame = *transform.frame();
        let [shade, color, behind] = self.colors;
        let mut written_to = f32::NEG_INFINITY;
        for gap in &self.gaps {
            let (from, to) = gap.times;
            let [left, right] = [from, to].map(|time| transform.position_from_point_x(time));
            let whole = Rect::from_x_y_ranges(left..=right.max(left + MARK.1), frame.y_range()).intersect(frame);
            if !whole.is_positive() {
                continue;
            }
            shapes.push(Shape::rect_filled(whole, 0.0, shade));
            shapes.push(Shape::rect_filled(whole.with_min_y(frame.bottom() - MARK.0), 0.0, color));
            if !self.worded || frame.height() < ENOUGH {
                continue;
            }
            let galley = ui.painter().layout_no_wrap(gap.words(), TextStyle::Small.resolve(ui.style()), color);
            // Above the tags of times.
            let middle = frame.bottom() - 1.6 * galley.size().y;
            let after = Align2::LEFT_CENTER.anchor_size(pos2(whole.right() + APART, middle), galley.size());
            let before = Align2::RIGHT_CENTER.anchor_size(pos2(whole.left() - APART, middle), galley.size());
            let is_free = |rect: &Rect| {
                rect.left() >= written_to && frame.x_range().contains(rect.left()) && rect.right() <= frame.right()
            };
            if let Some(rect) = [after, before].into_iter().find(is_free) {
                written_to = rect.right().max(whole.right()) + APART;
                shapes.push(Shape::rect_filled(rect.expand2(vec2(2.0, 0.0)), 2.0, behind));
                shapes.push(Shape::galley(rect.min, galley, color));
            }
        }
    }
}

const HEIGHT: f32 = 4.0;

const OPACITY: f32 = 0.5;

/// Half the width of the triangle of a jump [points].
const JUMP: f32 = 4.5;

pub(super) struct Strips {
    /// The height of each strip in numbers of strips, its times \[s\] and its colour.
    strips: Vec<(f32, (f64, f64), Color32)>,
    /// The time of each jump \[s\] and its colour.
    jumps: Vec<(f64, Color32)>,
}

impl Strips {
    pub(super) fn of(session: &Session, visible: &Visibility, palette: &Palette) -> Self {
        let (mut strips, mut jumps) = (Vec::new(), Vec::new());
        let (run, record) = (session.run(), session.run().record());
        let shown = run.estimates().iter().enumerate().filter(|(_, estimates)| visible.filter(estimates.id()));
        for (_, estimates) in shown.clone() {
            let color = palette.shade(estimates.color());
            jumps.extend(estimates.jumps().map(|sample| (record.time_of(sample), color)));
        }
        for (row, (place, estimates)) in shown.enumerate().filter(|_| visible.verdicts) {
            let color = palette.shade(estimates.color()).gamma_multiply(OPACITY);
            let bad_parts = session.diagnosis(place).map_or(&[][..], |diagnosis| &diagnosis.bad_parts);
            strips.extend(
                bad_parts.iter().map(|part| (row as f32, (record.time(part.start), record.time(part.end)), color)),
            );
        }
        Self { strips, jumps }
    }
}

impl Paint for Strips {
    fn shapes(&self, _: &Ui, transform: &PlotTransform, shapes: &mut Vec<Shape>) {
        let frame = transform.frame();
        for (row, (from, to), color) in &self.strips {
            let [left, right] = [from, to].map(|time| transform.position_from_point_x(*time));
            let bottom = frame.bottom() - row * HEIGHT;
            let strip = Rect::from_min_max(pos2(left, bottom - HEIGHT), pos2(right, bottom)).intersect(*frame);
            if strip.is_positive() {
                shapes.push(Shape::rect_filled(strip, 0.0, *color));
            }
        }
        for (time, color) in &self.jumps {
            let x = transform.position_from_point_x(*time);
            if frame.x_range().contains(x) {
                let [left, right, top] = [(-1.0, 0.0), (1.0, 0.0), (0.0, -1.8)]
                    .map(|(across, up)| pos2(x + across * JUMP, frame.bottom() + up * JUMP));
                shapes.push(Shape::convex_polygon(vec![left, top, right], *color, Stroke::NONE));
            }
        }
    }
}

/// The distance of a label from the right edge and from its line \[points\].
const LABEL_GAP: (f32, f32) = (4.0, 1.0);

pub(super) struct Labels {
    labels: Vec<(f64, &'static str, Color32)>,
    middle: f64,
}

impl Labels {
    pub(super) fn new(labels: Vec<(f64, &'static str, Color32)>) -> Self {
        let middle = labels.iter().map(|(value, ..)| value).sum::<f64>() / labels.len().max(1) as f64;
        Self { labels, middle }
    }
}

impl Paint for Labels {
    fn shapes(&self, ui: &Ui, transform: &PlotTransform, shapes: &mut Vec<Shape>) {
        let frame = *transform.frame();
        for &(value, text, color) in &self.labels {
            let y = transform.position_from_point_y(value);
            let galley = ui.painter().layout_no_wrap(text.to_owned(), TextStyle::Small.resolve(ui.style()), color);
            let below = (Align2::RIGHT_TOP, LABEL_GAP.1);
            let above = (Align2::RIGHT_BOTTOM, -LABEL_GAP.1);
            let places = if value < self.middle { [below, above] } else { [above, below] };
            let rects =
                places.map(|(align, gap)| align.anchor_size(pos2(frame.right() - LABEL_GAP.0, y + gap), galley.size()));
            if let Some(rect) = rects.into_iter().find(|rect| frame.contains_rect(*rect)) {
                shapes.push(Shape::galley(rect.min, galley, color));
            }
        }
    }
}
