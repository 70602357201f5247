//! The frame of all plots: space for labels, and gestures.

use egui::{InputState, Sense, Ui};

/// Width for the labels of the vertical axis, at least \[points\].
pub(crate) const Y_AXIS: f32 = 44.0;

pub(crate) fn sense(ui: &Ui) -> Sense {
    if ui.input(InputState::has_touch_screen) { Sense::click() } else { Sense::click_and_drag() }
}
