//! The list of all keys and gestures on screen.

use egui::{Align2, Context, Label, RichText, ScrollArea, Ui, Vec2, Window, vec2};

use super::{GESTURES, GROUPS};
use crate::theme;

/// The least width of a window that shows the list in two columns \[points\].
const TWO_COLUMNS: f32 = 660.0;

/// The width of a column at most, and of the names of keys in it \[points\].
const COLUMN: f32 = 400.0;
const NAMES: f32 = 112.0;

/// The distance of the list from the window's edges, its title and its margins included \[points\].
const MARGINS: Vec2 = vec2(36.0, 84.0);

/// Gaps between columns and between groups \[points\].
const GAPS: Vec2 = vec2(24.0, 8.0);

type Group = (&'static str, Vec<(&'static str, &'static str)>);

pub(crate) fn window_ui(ctx: &Context, open: &mut bool) {
    let room = ctx.content_rect().size() - MARGINS;
    let columns = if room.x >= TWO_COLUMNS { 2 } else { 1 };
    let width = (room.x / columns as f32 - GAPS.x).clamp(1.0, COLUMN);
    let window = Window::new("Keys").collapsible(false).resizable(false).open(open);
    window.anchor(Align2::CENTER_CENTER, Vec2::ZERO).show(ctx, |ui| {
        let height = room.y.max(40.0);
        ScrollArea::vertical().max_height(height).min_scrolled_height(height).show(ui, |ui| {
            ui.horizontal_top(|ui| {
                ui.spacing_mut().item_spacing.x = GAPS.x;
                for groups in split(groups(), columns) {
                    ui.allocate_ui(vec2(width, 0.0), |ui| column_ui(ui, &groups, width));
                }
            });
        });
    });
}

fn groups() -> Vec<Group> {
    let keys = GROUPS.iter().map(|(title, shortcuts)| {
        let mut rows: Vec<_> = shortcuts.iter().map(|shortcut| (shortcut.name, shortcut.what)).collect();
        if *title == "Views" {
            rows.push(("1 to 6", "show or hide a filter"));
        }
        (*title, rows)
    });
    keys.chain(GESTURES.iter().map(|(title, rows)| (*title, rows.to_vec()))).collect()
}

fn split(groups: Vec<Group>, columns: usize) -> Vec<Vec<Group>> {
    let length = |(_, rows): &Group| rows.len() + 2;
    let all: usize = groups.iter().map(length).sum();
    let mut split: Vec<Vec<Group>> = vec![Vec::new(); columns];
    let mut before = 0;
    for group in groups {
        let middle = before + length(&group) / 2;
        before += length(&group);
        split[(columns * middle / all.max(1)).min(columns - 1)].push(group);
    }
    split
}

fn column_ui(ui: &mut Ui, groups: &[Group], width: f32) {
    ui.vertical(|ui| {
        ui.set_width(width);
        ui.spacing_mut().item_spacing.x = 10.0;
        // Nothing is pressed here.
        ui.spacing_mut().interact_size.y = 0.0;
        for (title, rows) in groups {
            ui.label(RichText::new(*title).small().weak());
            for (name, what) in rows {
                ui.horizontal_top(|ui| {
                    ui.allocate_ui(vec2(NAMES, 0.0), |ui| {
                        ui.set_width(NAMES);
                        ui.add(Label::new(RichText::new(*name).family(theme::strong())).wrap());
                    });
                    ui.add(Label::new(*what).wrap());
                });
            }
            ui.add_space(GAPS.y);
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_about_as_long_as_each_other_and_keep_the_order() {
        let all = groups();
        let columns = split(all.clone(), 2);
        let rows = |groups: &[Group]| groups.iter().map(|(_, rows)| rows.len() + 2).sum::<usize>();
        let [left, right] = [rows(&columns[0]), rows(&columns[1])];
        assert!(left.abs_diff(right) < 8, "{left} and {right}");
        assert_eq!(columns.concat(), all);
        assert_eq!(split(all.clone(), 1), [all]);
    }
}
