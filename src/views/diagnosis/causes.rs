//! The likely causes of a filter's verdict, with buttons that make the edits.

use egui::{Button, CollapsingHeader, Label, ProgressBar, RichText, Ui};
use kalmanscope_core::Estimates;
use kalmanscope_core::setting::{Change, Edit};
use kalmanscope_diagnosis::{Remedy, in_percent};

use super::evidence;
use crate::request::Request;
use crate::session::Attempt;
use crate::text::{sentence, significant};
use crate::theme;
use crate::verdict::{symbol, text_color};
use crate::view::ViewContext;
use crate::widgets::named;

const LIKELIEST: usize = 1;

const SHOWN: usize = 2;

/// The causes so far, and the progress of the trials. The rows stay in place while the pointer is on them.
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
        ui.weak("They are tested when the run is complete.");
        return;
    };
    let rows = evidence::on_screen(ui, attempt, is_held);
    let heading = match (attempt.is_under_way(), evidence::is_in_order(&rows, attempt)) {
        (true, _) => "Likely causes, in the order found",
        (false, true) => SORTED,
        (false, false) => "Likely causes, sorted when the pointer leaves",
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
        finding_ui(ui, context, (attempt, remedy, probability(remedy)), estimates, requests);
    }
    if !rest.is_empty() {
        let title = RichText::new(format!("{} less likely", rest.len())).small().weak();
        CollapsingHeader::new(title).id_salt("less likely").show(ui, |ui| {
            for remedy in rest {
                finding_ui(ui, context, (attempt, remedy, probability(remedy)), estimates, requests);
            }
        });
    }
    if attempt.is_under_way() {
        let bar = ProgressBar::new(attempt.progress as f32).desired_width(160.0).desired_height(8.0);
        let bar = ui.add(bar).on_hover_text("Runs the filter again, with one setting changed each time");
        bar.ctx.accesskit_node_builder(bar.id, |node| node.set_label(format!("Trials of {}", estimates.name())));
    } else if attempt.remedies.is_empty() {
        ui.weak("No cause that we know improves the fit. Perhaps the model lacks something.");
    } else if !Remedy::is_explained(&attempt.remedies) {
        // Below the rows, so that these do not move.
        ui.label("No single cause explains it. Even after the best remedy the filter cannot be believed.");
    }
}

pub(super) fn models_ui(ui: &mut Ui, context: &ViewContext<'_>, estimates: &Estimates, requests: &mut Vec<Request>) {
    let attempt = context.session.attempt(estimates.id()).filter(|attempt| !attempt.is_under_way());
    let Some(attempt) = attempt.filter(|attempt| !attempt.remedies.is_empty()) else { return };
    ui.add_space(4.0);
    heading_ui(ui, "Another model fits better");
    for remedy in &attempt.remedies {
        finding_ui(ui, context, (attempt, remedy, None), estimates, requests);
    }
}

const SORTED: &str = "Likely causes, best remedy first";

const PROBABILITY: &str = "How often such a finding was right, where a known fault was put into random situations";

fn heading_ui(ui: &mut Ui, text: &str) {
    ui.add(Label::new(RichText::new(text).small().weak()).truncate());
}

fn finding_ui(
    ui: &mut Ui,
    context: &ViewContext<'_>,
    (attempt, remedy, probability): (&Attempt, &Remedy, Option<f64>),
    estimates: &Estimates,
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
        edits_ui(ui, context, (estimates, first.cause.name), edits, requests);
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
    (filter, cause): (&Estimates, &str),
    edits: &[Edit],
    requests: &mut Vec<Request>,
) {
    let scenario = context.session.scenario();
    let words: Vec<String> = edits.iter().map(|edit| edit.in_words(scenario)).collect();
    let text = match &words[..] {
        [first, rest @ ..] if words.len() > SHOWN => format!("{first}, and {} more settings", rest.len()),
        few => few.join(", "),
    };
    let button = ui.add(Button::new(sentence(&text)).wrap()).on_hover_text(words.join("\n"));
    let name = format!("Apply the remedy of {}: {cause}", filter.name());
    if named(button, name).clicked() {
        request(edits.to_vec(), requests);
    }
    let own = format!("filters#{}.", filter.id());
    if scenario.filters.len() > 1 && edits.iter().any(|edit| edit.key.starts_with(&own)) {
        let button = ui.small_button("The same for all filters");
        if named(button, format!("Apply the remedy of all filters: {cause}")).clicked() {
            let of_all = |edit: &Edit| Edit { key: edit.key.replace(&own, "filters.*."), value: edit.value.clone() };
            request(edits.iter().map(of_all).collect(), requests);
        }
    }
}

fn request(edits: Vec<Edit>, requests: &mut Vec<Request>) {
    let mut change = Change::default();
    edits.into_iter().for_each(|edit| change.edit(edit));
    requests.push(Request::Edit(change));
}
