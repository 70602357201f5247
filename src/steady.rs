//! Blocks of text that do not shrink under the pointer, so that widgets below them do not move.

use egui::{Id, Ui};

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
