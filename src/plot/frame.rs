//! The frame that all plots share: room for labels, and what fingers and pointers do.

use egui::{InputState, Sense, Ui};

/// Least room at the left of a plot for the labels of its ticks \[points\].
pub(crate) const Y_AXIS: f32 = 44.0;

/// The gestures that a plot senses: where there are fingers a drag scrolls the page, and two zoom.
pub(crate) fn sense(ui: &Ui) -> Sense {
    if ui.input(InputState::has_touch_screen) { Sense::click() } else { Sense::click_and_drag() }
}
