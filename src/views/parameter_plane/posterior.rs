//! The posterior of a filter's parameters: the choice above the plane, and what the points say about the filter's ±2σ.

use egui::{ComboBox, Ui};
use kalmanscope_core::Estimates;

use crate::laboratory::{Posteriors, Shown};
use crate::request::Request;
use crate::text::{decimals, fixed, significant};
use crate::view::ViewContext;

/// A mean is worth a word if it is so many standard deviations of the posterior away from the posterior's mean.
const AWAY: f64 = 1.0;

/// The line above the plane.
pub(super) fn head_ui(ui: &mut Ui, context: &ViewContext<'_>, posteriors: &Posteriors, requests: &mut Vec<Request>) {
    const HINT: &str = "Points of the parameters' probability given the readings, found without the belief that it is normal. \
                        Where they leave the ellipse, ±2σ is wrong.";
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 5.0;
        ui.label("Posterior of").on_hover_text(HINT);
        let chosen = posteriors.chosen();
        let name = |id: u32| context.filters().find(|(_, of)| of.id() == id).map_or("none", |(_, of)| of.name());
        let combo = ComboBox::from_id_salt("posterior").selected_text(chosen.map_or("none", name)).width(72.0);
        let combo = combo.show_ui(ui, |ui| {
            let all =
                std::iter::once((None, "none")).chain(context.filters().map(|(_, of)| (Some(of.id()), of.name())));
            for (id, name) in all {
                if ui.selectable_label(chosen == id, name).clicked() && chosen != id {
                    requests.push(Request::ChoosePosterior(id));
                }
            }
        });
        ui.ctx().accesskit_node_builder(combo.response.id, |node| node.set_label("Filter of the posterior"));
        if let Some(share) = posteriors.progress() {
            ui.weak(format!("{:.0} %", 100.0 * share));
        }
        if let Some(problem) = posteriors.problem() {
            ui.weak(problem);
        }
        if let Some(sentences) = posteriors.shown().and_then(|shown| sentences(context, shown)) {
            ui.weak(sentences);
        }
    });
}

/// What the points say about the filter's belief at their time.
pub(super) fn sentences(context: &ViewContext<'_>, shown: &Shown) -> Option<String> {
    let (_, estimates) = context.filters().find(|(_, of)| of.id() == shown.filter())?;
    let run = context.session.run();
    let filter = run.scenario().filters.iter().find(|filter| filter.id == shown.filter())?;
    let mut text = comparison(estimates, shown)?;
    if let Some((channel, solutions)) = shown.sampled().solutions() {
        let [low, high] = solutions.means.map(|mean| fixed(mean, decimals(channel)));
        let [one, other] = solutions.shares.map(|share| 100.0 * share);
        let symbol = channel.symbol();
        text += &format!(" Two solutions: {symbol} {low} ({one:.0} %) or {high} ({other:.0} %).");
    }
    if shown.sampled().is_let_change(filter, shown.last().0) {
        text += " The filter lets the parameters change, the posterior does not.";
    }
    Some(text)
}

/// The filter's ±2σ over those of the posterior, and means that are away from each other.
fn comparison(estimates: &Estimates, shown: &Shown) -> Option<String> {
    let (sample, time) = shown.last();
    let (mut ratios, mut away) = (Vec::new(), Vec::new());
    for &channel in &shown.sampled().channels {
        let place = estimates.place(channel).filter(|_| sample < estimates.len())?;
        let [mean, std] = shown.sampled().moments(channel)?;
        let symbol = channel.symbol();
        ratios.push(format!("{} ({symbol})", significant(estimates.std(sample, place) / std, 2)));
        let by = (estimates.canonical_mean(sample, place) - mean).abs() / std;
        if by > AWAY {
            away.push(format!("{} posterior σ away in {symbol}", significant(by, 2)));
        }
    }
    let mut text = format!("At {} s its ±2σ is {} times the posterior's", fixed(time, 2), listed(&ratios));
    if !away.is_empty() {
        text += &format!(", and its mean {}", listed(&away));
    }
    Some(text + ".")
}

fn listed(words: &[String]) -> String {
    match words {
        [all @ .., before, last] => {
            let mut text: String = all.iter().map(|word| format!("{word}, ")).collect();
            text += &format!("{before} and {last}");
            text
        }
        _ => words.concat(),
    }
}
