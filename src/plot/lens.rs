//! A finger that is held on a plot reads its values: they stand above the finger, which hides the heading's.

use egui::{Align2, Color32, LayerId, Order, Rect, Response, Sense, TextStyle, Ui, pos2, vec2};
use egui_plot::PlotTransform;

use super::heading::Readout;

/// The distance of the values from the finger \[points\].
const ABOVE: f32 = 44.0;

/// The room around them \[points\].
const PADDING: f32 = 8.0;

/// The radius of the dot in the colour of a value's owner, and its room \[points\].
const DOT: (f32, f32) = (4.0, 16.0);

/// Shows values above a finger that is held on a plot and moves. Returns its time \[s\].
pub(super) fn lens_ui(ui: &Ui, response: &Response, transform: &PlotTransform, readouts: &[Readout]) -> Option<f64> {
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
        .iter()
        .map(|readout| {
            (readout.color, painter.layout_no_wrap(readout.text.clone(), font.clone(), visuals.text_color()))
        })
        .collect();
    let width = lines.iter().map(|(_, text)| text.size().x).fold(0.0, f32::max) + DOT.1;
    let height: f32 = lines.iter().map(|(_, text)| text.size().y).sum();
    let size = vec2(width, height) + 2.0 * vec2(PADDING, PADDING);
    let screen = ui.ctx().content_rect();
    let left = (finger.x - 0.5 * size.x).clamp(screen.left(), (screen.right() - size.x).max(screen.left()));
    let top = (finger.y - ABOVE - size.y).max(screen.top());
    let ground = Rect::from_min_size(pos2(left, top), size);
    painter.rect(ground, 6.0, visuals.window_fill, visuals.window_stroke, egui::StrokeKind::Outside);
    let mut at = ground.min + vec2(PADDING, PADDING);
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
