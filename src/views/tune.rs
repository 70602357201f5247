//! Tuning: the settings that may be turned, the search, and its result.

mod path;
mod result;
mod settings;

use egui::{ProgressBar, ScrollArea, Ui, UiBuilder};

use crate::plot::medium::Medium;
use crate::request::Request;
use crate::view::{View, ViewContext};

pub(super) struct Tune;

/// The least width at which the result is beside the settings, and the width of these \[points\].
const WIDE: f32 = 675.0;
const SETTINGS: f32 = 360.0;

impl View for Tune {
    fn name(&self) -> &'static str {
        "Tune for me"
    }

    fn help(&self) -> [&'static str; 3] {
        [
            "A search for the values of the ticked settings with the best score over the whole record.",
            "The likelihood of the innovations finds Q and R where the model is right; the free run, a model to simulate with.",
            "Read the remarks: a flat setting is not told by the record, one at an edge wants a wider range or another model.",
        ]
    }

    fn ui(&self, ui: &mut Ui, context: &ViewContext<'_>, requests: &mut Vec<Request>) -> Option<f64> {
        let tuning = &context.laboratory?.tuning;
        let Some(choice) = tuning.choice(context.session.run().scenario()) else {
            ui.weak("There is no filter to tune.");
            return None;
        };
        let is_working = tuning.progress().is_some();
        let is_screen = Medium::of(ui.ctx()) == Medium::Screen;
        let result_ui = |ui: &mut Ui, requests: &mut Vec<Request>| {
            if let Some(problem) = tuning.problem.as_deref() {
                ui.weak(problem);
            }
            if let Some(share) = tuning.progress() {
                ui.add(ProgressBar::new(share as f32).desired_height(6.0));
            }
            path::path_ui(ui, tuning, context);
            if let Some(result) = tuning.result.as_ref() {
                result::result_ui(ui, result, context, requests);
            }
        };
        if !is_screen {
            result_ui(ui, requests);
            return None;
        }
        let room = ui.available_rect_before_wrap();
        if room.width() < WIDE {
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                settings::head_ui(ui, context, &choice, is_working, requests);
                // Near the button, so that the user sees it.
                result_ui(ui, requests);
                settings::settings_ui(ui, context, &choice, requests);
            });
            return None;
        }
        let (left, right) = room.split_left_right_at_x(room.left() + SETTINGS);
        let mut left = ui.new_child(UiBuilder::new().id_salt("settings").max_rect(left));
        ScrollArea::vertical().auto_shrink(false).show(&mut left, |ui| {
            settings::head_ui(ui, context, &choice, is_working, requests);
            settings::settings_ui(ui, context, &choice, requests);
        });
        let right = right.with_min_x(right.left() + 12.0);
        let mut right = ui.new_child(UiBuilder::new().id_salt("result").max_rect(right));
        ScrollArea::vertical().auto_shrink(false).show(&mut right, |ui| result_ui(ui, requests));
        None
    }
}
