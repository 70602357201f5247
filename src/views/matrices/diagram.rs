//! A step as a flow: five boxes with their Gaussians, and arrows with their numbers.

use egui::epaint::{BandPoint, BandShape};
use egui::{
    Align2, Color32, FontId, Painter, Pos2, Rect, Sense, Shape, Stroke, StrokeKind, TextStyle, Ui, Vec2, WidgetInfo,
    pos2, vec2,
};

use super::step::{FilterStep, Normal, StepResult};
use crate::spark::range;
use crate::text::significant;
use crate::theme::Palette;

/// Limits the width below which the boxes stand in a column, and that of the flow \[points\].
const ROW: f32 = 660.0;
const WIDEST: f32 = 1100.0;

/// The height of a box's picture and its distance from the edges \[points\]; that of a line of text, relative to the text's size.
const PICTURE: f32 = 58.0;
const INSET: f32 = 7.0;
const LINE: f32 = 1.3;

/// The length of an arrow in a row as a share of the width, and in a column in lines; the size of its head \[points\].
const ARROW: f32 = 0.085;
const DROP: f32 = 1.7;
const HEAD: f32 = 4.0;

/// The reach of a curve to both sides \[standard deviations\].
const REACH: f64 = 3.0;

struct Bell<'a> {
    normal: Normal,
    color: Color32,
    is_filled: bool,
    dots: &'a [f64],
}

struct FlowBox<'a> {
    title: &'static str,
    lines: [String; 2],
    bells: Vec<Bell<'a>>,
    truth: Option<f64>,
}

pub(super) struct Diagram<'a> {
    pub(super) step: &'a FilterStep,
    pub(super) name: &'a str,
    pub(super) color: Color32,
    pub(super) palette: &'a Palette,
    /// The text of a result, or a sign that it is still to be filled in.
    pub(super) shown: &'a dyn Fn(StepResult, String) -> String,
}

