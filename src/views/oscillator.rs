//! The moving masses with springs and dampers, the force, the sensors' noise, and each filter's belief.

mod figures;
mod parts;
mod scene;
mod stage;

use egui::{Align2, FontId, Rect, Sense, Stroke, Ui, WidgetInfo, vec2};
use kalmanscope_core::{Channel, Run};

use self::figures::PlantFigure;
use self::scene::Scene;
use self::stage::{Peak, SceneFrame, masses};
use crate::request::Request;
use crate::session::Mode;
use crate::view::{View, ViewContext};

pub(super) static VIEW: View = View {
    name: "Oscillator",
    help: [
        "The true masses are grey. Each filter has a slice of every mass: an outline at its estimate, and a bar of ±2σ. A slice outside its mass is an error.",
        "Click a slice for its filter's numbers and settings, and the equation to edit it.",
        "The arrow is the mean of the force over mass in the last 0.1 s: white noise itself would flicker.",
    ],
    ui: Some(view_ui),
    ..View::NONE
};

fn view_ui(ui: &mut Ui, context: &ViewContext<'_>, requests: &mut Vec<Request>) -> Option<f64> {
    let (width, available) = (ui.available_width().max(1.0), ui.available_height());
    let height = available.min(0.3 * width);
    if height > 40.0 {
        ui.add_space(0.5 * (available - height));
        oscillator_ui(ui, context, height, requests);
    }
    None
}

/// The time in which the scale changes \[s\].
const EASE: f32 = 0.8;

/// The span before anything has moved: half of the smallest initial standard deviation of any filter \[m\].
fn first_span(run: &Run, k: usize) -> f64 {
    /// Duration for which the initial span counts \[s\].
    const AT_FIRST: f64 = 1.0;
    if k as f64 * run.record().dt() > AT_FIRST {
        return 0.0;
    }
    let std = |estimates: &kalmanscope_core::Estimates| {
        let at = estimates.place(Channel::DISPLACEMENT).filter(|_| !estimates.is_empty())?;
        Some(0.5 * estimates.std(0, at))
    };
    run.estimates().iter().filter_map(std).reduce(f64::min).unwrap_or(0.0)
}

fn touchable(place: Rect) -> Rect {
    /// The least height of an area to touch \[points\].
    const LEAST: f32 = 36.0;
    let wide = place.expand2(vec2(6.0, 4.0));
    wide.with_max_y(wide.bottom().max(wide.top() + LEAST))
}

fn oscillator_ui(ui: &mut Ui, context: &ViewContext<'_>, height: f32, requests: &mut Vec<Request>) {
    let size = vec2(ui.available_width().max(1.0), height);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    let label = "The oscillator: springs, dampers and masses, with each filter's estimate of the displacement";
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, label));
    if !ui.is_rect_visible(rect) || rect.width() < 60.0 {
        return;
    }
    let painter = ui.painter_at(rect);

    let session = context.session;
    let run = session.run();
    let k = session.index();
    let masses = masses(run);
    // A whole record has one scale; that of a growing one follows the largest motion so far, and eases as far as this fits.
    let (last, first) = match session.mode() {
        Mode::Whole => (run.len().saturating_sub(1), 0.0),
        Mode::Live => (k, first_span(run, k)),
    };
    let peak = Peak::up_to(run.record(), masses, last);
    let needed = stage::needed(masses, peak, first);
    let time = if ui.style().animation_time > 0.0 { EASE } else { 0.0 };
    let eased = ui.ctx().animate_value_with_time(response.id, stage::rounded(needed) as f32, time);
    let zoom = f64::from(eased).max(needed);

    let stage = SceneFrame::new(rect, masses, 2_f64.powf(zoom));
    let scene = Scene { stage: &stage, painter: &painter, context, k };
    let figure = PlantFigure::of(run.scenario(), masses);
    if figure == PlantFigure::Masses {
        scene.masses(peak.force);
    }
    let equation = run.scenario().plant.kind.equation();
    let place = scene.captions();
    let at = ["on the mass", "on the pendulum", "in the circuit", ""][figure as usize];
    for (number, (slice, id, name)) in figure.draw(&scene, last).into_iter().enumerate() {
        let mass = ui.interact(slice, response.id.with(("slice", number)), Sense::click());
        mass.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, format!("{name} {at}")));
        if mass.on_hover_text(format!("{name}: click for its numbers and settings")).clicked() {
            requests.push(Request::Diagnose(id));
        }
    }
    // If there is no room for the equation, a click anywhere in the picture counts as one on it.
    let target = place.map_or(rect, touchable);
    let edit = ui.interact(target, response.id.with("equation"), Sense::click());
    edit.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, "Edit the equation"));
    let edit = edit.on_hover_cursor(egui::CursorIcon::PointingHand);
    if let Some(place) = place {
        // It is a button: a pencil, and a line under it for the pointer.
        let color = if edit.hovered() { context.palette.accent } else { context.palette.weak };
        painter.text(place.right_top() + vec2(5.0, 0.0), Align2::LEFT_TOP, "✏", FontId::proportional(11.0), color);
        if edit.hovered() {
            painter.hline(place.x_range(), place.bottom(), Stroke::new(1.0, color));
        }
    }
    let hidden = if place.is_some() { String::new() } else { format!("{equation}\n") };
    if edit.on_hover_text(format!("{hidden}Click to edit the equation")).clicked() {
        requests.push(Request::EditEquation);
    }
}
