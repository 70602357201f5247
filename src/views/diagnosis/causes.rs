//! What is wrong with a filter, as far as trials tell, with buttons that turn the knobs.

use egui::{Button, Label, ProgressBar, RichText, Ui};
use kalmanscope_core::Estimates;
use kalmanscope_core::diagnosis::{Finding, Knob};

use super::sentence;
use crate::request::Request;
use crate::session::Attempt;
use crate::text::significant;
use crate::theme::{self, Palette};
use crate::verdict::{symbol, text_color};
use crate::view::ViewContext;

/// The most settings whose values a button shows.
const SHOWN: usize = 2;

pub(super) fn causes_ui(ui: &mut Ui, context: &ViewContext<'_>, estimates: &Estimates, requests: &mut Vec<Request>) {
    let ViewContext { session, palette, .. } = *context;
    ui.add_space(4.0);
    ui.label(RichText::new("Causes, the likeliest first").small().weak());
    let Some(attempt) = session.attempt(estimates.id()) else {
        ui.weak("They are tried as soon as the record is computed.");
        return;
    };
    for finding in attempt.findings() {
        finding_ui(ui, context, (attempt, finding), estimates.name(), palette, requests);
    }
    if attempt.is_under_way() {
        let bar = ProgressBar::new(attempt.progress() as f32).desired_width(160.0).desired_height(8.0);
        let bar = ui.add(bar).on_hover_text("The filter runs again with one setting after another changed");
        bar.ctx.accesskit_node_builder(bar.id, |node| node.set_label(format!("Trials of {}", estimates.name())));
    } else if attempt.findings().is_empty() {
        ui.weak("None of the causes that are known makes the record likelier.");
    }
}

fn finding_ui(
    ui: &mut Ui,
    context: &ViewContext<'_>,
    (attempt, finding): (&Attempt, &Finding),
    name: &str,
    palette: &Palette,
    requests: &mut Vec<Request>,
) {
    let Finding { suspect, gain, after } = finding;
    ui.horizontal_wrapped(|ui| {
        let cause = RichText::new(sentence(suspect.cause.name)).family(theme::strong());
        ui.label(cause).on_hover_text(suspect.cause.hint);
        if let (Some(before), Some(after)) = (attempt.before(), after) {
            ui.weak(format!("{} {} →", symbol(before.kind), before.kind.name()));
            let text = format!("{} {}", symbol(after.kind), after.kind.name());
            let text = RichText::new(text).color(text_color(after.kind, palette));
            ui.label(text).on_hover_text(format!("With the knob turned it is {after}"));
        }
    });
    ui.add(Label::new(format!("{}.", sentence(&suspect.sentence))).wrap());
    let knobs: Vec<Knob> = suspect.knobs.iter().map(Knob::rounded).collect();
    ui.horizontal_wrapped(|ui| {
        if !knobs.is_empty() {
            knob_ui(ui, context, (name, suspect.cause.name), &knobs, requests);
        }
        if gain.is_finite() && *gain > 0.0 {
            ui.weak(format!("log likelihood +{}", significant(*gain, 3)))
                .on_hover_text("The gain of the trial, less what its numbers gain by chance");
        }
    });
    ui.add(Label::new(RichText::new(suspect.cause.hint).small().weak()).wrap());
    ui.add_space(5.0);
}

/// The button that turns the knobs of a cause.
fn knob_ui(
    ui: &mut Ui,
    context: &ViewContext<'_>,
    (filter, cause): (&str, &str),
    knobs: &[Knob],
    requests: &mut Vec<Request>,
) {
    let lines: Vec<String> = knobs.iter().map(Knob::toml_line).collect();
    let more = if lines.len() > SHOWN { format!(" and {} more", lines.len() - SHOWN) } else { String::new() };
    let text = format!("Set {}{more}", lines[..lines.len().min(SHOWN)].join(", "));
    let button = ui.add(Button::new(text).wrap()).on_hover_text(lines.join("\n"));
    button.ctx.accesskit_node_builder(button.id, |node| node.set_label(format!("Turn the knob of {filter}: {cause}")));
    if button.clicked()
        && let Ok(turned) = Knob::apply_all(knobs, context.session.scenario())
    {
        requests.push(Request::Edit(Box::new(turned)));
    }
}
