//! A score over two settings: each cell is a whole run of the filter.

mod head;
mod marks;
mod panel;
mod picture;
mod scale;

use egui::{Label, Rect, Sense, Stroke, TextStyle, Ui, Vec2, pos2, vec2};
use kalmanscope_diagnosis::ValueKind;

use crate::laboratory::{Laboratory, MapChoice, Survey};
use crate::plot::medium::Medium;
use crate::request::Request;
use crate::view::{View, ViewContext};
use head::head_ui;
use marks::TuningPath;
use panel::PanelView;
use picture::{PanelPlace, arrange};
use scale::CellEnd;

const PROGRESS: f32 = 3.0;

pub(super) static VIEW: View = View {
    name: "Map",
    help: [
        "Each cell is a run of the filter over the whole record, with the settings of its place; the colour is its score.",
        "Drag the dot: the settings and all plots follow. Point at a cell for its numbers; a click takes its settings.",
        "The line surrounds the settings with which the filter is consistent: its mean NIS is within its 99 % interval. The curves above and beside the cells are the score through the dot.",
    ],
    is_of_laboratory: true,
    ui: Some(view_ui),
    ..View::NONE
};

fn view_ui(ui: &mut Ui, context: &ViewContext<'_>, requests: &mut Vec<Request>) -> Option<f64> {
    let (laboratory, choice, survey) = contents_ui(ui, context)?;
    let medium = Medium::of(ui.ctx());
    if medium == Medium::Screen {
        head_ui(ui, context, laboratory, choice, requests);
        if let Some(sentence) = head::sentence(survey, choice.measure, context) {
            ui.add(Label::new(sentence).wrap());
        }
    }
    let (room, _) = ui.allocate_exact_size(ui.available_size().max(Vec2::splat(1.0)), Sense::hover());
    progress_ui(ui, room, laboratory, context);
    let panels = picture::panels(ui.ctx(), laboratory, survey, choice.measure, context.palette);
    medium.note_plots(ui.ctx(), panels.len());
    let has_truth = !marks::truths(survey.axes(), context).is_empty();
    let path = laboratory.tuning.path_in(survey).map(|(filter, points)| TuningPath { filter, points });
    let path = path.filter(|path| path.points.len() > 1);
    let is_never = choice.measure.info().kind == ValueKind::Time;
    let any = |end: CellEnd| panels.iter().any(|panel| panel.has(end));
    let marks = [
        (true, "dot: setting on screen"),
        (panels.iter().any(|panel| !panel.contour.is_empty()), "line: around it the mean NIS leaves its 99 % interval"),
        (has_truth, "dashed: truth"),
        (path.is_some(), "white path: Tune for me"),
        (any(CellEnd::Lost), "pale: lost the truth"),
        (any(CellEnd::Stopped), "grey: stopped"),
        (is_never, "grey: never settled"),
    ];
    let words = marks.into_iter().filter(|(is_there, _)| *is_there).map(|(_, text)| text);
    let words = words.collect::<Vec<_>>().join("  ·  ");
    let font = TextStyle::Small.resolve(ui.style());
    let legend = ui.painter().layout(words, font, context.palette.weak, room.width() - 8.0);
    let bottom = (room.bottom() - legend.size().y).max(room.top() + PROGRESS);
    let area = Rect::from_min_max(room.min + vec2(0.0, PROGRESS), pos2(room.right(), bottom));
    for PanelPlace { at, room, has_bar } in arrange(ui, area, &panels, survey) {
        let is_old = laboratory.is_shown_old();
        let view =
            PanelView { panel: &panels[at], survey, measure: choice.measure, path: path.as_ref(), is_old, has_bar };
        view.ui(ui, room, context, requests);
    }
    ui.painter().galley(pos2(room.left() + 4.0, bottom), legend, context.palette.weak);
    None
}

fn contents_ui<'a>(ui: &mut Ui, context: &ViewContext<'a>) -> Option<(&'a Laboratory, &'a MapChoice, &'a Survey)> {
    let laboratory = context.laboratory?;
    if let Some(problem) = laboratory.state.problem.as_deref() {
        ui.weak(problem);
    }
    laboratory.choice.as_ref().zip(laboratory.shown()).map(|(choice, survey)| (laboratory, choice, survey))
}

fn progress_ui(ui: &Ui, room: Rect, laboratory: &Laboratory, context: &ViewContext<'_>) {
    let Some(share) = laboratory.progress().filter(|_| Medium::of(ui.ctx()) == Medium::Screen) else { return };
    let y = room.top() + 1.0;
    let color = context.palette.accent;
    let end = room.left() + share as f32 * room.width();
    ui.painter().hline(room.x_range(), y, Stroke::new(2.0, color.gamma_multiply(0.25)));
    ui.painter().line_segment([pos2(room.left(), y), pos2(end, y)], Stroke::new(2.0, color));
}
