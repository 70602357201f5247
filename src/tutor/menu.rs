//! The ways to a lesson: the menu, and an invitation for new users.

use std::ops::Range;

use egui::{Button, RichText, TextWrapMode, Ui};
use kalmanscope_lessons::Lesson;

use super::Catalogue;
use crate::menu::{self, Closing};
use crate::probe;
use crate::request::Request;
use crate::theme;

/// A window of this width has room for two columns \[points\].
const TWO_COLUMNS: f32 = 720.0;

/// The space between two lessons, for a pointer \[points\].
const LINES_APART: f32 = 2.0;

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
        if !theme::is_for_fingers(ui.ctx()) {
            // All of them in a window of usual height.
            ui.spacing_mut().item_spacing.y = LINES_APART;
        }
        let lessons = catalogue.lessons();
        let is_in_last_group = |lesson: &&Lesson| lessons.last().is_some_and(|last| last.group == lesson.group);
        let last_group = lessons.len() - lessons.iter().rev().take_while(is_in_last_group).count();
        if theme::is_for_fingers(ui.ctx()) || ui.ctx().content_rect().width() < TWO_COLUMNS {
            lessons_ui(ui, catalogue, 0..lessons.len(), requests);
        } else {
            ui.horizontal_top(|ui| {
                for places in [0..last_group, last_group..lessons.len()] {
                    ui.vertical(|ui| lessons_ui(ui, catalogue, places, requests));
                }
            });
        }
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
        let button = ui.button(text).on_hover_text(lesson.summary.as_str());
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
