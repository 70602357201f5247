//! The places of panels: side by side, one below the other, or one at a time if there is no room for more.

use egui::{Id, Rect, Ui, UiBuilder, Vec2, vec2};

use super::bar;
use super::picture::{Contents, Panel};
use crate::laboratory::Survey;
use crate::plot::medium::Medium;

/// The least width of panels side by side \[points\].
const LEAST: f32 = 160.0;

/// The least height of panels one below the other \[points\].
const LOW: f32 = 180.0;

/// Space between panels \[points\].
const GAP: f32 = 6.0;

pub(super) struct Place {
    pub(super) at: usize,
    pub(super) room: Rect,
    pub(super) has_bar: bool,
}

pub(super) fn arrange(ui: &mut Ui, area: Rect, panels: &[Panel], survey: &Survey) -> Vec<Place> {
    let count = panels.len().max(1) as f32;
    let gaps = GAP * (count - 1.0);
    let is_last = |at: usize| panels.get(at + 1).is_none_or(|next| next.colors != panels[at].colors);
    let bars: Vec<f32> =
        (0..panels.len()).map(|at| if is_last(at) { bar::room(&panels[at].colors) } else { 0.0 }).collect();
    let plot = (area.width() - gaps - bars.iter().sum::<f32>()) / count;
    let mut corner = area.min;
    if plot >= LEAST || panels.len() < 2 {
        let place = |(at, bar): (usize, &f32)| {
            let room = Rect::from_min_size(corner, vec2(plot + bar, area.height()));
            corner.x += room.width() + GAP;
            Place { at, room, has_bar: *bar > 0.0 }
        };
        return bars.iter().enumerate().map(place).collect();
    }
    let height = (area.height() - gaps) / count;
    if height >= LOW || Medium::of(ui.ctx()) == Medium::Figure {
        let place = |at: usize| {
            let room = Rect::from_min_size(corner, vec2(area.width(), height));
            corner.y += height + GAP;
            Place { at, room, has_bar: true }
        };
        return (0..panels.len()).map(place).collect();
    }
    one_ui(ui, area, panels, survey)
}

fn one_ui(ui: &mut Ui, area: Rect, panels: &[Panel], survey: &Survey) -> Vec<Place> {
    let id = Id::unique("panel of the map");
    let mut chosen: usize = ui.data(|data| data.get_temp(id)).unwrap_or(0).min(panels.len() - 1);
    let filters = &survey.ensemble.scenario().filters;
    let mut child = ui.new_child(UiBuilder::new().id_salt("panels of the map").max_rect(area));
    let row = child.horizontal(|ui| {
        for (at, panel) in panels.iter().enumerate() {
            let text = match panel.contents {
                Contents::Filter(place) => filters[place].name.as_str(),
                Contents::Comparison => "compared",
            };
            ui.selectable_value(&mut chosen, at, text);
        }
    });
    ui.data_mut(|data| data.insert_temp(id, chosen));
    let top = row.response.rect.bottom() + GAP;
    let size = Vec2::new(area.width(), (area.bottom() - top).max(1.0));
    vec![Place { at: chosen, room: Rect::from_min_size(egui::pos2(area.left(), top), size), has_bar: true }]
}
