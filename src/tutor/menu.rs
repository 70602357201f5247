//! The ways to a lesson: the menu, and an invitation for new users.

use std::ops::Range;

use egui::{Button, RichText, TextWrapMode, Ui};

use super::Catalogue;
use crate::menu::{self, Closing};
use crate::probe;
use crate::request::Request;
use crate::thumbnail;

/// The width of the window that the menu leaves, and the least width of a column \[points\].
const AROUND: f32 = 40.0;
const LEAST: f32 = 380.0;

/// Limits the columns.
const MOST: usize = 3;

/// An invitation to the first lesson, for new users.
pub(crate) fn invitation_ui(ui: &mut Ui, requests: &mut Vec<Request>) {
    let text = RichText::new("New here? Begin with the first lesson").color(ui.visuals().hyperlink_color);
    let link = ui.add(Button::new(text).frame(false).wrap_mode(TextWrapMode::Extend));
    probe::remember(ui.ctx(), "First lesson", link.rect);
    if link.clicked() {
        requests.push(Request::StartLesson(0));
    }
}

/// The menu of all lessons, by group; finished ones have a tick.
pub(crate) fn menu_ui(ui: &mut Ui, catalogue: &Catalogue, requests: &mut Vec<Request>) {
    let button = menu::menu_ui(ui, "Lessons", Closing::AtOnce, |ui| {
        let lessons = catalogue.lessons();
        let room = ui.ctx().content_rect().width() - AROUND;
        let columns = ((room / LEAST) as usize).clamp(1, MOST);
        let of_column = lessons.len().div_ceil(columns);
        ui.horizontal_top(|ui| {
            for column in 0..columns {
                let places = column * of_column..((column + 1) * of_column).min(lessons.len());
                ui.vertical(|ui| {
                    ui.set_width(room / columns as f32 - ui.spacing().item_spacing.x);
                    lessons_ui(ui, catalogue, places, requests);
                });
            }
        });
    });
    probe::remember(ui.ctx(), "Lessons", button.rect);
}

/// The lessons at some places, under the names of their groups.
fn lessons_ui(ui: &mut Ui, catalogue: &Catalogue, places: Range<usize>, requests: &mut Vec<Request>) {
    let mut group = "";
    for place in places {
        let Some(lesson) = catalogue.at(place) else { continue };
        if lesson.group != group {
            group = &lesson.group;
            ui.label(RichText::new(group).small().weak());
        }
        let finished = catalogue.is_finished(lesson);
        let text = if finished { format!("{} ✓", lesson.title) } else { lesson.title.clone() };
        let button = menu::entry_ui(ui, &text, &lesson.summary, thumbnail::of_lesson(ui.ctx(), lesson));
        if finished {
            let name = format!("{}, finished", lesson.title);
            button.ctx.accesskit_node_builder(button.id, |node| node.set_label(name));
        }
        probe::remember(ui.ctx(), &lesson.title, button.rect);
        if button.clicked() {
            requests.push(Request::StartLesson(place));
            ui.close();
        }
    }
}
