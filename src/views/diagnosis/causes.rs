//! The likely causes of a filter's verdict, with buttons that make the edits.

use egui::{Button, CollapsingHeader, Label, ProgressBar, RichText, Ui};
use kalmanscope_core::Estimates;
use kalmanscope_core::diagnosis::{Remedy, in_percent};
use kalmanscope_core::setting::{Change, Edit};

use super::evidence;
use crate::request::Request;
use crate::session::Attempt;
use crate::text::{sentence, significant};
use crate::theme;
use crate::verdict::{symbol, text_color};
use crate::view::ViewContext;

/// The causes that are shown at once: the drawer is read in ten seconds.
const LIKELIEST: usize = 1;

const SHOWN: usize = 2;

/// The causes that were found so far, and the progress of the trials. While the pointer is on them, the rows stay in
/// place.
pub(super) fn causes_ui(
    ui: &mut Ui,
    context: &ViewContext<'_>,
    estimates: &Estimates,
    is_held: bool,
    requests: &mut Vec<Request>,
) {
    ui.add_space(4.0);
    let Some(attempt) = context.session.attempt(estimates.id()) else {
        heading_ui(ui, SORTED);
        ui.weak("They are tried as soon as the record is computed.");
        return;
    };
    let rows = evidence::on_screen(ui, attempt, is_held);
    let heading = match (attempt.is_under_way(), evidence::is_in_order(&rows, attempt)) {
        (true, _) => "Causes, as they are found",
        (false, true) => SORTED,
        (false, false) => "Causes, as they were found: in order once the pointer leaves",
    };
    heading_ui(ui, heading);
    let said = Remedy::probabilities(&attempt.remedies);
    // A row that is held may have become another remedy.
    let probability = |row: &Remedy| {
        let is_same = |other: &Remedy| other.first.cause.key == row.first.cause.key;
        attempt.remedies.iter().position(is_same).map(|place| said[place])
    };
    let (first, rest) = rows.split_at(rows.len().min(LIKELIEST));
    for remedy in first {
        finding_ui(ui, context, (attempt, remedy, probability(remedy)), estimates.name(), requests);
    }
    if !rest.is_empty() {
        let title = RichText::new(format!("{} less likely", rest.len())).small().weak();
        CollapsingHeader::new(title).id_salt("less likely").show(ui, |ui| {
            for remedy in rest {
                finding_ui(ui, context, (attempt, remedy, probability(remedy)), estimates.name(), requests);
            }
        });
    }
    if attempt.is_under_way() {
        let bar = ProgressBar::new(attempt.progress as f32).desired_width(160.0).desired_height(8.0);
        let bar = ui.add(bar).on_hover_text("The filter runs again with one setting after another changed");
        bar.ctx.accesskit_node_builder(bar.id, |node| node.set_label(format!("Trials of {}", estimates.name())));
    } else if attempt.remedies.is_empty() {
        ui.weak("None of the causes that are known makes the record likelier.");
    } else if !Remedy::is_explained(&attempt.remedies) {
        // Below the rows, so that these do not move.
        ui.label("None of these explains it: with the best of them it is still not to be believed.");
    }
}

pub(super) fn models_ui(ui: &mut Ui, context: &ViewContext<'_>, estimates: &Estimates, requests: &mut Vec<Request>) {
    let attempt = context.session.attempt(estimates.id()).filter(|attempt| !attempt.is_under_way());
    let Some(attempt) = attempt.filter(|attempt| !attempt.remedies.is_empty()) else { return };
    ui.add_space(4.0);
    heading_ui(ui, "Yet another model is likelier");
    for remedy in &attempt.remedies {
        finding_ui(ui, context, (attempt, remedy, None), estimates.name(), requests);
    }
}

const SORTED: &str = "Causes and their probability; what cures stands first";

const PROBABILITY: &str = "How often a cause that is found like this one was right, where one of the known faults was put into random situations";

fn heading_ui(ui: &mut Ui, text: &str) {
    ui.add(Label::new(RichText::new(text).small().weak()).truncate());
}

fn finding_ui(
    ui: &mut Ui,
    context: &ViewContext<'_>,
    (attempt, remedy, probability): (&Attempt, &Remedy, Option<f64>),
    name: &str,
    requests: &mut Vec<Request>,
) {
    let palette = context.palette;
    let Remedy { first, then: _, edits, gain, after } = remedy;
    ui.horizontal_wrapped(|ui| {
        for (i, likely) in remedy.causes().enumerate() {
            let name = if i == 0 { sentence(likely.cause.name) } else { format!("and {}", likely.cause.name) };
            ui.label(RichText::new(name).family(theme::strong())).on_hover_text(likely.cause.hint);
        }
        if let Some(probability) = probability {
            ui.weak(in_percent(probability)).on_hover_text(PROBABILITY);
        }
        if let (Some(before), Some(after)) = (attempt.before.as_ref(), after) {
            ui.weak(format!("{} {} →", symbol(before.kind), before.kind.name()));
            let text = format!("{} {}", symbol(after.kind), after.kind.name());
            let text = RichText::new(text).color(text_color(after.kind, palette));
            ui.label(text).on_hover_text(format!("With this change it is {after}"));
        }
    });
    for likely in remedy.causes() {
        ui.add(Label::new(format!("{}.", sentence(&likely.sentence))).wrap());
    }
    if !edits.is_empty() {
        edits_ui(ui, context, (name, first.cause.name), edits, requests);
    }
    let gain = if gain.is_finite() && *gain > 0.0 {
        format!(" The log likelihood gains {}.", significant(*gain, 3))
    } else {
        String::new()
    };
    ui.add(Label::new(RichText::new(format!("{}{gain}", first.cause.hint)).small().weak()).wrap());
    ui.add_space(5.0);
}

fn edits_ui(
    ui: &mut Ui,
    context: &ViewContext<'_>,
    (filter, cause): (&str, &str),
    edits: &[Edit],
    requests: &mut Vec<Request>,
) {
    let scenario = context.session.scenario();
    let words: Vec<String> = edits.iter().map(|edit| edit.in_words(scenario)).collect();
    let more = if words.len() > SHOWN { format!(", and {} more", words.len() - SHOWN) } else { String::new() };
    let text = format!("{}{more}", sentence(&words[..words.len().min(SHOWN)].join(", ")));
    let lines: Vec<String> = edits.iter().map(Edit::toml_line).collect();
    let button = ui.add(Button::new(text).wrap()).on_hover_text(format!("In a file:\n{}", lines.join("\n")));
    button
        .ctx
        .accesskit_node_builder(button.id, |node| node.set_label(format!("Apply the remedy of {filter}: {cause}")));
    if button.clicked() {
        let mut change = Change::default();
        edits.iter().for_each(|edit| change.edit(edit.clone()));
        requests.push(Request::Edit(change));
    }
}
