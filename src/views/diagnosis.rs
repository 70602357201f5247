//! The diagnosis of a filter, in a drawer: verdict, evidence, causes, and the edits that repair them.

mod causes;
mod evidence;

use egui::{Label, RichText, ScrollArea, TextStyle, Ui};
use kalmanscope_core::Estimates;

use crate::request::Request;
use crate::text::sentence;
use crate::theme;
use crate::verdict::{symbol, text_color};
use crate::view::ViewContext;
use crate::widgets::{is_held, steady_ui};

pub(crate) const HELP: (&str, [&str; 3]) = (
    "Diagnosis",
    [
        "Whether each filter's ±2σ is to be believed over the record so far, and the tests that say so: click on one for how to read it.",
        "A bar is the size of an effect; beyond the line in its middle it matters. It counts if chance explains it in less than one of 10 000 records.",
        "Causes are tried: the filter runs again with a setting changed. A button makes that change; Ctrl+Z takes it back.",
    ],
);

pub(crate) fn drawer_ui(ui: &mut Ui, context: &ViewContext<'_>, id: u32, requests: &mut Vec<Request>) {
    let is_held = is_held(ui, "hand on the diagnosis");
    let all = context.session.run().estimates();
    if all.len() > 1 {
        ui.horizontal_wrapped(|ui| {
            for estimates in all {
                let is_on = estimates.id() == id;
                let color = context.color(estimates);
                let name = RichText::new(estimates.name()).color(if is_on { context.palette.on_accent } else { color });
                let tab = ui.selectable_label(is_on, name);
                tab.ctx.accesskit_node_builder(tab.id, |node| {
                    node.set_label(format!("Diagnosis of {}", estimates.name()));
                });
                if tab.clicked() {
                    requests.push(Request::Diagnose(estimates.id()));
                }
            }
        });
        ui.add_space(4.0);
    }
    let Some(place) = all.iter().position(|estimates| estimates.id() == id) else {
        ui.weak("This filter was removed.");
        return;
    };
    // In a low drawer, as on a phone, the verdict and its cures are in sight and the numbers below them.
    let is_low = ui.available_height() < LOW;
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        ui.set_width(ui.available_width() - ui.spacing().scroll.bar_width);
        let verdict_ui = |ui: &mut Ui, requests: &mut Vec<Request>| {
            ui.push_id(id, |ui| filter_ui(ui, context, (place, is_held), &all[place], requests));
            ui.add_space(4.0);
        };
        if is_low {
            verdict_ui(ui, requests);
        }
        evidence::estimates_ui(ui, context, place, &all[place]);
        evidence::settings_ui(ui, context, id, requests);
        ui.add_space(4.0);
        if !is_low {
            verdict_ui(ui, requests);
        }
    });
}

const LOW: f32 = 420.0;

const LINES: f32 = 3.0;

fn filter_ui(
    ui: &mut Ui,
    context: &ViewContext<'_>,
    (place, is_held): (usize, bool),
    estimates: &Estimates,
    requests: &mut Vec<Request>,
) {
    let ViewContext { session, palette, .. } = *context;
    let color = context.color(estimates);
    let diagnosis = session.diagnosis(place);
    let verdict = diagnosis.and_then(|diagnosis| diagnosis.verdict.as_ref());
    ui.horizontal_wrapped(|ui| {
        ui.label(RichText::new(estimates.name()).family(theme::strong()).size(15.0).color(color));
        match verdict {
            Some(verdict) => {
                let text = format!("{} {}", symbol(verdict.kind), verdict.kind.name());
                let text = RichText::new(text).family(theme::strong()).size(15.0);
                ui.label(text.color(text_color(verdict.kind, palette)));
            }
            None => _ = ui.weak("no verdict yet: fewer than 20 measurements"),
        }
    });
    let (Some(diagnosis), Some(verdict)) = (diagnosis, verdict) else { return };
    let is_good = verdict.kind.is_good();
    steady_ui(ui, "reason", is_held, |ui| {
        if !is_good {
            ui.set_min_height(LINES * ui.text_style_height(&TextStyle::Body));
        }
        ui.add(Label::new(format!("{}.", sentence(&verdict.reason))).wrap());
        if is_mirrored(estimates) {
            let text = "The filter itself has (−ωₙ, −ζ), the mirror image of the same oscillator. Plots and numbers show it \
                        with positive signs.";
            ui.weak(text);
        }
    });
    steady_ui(ui, "causes", is_held, |ui| {
        if is_good {
            causes::models_ui(ui, context, estimates, requests);
        } else {
            causes::causes_ui(ui, context, estimates, is_held, requests);
        }
    });
    evidence::evidence_ui(ui, &diagnosis.evidence, color, palette);
}

fn is_mirrored(estimates: &Estimates) -> bool {
    let Some(last) = estimates.len().checked_sub(1) else { return false };
    (0..estimates.channels().len()).any(|place| estimates.canonical_sign(last, place) < 0.0)
}