impl Diagram<'_> {
    pub(super) fn ui(&self, ui: &mut Ui) {
        let width = ui.available_width().min(WIDEST);
        let font = TextStyle::Small.resolve(ui.style());
        let (is_row, line) = (width >= ROW, LINE * font.size);
        let text = INSET + 3.0 * line;
        // In a row the measurement comes from above, and the prediction continues below.
        let (size, way, begin) = if is_row {
            let size = vec2(width * (1.0 - 4.0 * ARROW) / 5.0, text + PICTURE + 2.0 * INSET);
            (size, vec2(size.x + ARROW * width, 0.0), 2.0 * line)
        } else {
            (vec2(width, text + INSET), vec2(0.0, text + INSET + DROP * line), 0.0)
        };
        let height = begin + size.y + 4.0 * way.y + if is_row { 1.5 * line } else { 0.0 };
        let (area, response) = ui.allocate_exact_size(vec2(width, height), Sense::hover());
        let pen =
            Pen { painter: ui.painter_at(area.expand(2.0)), font, line, palette: self.palette, color: self.color };
        let place = |i: usize| Rect::from_min_size(area.min + vec2(0.0, begin) + i as f32 * way, size);
        let is_read = self.step.update.is_some();
        let boxes = self.boxes();
        for (i, one) in boxes.iter().enumerate() {
            pen.flow_box(one, place(i), is_row, is_read || !(2..4).contains(&i));
            if i == 3 {
                pen.shares(self.step, pen.picture(place(i), is_row));
            }
        }
        let arrows = self.arrows();
        for (i, [above, below]) in arrows[..4].iter().enumerate() {
            let ([from, to], is_read) = ([i, i + 1].map(place), is_read || i == 0);
            let gap = from.union(to).center();
            if is_row {
                pen.arrow(&[from.right_center(), to.left_center()], is_read);
                pen.text(gap - vec2(0.0, 3.0), Align2::CENTER_BOTTOM, above, is_read);
                pen.text(gap + vec2(0.0, 3.0), Align2::CENTER_TOP, below, is_read);
            } else {
                let x = from.left() + 0.2 * size.x;
                pen.arrow(&[pos2(x, from.bottom()), pos2(x, to.top())], is_read);
                let z = if i == 1 { arrows[4].join(" ") } else { String::new() };
                let words = format!("{above} {below}   {z}").replace('\n', "   ");
                pen.text(pos2(x + 10.0, gap.y), Align2::LEFT_CENTER, &words, is_read);
            }
        }
        if is_row {
            let top = place(2).center_top();
            pen.arrow(&[top - vec2(0.0, 1.8 * line), top], is_read);
            pen.text(top + vec2(8.0, -1.1 * line), Align2::LEFT_CENTER, &arrows[4].join(" "), is_read);
            let ([from, to], down) = ([1, 4].map(|i| place(i).center_bottom()), vec2(0.0, line));
            pen.arrow(&[from, from + down, to + down, to], true);
        }
        let [before, _, e, k, after] = boxes.each_ref().map(|one| &one.lines[0]);
        let words = format!("Flow of {}: {before}, {e}, {k}, then {after}", self.name);
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, &words));
    }

    fn boxes(&self) -> [FlowBox<'_>; 5] {
        use StepResult::{Gain, Innovation, InnovationVariance, Mean, PredictedMean, PredictedVariance, Variance};
        let Self { step, palette, color, shown, .. } = *self;
        let ([prior, ahead, after], y, truth) = (step.beliefs, step.channel.symbol(), step.truth);
        let (soft, grey, faint) = (color.gamma_multiply(0.65), palette.weak, palette.weak.gamma_multiply(0.6));
        let points = |which: usize| step.spread.as_ref().map_or(&[][..], |spread| &spread.points[which][..]);
        let full = |normal, color, dots| Bell { normal, color, is_filled: true, dots };
        let line = |normal, color| Bell { normal, color, is_filled: false, dots: &[] };
        let texts = |normal: Normal| [step.digits[0].text(normal.mean), significant(normal.std(), 3)];
        let belief = |mark: &str, [mean, std]: [String; 2]| [format!("{y}{mark} = {mean}"), format!("σ{mark} = {std}")];
        let result = |normal: Normal, of: [StepResult; 2]| {
            let [mean, std] = texts(normal);
            [shown(of[0], mean), shown(of[1], std)]
        };
        let (mut innovation, mut gain, mut readings) =
            (["no reading".to_owned(), String::new()], Default::default(), vec![]);
        if let Some(update) = &step.update {
            let std = shown(InnovationVariance, significant(update.expected.std(), 3));
            innovation = [format!("e = {}", shown(Innovation, update.innovation())), format!("√S = {std}")];
            gain = [format!("K = {}", shown(Gain, significant(update.gain, 4))), String::new()];
            readings = vec![line(update.expected, soft), full(update.measured, grey, &[])];
        }
        let ahead_lines = belief("⁻", result(ahead, [PredictedMean, PredictedVariance]));
        let (predicted, posterior) = (full(ahead, soft, points(1)), full(after, color, &[]));
        let of = |title, lines, bells, truth| FlowBox { title, lines, bells, truth };
        [
            of("Before", belief("", texts(prior)), vec![full(prior, grey, points(0))], truth[0]),
            of("Prediction", ahead_lines, vec![line(prior, faint), predicted], truth[1]),
            of("Innovation", innovation, readings, None),
            of("Gain", gain, Vec::new(), None),
            of("After", belief("", result(after, [Mean, Variance])), vec![line(ahead, faint), posterior], truth[1]),
        ]
    }

    /// The words above and below each arrow, the measurement's last.
    fn arrows(&self) -> [[String; 2]; 5] {
        let Self { step, shown, .. } = *self;
        let way = step.spread.as_ref().map_or_else(String::new, |spread| match spread.points[0].len() {
            0 => format!("Φ {}", significant(spread.slope, 4)),
            count => format!("{count} points"),
        });
        let noise = format!("+ Q\n{}", step.process.map_or_else(String::new, |process| significant(process, 3)));
        let Some(update) = &step.update else {
            return [[way, noise], Default::default(), Default::default(), Default::default(), Default::default()];
        };
        let [r, s] = update.digits;
        let shift = step.digits[0].text(step.beliefs[2].mean - step.beliefs[1].mean);
        [
            [way, noise],
            ["h(y⁻)".to_owned(), r.text(update.expected.mean)],
            ["S".to_owned(), shown(StepResult::InnovationVariance, s.text(update.expected.variance))],
            ["+ K e".to_owned(), shown(StepResult::Shift, shift)],
            ["z =".to_owned(), r.text(update.measured.mean)],
        ]
    }
}

struct Pen<'a> {
    painter: Painter,
    font: FontId,
    line: f32,
    palette: &'a Palette,
    color: Color32,
}

