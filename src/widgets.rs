//! Texts over widgets, blocks that do not shrink, and the ring of the keyboard's focus.

use egui::{Button, Context, CornerRadius, Id, Key, LayerId, Order, Response, RichText, Stroke, StrokeKind, Ui};

use crate::theme::Palette;

pub(crate) fn hover_text(response: Response, text: &dyn Fn() -> String) -> Response {
    // A screen reader needs every text; else one is made under the pointer only, not for each number of each frame.
    if response.ctx.has_accesskit_node(response.id) {
        return response.on_hover_text(text());
    }
    response.on_hover_ui(|ui| {
        ui.set_max_width(ui.spacing().tooltip_width);
        ui.label(text());
    })
}

pub(crate) fn named(response: Response, name: impl Into<String>) -> Response {
    let name = name.into();
    response.ctx.accesskit_node_builder(response.id, |node| node.set_label(name));
    response
}

pub(crate) fn primary(text: &str, palette: &Palette) -> Button<'static> {
    Button::new(RichText::new(text).color(palette.on_accent)).fill(palette.accent)
}

/// The time for which blocks keep their heights after the pointer has left, or the finger \[s\].
const STAYS: f64 = 2.0;

/// Whether the pointer is on the part of the window that `ui` covers, or was a moment ago.
pub(crate) fn is_held(ui: &Ui, key: &str) -> bool {
    let id = ui.scope_id().with(key);
    let now = ui.input(|input| input.time);
    if ui.rect_contains_pointer(ui.max_rect().intersect(ui.clip_rect())) {
        ui.data_mut(|data| data.insert_temp(id, now));
        return true;
    }
    let rest = ui.data(|data| data.get_temp::<f64>(id)).map_or(0.0, |last| last + STAYS - now);
    if rest > 0.0 {
        ui.ctx().request_repaint_after(std::time::Duration::from_secs_f64(rest));
    }
    rest > 0.0
}

/// Shows a block that keeps the largest height it has had while it is held, in a column of the same width.
pub(crate) fn steady_ui(ui: &mut Ui, key: &str, is_held: bool, add_contents: impl FnOnce(&mut Ui)) {
    let id: Id = ui.scope_id().with(key);
    let width = ui.available_width();
    let before = ui.data(|data| data.get_temp::<(f32, f32)>(id));
    let before = before.filter(|(of, _)| is_held && *of == width).map_or(0.0, |(_, height)| height);
    let height = ui.scope(add_contents).response.rect.height();
    if before > height {
        ui.add_space(before - height);
    }
    ui.data_mut(|data| data.insert_temp(id, (width, before.max(height))));
}

/// The distance of the ring from the control, and its width \[points\].
const RING: (f32, f32) = (3.0, 2.0);

pub(crate) fn ring_ui(ctx: &Context, palette: &Palette) {
    let id = Id::unique("keyboard in use");
    let moving = [Key::Tab, Key::ArrowUp, Key::ArrowDown, Key::ArrowLeft, Key::ArrowRight];
    let (pressed, moved) =
        ctx.input(|input| (input.pointer.any_pressed(), moving.iter().any(|key| input.key_pressed(*key))));
    let before = ctx.data(|data| data.get_temp::<bool>(id)).unwrap_or(false);
    let in_use = (before && !pressed) || moved;
    ctx.data_mut(|data| data.insert_temp(id, in_use));
    let focused = ctx.memory(egui::Memory::focused).and_then(|id| ctx.read_response(id));
    let Some(control) = focused.filter(|_| in_use) else { return };
    let painter = ctx.layer_painter(LayerId::new(Order::Tooltip, Id::unique("ring")));
    let rect = control.interact_rect.expand(RING.0);
    painter.rect_stroke(rect, CornerRadius::same(4), Stroke::new(RING.1, palette.accent), StrokeKind::Outside);
}
