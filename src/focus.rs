//! A ring around the control that has the keyboard's focus, while the keyboard is in use.

use egui::{Context, CornerRadius, Id, Key, LayerId, Order, Stroke, StrokeKind};

use crate::theme::Palette;

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
