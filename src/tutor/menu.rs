//! The ways to a lesson: the menu, and an invitation for new users.

use std::ops::Range;

use egui::{Button, RichText, TextWrapMode, Ui};

use super::Catalogue;
use crate::menu::{self, Closing};
use crate::probe;
use crate::request::Request;
use crate::thumbnail;
use crate::widgets::named;

/// The width of the window that the menu leaves, and the least width of a column \[points\].
const AROUND: f32 = 40.0;
const LEAST: f32 = 380.0;

const MOST: usize = 3;

/// The distance between lessons in columns, so that a small desktop has all of them in sight \[points\].
const CLOSE: f32 = 3.0;

const NAME: f32 = 0.4;

pub(crate) fn invitation_ui(ui: &mut Ui, requests: &mut Vec<Request>) {
    let text = RichText::new("New here? Begin with the first lesson").color(ui.visuals().hyperlink_color);
    let link = ui.add(Button::new(text).frame(false).wrap_mode(TextWrapMode::Extend));
    probe::remember(ui.ctx(), "First lesson", link.rect);
    if link.clicked() {
        requests.push(Request::StartLesson(0));
    }
}

pub(crate) fn menu_ui(ui: &mut Ui, catalogue: &Catalogue, requests: &mut Vec<Request>) {
    let button = menu::menu_ui(ui, "Lessons", Closing::AtOnce, |ui| {
        let lessons = &catalogue.lessons;
        let room = ui.ctx().content_rect().width() - AROUND;
        let columns = ((room / LEAST) as usize).clamp(1, MOST);
        let groups: Vec<&str> = lessons.iter().map(|lesson| lesson.group.as_str()).collect();
        ui.horizontal_top(|ui| {
            for places in even(&groups, columns) {
                ui.vertical(|ui| {
                    if columns > 1 {
                        ui.spacing_mut().item_spacing.y = CLOSE;
                    }
                    ui.set_width(room / columns as f32 - ui.spacing().item_spacing.x);
                    lessons_ui(ui, catalogue, places, requests);
                });
            }
        });
    });
    probe::remember(ui.ctx(), "Lessons", button.rect);
}

/// Divides the lessons among columns of about the same height. The name of a group has a height, too.
fn even(groups: &[&str], columns: usize) -> Vec<Range<usize>> {
    let fill = |limit: f32| {
        let (mut all, mut begin, mut height) = (Vec::new(), 0, 0.0);
        for place in 0..groups.len() {
            let is_named = place == begin || groups[place] != groups[place - 1];
            let more = if is_named { 1.0 + NAME } else { 1.0 };
            if place > begin && height + more > limit {
                all.push(begin..place);
                (begin, height) = (place, 1.0 + NAME);
            } else {
                height += more;
            }
        }
        all.push(begin..groups.len());
        all
    };
    let mut limit = groups.len() as f32 / columns as f32;
    loop {
        let all = fill(limit);
        if all.len() <= columns {
            return all;
        }
        limit += 0.1;
    }
}

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
        let button = if finished { named(button, format!("{}, finished", lesson.title)) } else { button };
        probe::remember(ui.ctx(), &lesson.title, button.rect);
        if button.clicked() {
            requests.push(Request::StartLesson(place));
            ui.close();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_groups_take_room_in_their_columns() {
        let groups: Vec<&str> = (0..37).map(|place| ["a", "b", "c", "c", "c"][(place / 4).min(4)]).collect();
        let lengths = |columns| even(&groups, columns).iter().map(ExactSizeIterator::len).collect::<Vec<_>>();
        assert_eq!(lengths(3), [12, 13, 12]);
        assert_eq!((lengths(1), lengths(2)), (vec![37], vec![18, 19]));
        assert_eq!(even(&[], 3), vec![0..0]);
        assert_eq!(even(&["a"], 3).len(), 1);
    }
}