impl Pen<'_> {
    fn text(&self, at: Pos2, align: Align2, text: &str, is_there: bool) {
        self.painter.text(
            at,
            align,
            text,
            self.font.clone(),
            if is_there { self.palette.text } else { self.palette.weak },
        );
    }

    fn arrow(&self, points: &[Pos2], is_there: bool) {
        let color = if is_there { self.palette.weak } else { self.palette.separator };
        let [.., before, end] = points else { return };
        let way = HEAD * (*end - *before).normalized();
        self.painter.line(points.to_vec(), Stroke::new(1.2, color));
        let head = vec![*end, *end - 2.0 * way + way.rot90(), *end - 2.0 * way - way.rot90()];
        self.painter.add(Shape::convex_polygon(head, color, Stroke::NONE));
    }

    fn picture(&self, rect: Rect, is_row: bool) -> Rect {
        let inside = rect.shrink(INSET);
        if is_row { inside.with_min_y(inside.bottom() - PICTURE) } else { inside.with_min_x(inside.center().x) }
    }

    fn flow_box(&self, FlowBox { title, lines, bells, truth }: &FlowBox<'_>, rect: Rect, is_row: bool, is_there: bool) {
        let Self { painter, palette, line, font, .. } = self;
        let [edge, ink] = if is_there { [self.color; 2] } else { [palette.separator, palette.weak] };
        painter.rect(rect, 4.0, palette.ground, Stroke::new(1.2, edge), StrokeKind::Inside);
        let corner = rect.min + vec2(INSET, 0.5 * INSET);
        painter.text(corner, Align2::LEFT_TOP, title, font.clone(), ink);
        for (row, text) in (1..).zip(lines) {
            self.text(corner + vec2(0.0, row as f32 * line), Align2::LEFT_TOP, text, is_there);
        }
        if bells.is_empty() {
            return;
        }
        let picture = self.picture(rect, is_row);
        let ends = bells.iter().flat_map(|bell| [-REACH, REACH].map(|by| bell.normal.mean + by * bell.normal.std()));
        let all: Vec<f64> = ends.chain(bells.iter().flat_map(|bell| bell.dots).copied()).collect();
        let (low, high) = range(&all);
        let span = if high > low { high - low } else { 1.0 };
        let x = |value: f64| picture.left() + picture.width() * ((value - low) / span).clamp(0.0, 1.0) as f32;
        painter.hline(picture.x_range(), picture.bottom(), Stroke::new(1.0, palette.separator));
        for Bell { normal, color, is_filled, dots } in bells {
            let std = normal.std().max(0.002 * span);
            let height = |value: f64| (-0.5 * ((value - normal.mean) / std).powi(2)).exp() as f32;
            let at = |value: f64| pos2(x(value), picture.bottom() - 0.92 * picture.height() * height(value));
            let curve = (-24..=24).map(|i| at(normal.mean + f64::from(i) / 24.0 * REACH * std));
            let curve: Vec<Pos2> = curve.collect();
            if *is_filled {
                let points = curve.iter().map(|at| BandPoint::new(at.x, at.y..=picture.bottom())).collect();
                painter.add(BandShape::filled(points, color.gamma_multiply(0.22)));
            }
            painter.line(curve, Stroke::new(1.5, *color));
            for dot in *dots {
                painter.circle(at(*dot), 2.2, palette.ground, Stroke::new(1.2, palette.text));
            }
        }
        if let Some(truth) = truth.filter(|truth| (low..=high).contains(truth)) {
            let tick = (picture.bottom() - 9.0)..=(picture.bottom() + 3.0);
            painter.vline(x(truth), tick, Stroke::new(2.0, palette.truth));
        }
    }

    /// S as one bar: the part that the state's uncertainty gives, and the noise of the sensor.
    fn shares(&self, step: &FilterStep, picture: Rect) {
        let Some(update) = &step.update else { return };
        let share = (1.0 - update.measured.variance / update.expected.variance).clamp(0.0, 1.0) as f32;
        let bar = Rect::from_center_size(picture.center() + vec2(0.0, 0.4 * self.line), vec2(picture.width(), 12.0));
        let split = bar.with_max_x(bar.left() + if share.is_nan() { 0.0 } else { share } * bar.width());
        self.painter.rect_filled(bar, 0.0, self.palette.weak.gamma_multiply(0.35));
        self.painter.rect_filled(split, 0.0, self.color.gamma_multiply(0.65));
        for (at, align, words) in [
            (bar.left_top(), Align2::LEFT_BOTTOM, format!("P⁻ {:.0} %", 100.0 * share)),
            (bar.right_bottom() + 4.0 * Vec2::DOWN, Align2::RIGHT_TOP, format!("R {:.0} %", 100.0 * (1.0 - share))),
        ] {
            self.painter.text(at - Vec2::DOWN * 2.0, align, words, self.font.clone(), self.palette.weak);
        }
    }
}
