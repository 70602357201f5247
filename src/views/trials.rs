//! A laboratory for one's own oscillator: set-ups, a table of trials, and the picture of all.

mod head;
mod picture;
mod sentence;
mod setups;
mod table;

use egui::{ScrollArea, Ui, UiBuilder, vec2};
use kalmanscope_lab::Trial;

use crate::plot::medium::Medium;
use crate::request::Request;
use crate::view::{View, ViewContext};

/// The table of trials and its picture.
pub(super) struct Trials;

/// The least width at which the picture is beside the table, and the width of that \[points\].
const WIDE: f32 = 820.0;
const TABLE: f32 = 490.0;

/// The height of the picture below the table \[points\].
const PICTURE: f32 = 280.0;

impl View for Trials {
    fn name(&self) -> &'static str {
        "Your own oscillator"
    }

    fn help(&self) -> [&'static str; 3] {
        [
            "What several records tell of an oscillator: measure one, add it, change the mass, measure again.",
            "With several masses, T² = 4π² (m + m₀) / k is a line, and its slope is the stiffness; with one mass, the picture is how trials differ.",
            "A class: everybody copies a link with this view on screen, and one person pastes all links here.",
        ]
    }

    fn ui(&self, ui: &mut Ui, context: &ViewContext<'_>, requests: &mut Vec<Request>) -> Option<f64> {
        let trials = context.laboratory?.trials();
        let rows = trials.rows();
        let is_screen = Medium::of(ui.ctx()) == Medium::Screen;
        if is_screen {
            head::head_ui(ui, context, trials, requests);
        }
        if rows.is_empty() {
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| setups::setups_ui(ui, context.palette));
            return None;
        }
        let room = ui.available_rect_before_wrap();
        if room.width() < WIDE || !is_screen {
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                sentence::sentence_ui(ui, rows);
                let size = vec2(ui.available_width(), PICTURE.min(room.height()));
                ui.allocate_ui(size, |ui| picture::picture_ui(ui, rows, context.palette));
                table_ui(ui, rows, is_screen, requests);
            });
            return None;
        }
        let (left, right) = room.split_left_right_at_x(room.left() + TABLE);
        let mut left = ui.new_child(UiBuilder::new().id_salt("trials").max_rect(left));
        ScrollArea::vertical().auto_shrink(false).show(&mut left, |ui| table_ui(ui, rows, is_screen, requests));
        let mut right = ui.new_child(UiBuilder::new().id_salt("together").max_rect(right));
        sentence::sentence_ui(&mut right, rows);
        picture::picture_ui(&mut right, rows, context.palette);
        ui.advance_cursor_after_rect(room);
        None
    }
}

fn table_ui(ui: &mut Ui, rows: &[Trial], is_screen: bool, requests: &mut Vec<Request>) {
    if let Some(next) = table::table_ui(ui, rows, is_screen) {
        requests.push(Request::KeepTrials(next));
    }
}
