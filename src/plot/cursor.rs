//! Lines at the pointer, at playback and at the marks A and B, with their times on the axis.

use egui::{
    Align2, Color32, CursorIcon, Id, LayerId, Order, PointerButton, Pos2, Rect, Response, Sense, Shape, Stroke,
    TextStyle, Ui, pos2, vec2,
};
use egui_plot::{PlotPoint, PlotTransform};

use super::heading::Readout;
use super::layers::Mark;
use super::medium::Medium;
use super::time_axis::PlotInput;
use crate::request::Request;
use crate::ruler::RulerEnd;
use crate::session::Mode;
use crate::text::fixed;

const GRIP: f32 = 6.0;

const PADDING: f32 = 3.0;

pub(super) struct Cursors {
    lines: Vec<CursorLine>,
    tagged: bool,
    ground: Color32,
}

struct CursorLine {
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
        for end in RulerEnd::BOTH {
            if let Some(time) = ruler.time(end) {
                add(time, &format!("{} ", end.name()), palette.accent, false);
            }
        }
        // The newest sample of a growing record is where the lines end.
        if session.mode() == Mode::Whole && medium != Medium::Figure {
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

impl Cursors {
    pub(super) fn shapes(&self, ui: &Ui, transform: &PlotTransform, shapes: &mut Vec<Shape>) {
        let frame = *transform.frame();
        // The last of them covers the others' tags.
        for (i, line) in self.lines.iter().enumerate() {
            let x = transform.position_from_point_x(line.time);
            if !frame.x_range().contains(x) {
                continue;
            }
            // A thin line between two pixels would be blurred, and flicker while it moves.
            let x = (x * ui.ctx().pixels_per_point()).round() / ui.ctx().pixels_per_point();
            let [top, bottom] = [pos2(x, frame.top()), pos2(x, frame.bottom())];
            let stroke = Stroke::new(1.2, line.color);
            if line.dashed {
                shapes.extend(Shape::dashed_line(&[top, bottom], stroke, 5.0, 3.0));
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
    for end in RulerEnd::BOTH {
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

const REACH: f32 = 5.0;

pub(super) fn filter_at(marks: &[Mark], transform: &PlotTransform, position: Pos2) -> Option<u32> {
    // Only points around the pointer can be near: a line goes from left to right.
    let time = |x: f32| transform.value_from_position(Pos2 { x, ..position }).x;
    let (from, to) = (time(position.x - REACH), time(position.x + REACH));
    let distance_of = |count: usize, point: &dyn Fn(usize) -> PlotPoint| {
        let place = |at: usize| transform.position_from_point(&point(at));
        let near = (1..count).filter(|at| from <= point(*at).x && point(at - 1).x <= to);
        near.map(|at| distance(position, place(at - 1), place(at))).fold(f32::INFINITY, f32::min)
    };
    let near = marks.iter().filter_map(|mark| match mark {
        Mark::Line { points, filter, dashed: false, .. } => {
            Some((*filter, distance_of(points.len(), &|at| points[at])))
        }
        Mark::Band { times, edges, filter, .. } => {
            let edges = edges.iter().map(|edge| distance_of(times.len(), &|at| PlotPoint::new(times[at], edge[at])));
            Some((*filter, edges.fold(f32::INFINITY, f32::min)))
        }
        _ => None,
    });
    let (filter, _) = near.filter(|(_, distance)| *distance <= REACH).min_by(|a, b| a.1.total_cmp(&b.1))?;
    filter
}

fn distance(position: Pos2, from: Pos2, to: Pos2) -> f32 {
    let along = to - from;
    let share = ((position - from).dot(along) / along.length_sq().max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
    position.distance(from + share * along)
}

/// The distance of the values from the finger \[points\].
const ABOVE: f32 = 44.0;

const LENS_PADDING: f32 = 8.0;

const DOT: (f32, f32) = (4.0, 16.0);

/// Shows values above a finger that is held on a plot and moves. Returns its time \[s\].
pub(super) fn lens_ui<'a>(
    ui: &Ui,
    response: &Response,
    transform: &PlotTransform,
    readouts: impl Iterator<Item = &'a Readout>,
) -> Option<f64> {
    let id = response.id.with("lens");
    if response.long_touched() {
        // From now on the finger drags the lens and not the page.
        ui.ctx().set_dragged_id(id);
    }
    if ui.ctx().dragged_id() != Some(id) {
        return None;
    }
    ui.interact(response.rect, id, Sense::drag());
    let finger = ui.input(|input| input.pointer.latest_pos())?;
    let painter = ui.ctx().layer_painter(LayerId::new(Order::Tooltip, id));
    let visuals = ui.visuals();
    let font = TextStyle::Heading.resolve(ui.style());
    let lines: Vec<_> = readouts
        .map(|readout| {
            (readout.color, painter.layout_no_wrap(readout.text.clone(), font.clone(), visuals.text_color()))
        })
        .collect();
    let width = lines.iter().map(|(_, text)| text.size().x).fold(0.0, f32::max) + DOT.1;
    let height: f32 = lines.iter().map(|(_, text)| text.size().y).sum();
    let size = vec2(width, height) + 2.0 * vec2(LENS_PADDING, LENS_PADDING);
    let screen = ui.ctx().content_rect();
    let left = (finger.x - 0.5 * size.x).clamp(screen.left(), (screen.right() - size.x).max(screen.left()));
    let top = (finger.y - ABOVE - size.y).max(screen.top());
    let ground = Rect::from_min_size(pos2(left, top), size);
    painter.rect(ground, 6.0, visuals.window_fill, visuals.window_stroke, egui::StrokeKind::Outside);
    let mut at = ground.min + vec2(LENS_PADDING, LENS_PADDING);
    for (color, text) in lines {
        if color != Color32::TRANSPARENT {
            painter.circle_filled(pos2(at.x + DOT.0, at.y + 0.5 * text.size().y), DOT.0, color);
        }
        let line = Align2::LEFT_TOP.anchor_size(pos2(at.x + DOT.1, at.y), text.size());
        at.y += text.size().y;
        painter.galley(line.min, text, visuals.text_color());
    }
    let x = finger.x.clamp(transform.frame().left(), transform.frame().right());
    Some(transform.value_from_position(pos2(x, finger.y)).x)
}

#[cfg(test)]
mod tests {
    use egui::pos2;

    use super::*;

    #[test]
    fn the_distance_from_a_line_ends_at_its_ends() {
        let of = |x, y| distance(pos2(x, y), pos2(0.0, 0.0), pos2(10.0, 0.0));
        assert_eq!((of(5.0, 3.0), of(-4.0, 3.0), of(13.0, 4.0)), (3.0, 5.0, 5.0));
        assert_eq!(distance(pos2(3.0, 4.0), pos2(0.0, 0.0), pos2(0.0, 0.0)), 5.0);
    }
}
