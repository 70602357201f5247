//! Lines at the pointer, at playback and at the marks A and B, with their times on the axis.

use egui::{
    Align2, Color32, CursorIcon, Id, PointerButton, Rect, Response, Sense, Shape, Stroke, TextStyle, Ui, pos2, vec2,
};
use egui_plot::PlotTransform;

use super::decoration::Paint;
use super::input::PlotInput;
use super::medium::Medium;
use super::projection::DASH;
use crate::request::Request;
use crate::ruler::End;
use crate::session::Mode;
use crate::text::fixed;

/// A mark is dragged from within this distance \[points\].
const GRIP: f32 = 6.0;

/// The room around a tag's text \[points\].
const PADDING: f32 = 3.0;

pub(super) struct Cursors {
    lines: Vec<CursorLine>,
    tagged: bool,
    ground: Color32,
}

struct CursorLine {
    /// \[s\]
    time: f64,
    text: String,
    color: Color32,
    dashed: bool,
}

impl Cursors {
    pub(super) fn of(input: &PlotInput<'_>, tagged: bool, medium: Medium) -> Self {
        let PlotInput { session, palette, axis, ruler, .. } = *input;
        let mut lines: Vec<CursorLine> = Vec::new();
        let mut add = |time: f64, letter: &str, color, dashed| {
            lines.push(CursorLine { time, text: format!("{letter}{}", time_text(input, time)), color, dashed });
        };
        for end in End::BOTH {
            if let Some(time) = ruler.time(end) {
                add(time, &format!("{} ", end.name()), palette.accent, false);
            }
        }
        // The newest sample of a growing record is where the lines end.
        if session.mode() == Mode::Whole && medium == Medium::Screen {
            add(session.time(), "", palette.weak, true);
        }
        if axis.pointed.is_some() {
            add(axis.shown_time(session), "", palette.weak, false);
        }
        Self { lines, tagged, ground: palette.ground }
    }
}

pub(super) fn time_text(input: &PlotInput<'_>, time: f64) -> String {
    let dt = input.session.run().record().dt();
    let decimals = (0..6).find(|&decimals| (dt * 10f64.powi(decimals)).round() >= 1.0).unwrap_or(6);
    fixed(time, decimals.max(2) as usize)
}

impl Paint for Cursors {
    fn shapes(&self, ui: &Ui, transform: &PlotTransform, shapes: &mut Vec<Shape>) {
        let frame = *transform.frame();
        // The last of them covers the others' tags.
        for (i, line) in self.lines.iter().enumerate() {
            let x = transform.position_from_point_x(line.time);
            if !frame.x_range().contains(x) {
                continue;
            }
            let x = (x * ui.ctx().pixels_per_point()).round() / ui.ctx().pixels_per_point();
            let [top, bottom] = [pos2(x, frame.top()), pos2(x, frame.bottom())];
            let stroke = Stroke::new(1.2, line.color);
            if line.dashed {
                shapes.extend(Shape::dashed_line(&[top, bottom], stroke, DASH.0, DASH.1));
            } else {
                shapes.push(Shape::line_segment([top, bottom], stroke));
            }
            let covered = self.lines[i + 1..].iter().any(|other| other.time == line.time);
            if self.tagged && !covered {
                self.tag(ui, line, x, frame, shapes);
            }
        }
    }
}

impl Cursors {
    fn tag(&self, ui: &Ui, line: &CursorLine, x: f32, frame: Rect, shapes: &mut Vec<Shape>) {
        let font = TextStyle::Small.resolve(ui.style());
        let galley = ui.painter().layout_no_wrap(line.text.clone(), font, self.ground);
        let size = galley.size() + 2.0 * vec2(PADDING, 0.0);
        let left = (x - 0.5 * size.x).clamp(frame.left(), (frame.right() - size.x).max(frame.left()));
        let rect = Rect::from_min_size(pos2(left, frame.bottom() - size.y), size);
        shapes.push(Shape::rect_filled(rect, 2.0, line.color));
        shapes.push(Shape::galley(
            Align2::CENTER_CENTER.anchor_size(rect.center(), galley.size()).min,
            galley,
            self.ground,
        ));
    }
}

/// A click on the line of a filter, `under`, selects that filter; elsewhere it goes to a time, with Shift it sets a mark. Marks
/// are dragged.
pub(super) fn cursor_gestures(
    ui: &Ui,
    key: &str,
    (response, under): (&Response, Option<u32>),
    transform: &PlotTransform,
    input: &PlotInput<'_>,
    requests: &mut Vec<Request>,
) {
    let record = input.session.run().record();
    let time_at = |x: f32| {
        let time = transform.value_from_position(pos2(x, transform.frame().center().y)).x;
        record.time(input.session.sample_at(time))
    };
    if let Some(pointer) = response.interact_pointer_pos().filter(|_| response.clicked_by(PointerButton::Primary)) {
        let time = time_at(pointer.x);
        let marks = ui.input(|input| input.modifiers.shift);
        requests.push(match under {
            _ if marks => Request::MarkTime(time),
            Some(filter) => Request::Diagnose(filter),
            None => Request::Seek(time - record.time_of(0)),
        });
    }
    for end in End::BOTH {
        let Some(time) = input.ruler.time(end) else { continue };
        let x = transform.position_from_point_x(time);
        if !transform.frame().x_range().contains(x) {
            continue;
        }
        let grip = Rect::from_x_y_ranges(x - GRIP..=x + GRIP, transform.frame().y_range());
        let grip = ui.interact(grip, Id::unique(("mark", key, end as u8)), Sense::drag());
        let grip = grip.on_hover_cursor(CursorIcon::ResizeHorizontal);
        if let Some(pointer) = grip.interact_pointer_pos().filter(|_| grip.dragged()) {
            requests.push(Request::PlaceMark(end, time_at(pointer.x)));
        }
    }
}
