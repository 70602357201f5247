//! The drawer at the foot of a narrow window, for the settings or a lesson: a handle and two heights. The plots keep
//! most of the window.

use egui::{Align, Button, Frame, Layout, Panel, Rect, Response, Sense, Ui, UiBuilder, WidgetInfo, pos2, vec2};

use crate::probe;
use crate::widgets::named;

pub(crate) const FOR_PLOTS: f32 = 0.45;

const LOW: f32 = 0.2;

/// Limits both heights from below \[points\].
const LEAST: f32 = 110.0;

const GRIP: egui::Vec2 = vec2(36.0, 4.0);

/// The least height of the heading on the handle \[points\].
const HANDLE: f32 = 26.0;

#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Drawer {
    is_low: bool,
    dragged: Option<f32>,
}

impl Drawer {
    fn heights(window: f32, room: f32) -> [f32; 2] {
        // Not `clamp`, which panics where a low window has less room than the least height.
        let high = (room - FOR_PLOTS * window).max(LEAST).min(room.max(0.0));
        [(LOW * window).max(LEAST).min(high), high]
    }

    pub(crate) fn ui(
        &mut self,
        ui: &mut Ui,
        name: &str,
        (frame, window): (Frame, f32),
        heading: impl FnOnce(&mut Ui),
        contents: impl FnOnce(&mut Ui),
    ) {
        let [low, high] = Self::heights(window, ui.available_height());
        let usual = if self.is_low { low } else { high };
        let height = self.dragged.unwrap_or(usual).clamp(low, high);
        let frame = Frame { inner_margin: egui::Margin { top: 0, ..frame.inner_margin }, ..frame };
        Panel::bottom(name).frame(frame).exact_size(height).show(ui, |ui| {
            // The drawer keeps its size even with short contents.
            ui.set_min_size(ui.available_size());
            let handle = handle_ui(ui, heading);
            let action = if self.is_low { "higher" } else { "lower" };
            handle.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, format!("Make the {name} {action}")));
            probe::remember(ui.ctx(), &format!("Handle of the {name}"), handle.rect);
            if handle.dragged() {
                self.dragged = Some((height - handle.drag_delta().y).clamp(low, high));
            } else if let Some(dragged) = self.dragged.take() {
                self.is_low = dragged < 0.5 * (low + high);
            }
            if handle.clicked() {
                self.is_low = !self.is_low;
            }
            contents(ui);
        });
    }
}

fn handle_ui(ui: &mut Ui, heading: impl FnOnce(&mut Ui)) -> Response {
    let above = 2.0 * GRIP.y;
    let size = vec2(ui.available_width(), above + ui.spacing().interact_size.y.max(HANDLE));
    let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
    let grip = Rect::from_center_size(pos2(rect.center().x, rect.top() + GRIP.y), GRIP);
    let color = if response.hovered() || response.dragged() || response.has_focus() {
        ui.visuals().strong_text_color()
    } else {
        ui.visuals().weak_text_color().gamma_multiply(0.6)
    };
    ui.painter().rect_filled(grip, 0.5 * GRIP.y, color);
    let response = response.on_hover_cursor(egui::CursorIcon::ResizeVertical);
    let below = rect.with_min_y(rect.top() + above);
    heading(&mut ui.new_child(UiBuilder::new().max_rect(below).layout(Layout::left_to_right(Align::Center))));
    response
}

pub(crate) fn close_ui(ui: &mut Ui, name: &str) -> bool {
    let side = ui.spacing().interact_size.y;
    let close =
        named(ui.add(Button::new("×").frame(false).min_size(egui::Vec2::splat(side))).on_hover_text(name), name);
    close.clicked()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_plots_keep_their_share() {
        for (window, above) in [(844.0, 150.0), (664.0, 110.0), (390.0, 60.0)] {
            let [low, high] = Drawer::heights(window, window - above);
            assert!(low <= high && low >= LEAST, "{low} {high} of {window}");
            assert!(window - above - high >= FOR_PLOTS * window || high == LEAST, "{high} of {window}");
        }
    }

    #[test]
    fn a_window_without_room_has_a_drawer_without_height() {
        assert_eq!(Drawer::heights(1.0, -3.0), [0.0, 0.0]);
    }
}
