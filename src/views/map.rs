//! A score over two settings: each cell is a whole run of the filter.

mod bar;
mod cells;
mod contour;
mod head;
mod legend;
mod marks;
mod panel;
mod picture;
mod scale;

use egui::{Rect, Sense, Stroke, Ui, Vec2, pos2, vec2};

use crate::laboratory::{Choice, Laboratory, Survey};
use crate::plot::medium::Medium;
use crate::request::Request;
use crate::view::{Proportions, View, ViewContext};
use head::head_ui;
use panel::PanelView;

pub(super) use legend::score_text;
pub(super) use marks::said;

/// The map.
pub(super) struct Map;

/// Limits the width of a panel below which panels are one below the other \[points\].
const LEAST: f32 = 160.0;

/// Limits the height of a panel from below, where panels are one below the other \[points\].
const LOW: f32 = 150.0;

/// Space between panels \[points\].
const GAP: f32 = 6.0;

impl View for Map {
    fn name(&self) -> &'static str {
        "Map"
    }

    fn help(&self) -> [&'static str; 3] {
        [
            "Each cell is a run of the filter over the whole record, with the settings of its place; the colour is its score.",
            "Drag the dot: the settings and all plots follow. Point at a cell for its numbers; a click takes its settings.",
            "The line surrounds the settings with which the filter is consistent: its mean NIS is within its 99 % interval.",
        ]
    }

    fn is_of_laboratory(&self) -> bool {
        true
    }

    fn proportions(&self) -> Proportions {
        Proportions::Tall
    }

    fn ui(&self, ui: &mut Ui, context: &ViewContext<'_>, requests: &mut Vec<Request>) -> Option<f64> {
        let Some((laboratory, choice, survey)) = contents(ui, context) else { return None };
        let medium = Medium::of(ui.ctx());
        if medium == Medium::Screen {
            head_ui(ui, context, laboratory, choice, requests);
        }
        let (room, _) = ui.allocate_exact_size(ui.available_size().max(Vec2::splat(1.0)), Sense::hover());
        progress_ui(ui, room, laboratory, context);
        let panels = picture::panels(ui.ctx(), laboratory, survey, choice.measure, context.palette);
        let lines = legend::lines(room.width()) as f32 * legend::LINE;
        let (area, below) = room.split_top_bottom_at_y((room.bottom() - lines).max(room.top() + 1.0));
        let area = area.with_min_y((area.top() + 3.0).min(area.bottom()));
        let bars: Vec<bool> = (0..panels.len())
            .map(|at| panels.get(at + 1).is_none_or(|next| next.colors != panels[at].colors))
            .collect();
        let (rooms, are_beside) = rooms(area, &bars);
        let mut has_truth = false;
        for (at, (panel, room)) in panels.iter().zip(rooms).enumerate() {
            let is_old = laboratory.is_shown_old();
            let view = PanelView { panel, survey, measure: choice.measure, is_old, has_bar: bars[at] || !are_beside };
            has_truth |= view.ui(ui, room, context, requests);
        }
        legend::legend_ui(ui, below.translate(vec2(4.0, 0.0)), &panels, (has_truth, choice.measure), context.palette);
        None
    }
}

/// The laboratory with its choice and the survey to show. Where there is none, says why.
pub(super) fn contents<'a>(ui: &mut Ui, context: &ViewContext<'a>) -> Option<(&'a Laboratory, &'a Choice, &'a Survey)> {
    let laboratory = context.laboratory?;
    if let Some(problem) = laboratory.problem() {
        ui.weak(problem);
    }
    laboratory.choice().zip(laboratory.shown()).map(|(choice, survey)| (laboratory, choice, survey))
}

/// A line above the panels, as long as the share of the map that is known.
fn progress_ui(ui: &Ui, room: Rect, laboratory: &Laboratory, context: &ViewContext<'_>) {
    let Some(share) = laboratory.progress().filter(|_| Medium::of(ui.ctx()) == Medium::Screen) else { return };
    let y = room.top() + 1.0;
    let color = context.palette.accent;
    let end = room.left() + share as f32 * room.width();
    ui.painter().hline(room.x_range(), y, Stroke::new(2.0, color.gamma_multiply(0.25)));
    ui.painter().line_segment([pos2(room.left(), y), pos2(end, y)], Stroke::new(2.0, color));
}

/// The rooms of panels, and whether they are side by side, as they are where they have the width for that. Then panels with the
/// same bar of colours share it, and their plots are equally wide.
fn rooms(area: Rect, bars: &[bool]) -> (Vec<Rect>, bool) {
    let count = bars.len().max(1) as f32;
    let gaps = GAP * (count - 1.0);
    let bar = |has_bar: bool| if has_bar { bar::ROOM } else { 0.0 };
    let plot = (area.width() - gaps - bars.iter().map(|has_bar| bar(*has_bar)).sum::<f32>()) / count;
    let mut corner = area.min;
    let mut next = |size: Vec2, step: Vec2| {
        let room = Rect::from_min_size(corner, size);
        corner += step;
        room
    };
    if plot >= LEAST || area.height() < LOW * count {
        let size = |has_bar: &bool| vec2(plot + bar(*has_bar), area.height());
        let rooms = bars.iter().map(|has_bar| next(size(has_bar), vec2(size(has_bar).x + GAP, 0.0))).collect();
        return (rooms, true);
    }
    let size = vec2(area.width(), (area.height() - gaps) / count);
    (bars.iter().map(|_| next(size, vec2(0.0, size.y + GAP))).collect(), false)
}
