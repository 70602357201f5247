//! The posterior of a filter's parameters: the choice above the plane, and what the points say about the filter's ±2σ.

use egui::{ComboBox, Ui};
use kalmanscope_core::Estimates;

use crate::laboratory::{Posteriors, Shown};
use crate::request::Request;
use crate::text::{decimals, fixed, significant};
use crate::view::ViewContext;

/// The distance between both means beyond which it is reported, in standard deviations of the posterior.
const AWAY: f64 = 1.0;

pub(super) fn head_ui(ui: &mut Ui, context: &ViewContext<'_>, posteriors: &Posteriors, requests: &mut Vec<Request>) {
    const HINT: &str = "Points of the parameters' probability given the readings, found without the belief that it is normal. \
                        Where they leave the ellipse, ±2σ is wrong.";
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 5.0;
        ui.label("Posterior of").on_hover_text(HINT);
        let chosen = posteriors.chosen;
        let all = context.session.run().estimates();
        let filter = chosen.and_then(|id| all.iter().find(|of| of.id() == id));
        let combo =
            ComboBox::from_id_salt("posterior").selected_text(filter.map_or("none", Estimates::name)).width(72.0);
        let combo = combo.show_ui(ui, |ui| {
            let choices = all.iter().map(|of| (Some(of.id()), of.name()));
            for (id, name) in std::iter::once((None, "none")).chain(choices) {
                if ui.selectable_label(chosen == id, name).clicked() && chosen != id {
                    requests.push(Request::ChoosePosterior(id));
                }
            }
        });
        ui.ctx().accesskit_node_builder(combo.response.id, |node| node.set_label("Filter of the posterior"));
        if let Some(filter) = filter {
            ui.weak(words(context, posteriors, filter));
        }
    });
}

fn words(context: &ViewContext<'_>, posteriors: &Posteriors, filter: &Estimates) -> String {
    let is_hidden = !context.visible.filter(filter.id());
    let result = || posteriors.shown.as_ref().and_then(|shown| sentences(context, shown, filter));
    match (posteriors.progress(), posteriors.problem.as_deref()) {
        _ if is_hidden => format!("{} is hidden.", filter.name()),
        (Some(share), _) => format!("{:.0} %", 100.0 * share),
        (_, Some(problem)) => problem.to_owned(),
        _ if context.session.playing() => "It is found when the playback stops.".to_owned(),
        _ => result().unwrap_or_default(),
    }
}

fn sentences(context: &ViewContext<'_>, shown: &Shown, estimates: &Estimates) -> Option<String> {
    let run = context.session.run();
    let filter = run.scenario().filters.iter().find(|filter| filter.id == shown.filter())?;
    let mut text = comparison(estimates, shown)?;
    if let Some((channel, solutions)) = shown.solutions {
        let [low, high] = solutions.means.map(|mean| fixed(mean, decimals(channel)));
        let [one, other] = solutions.shares.map(|share| 100.0 * share);
        let symbol = channel.symbol();
        text += &format!(" Two solutions: {symbol} {low} ({one:.0} %) or {high} ({other:.0} %).");
    }
    if shown.sampled.is_stiller_than(filter, shown.last().0) {
        text += " The filter lets the parameters change, the posterior does not.";
    }
    Some(text)
}

fn comparison(estimates: &Estimates, shown: &Shown) -> Option<String> {
    let (sample, time) = shown.last();
    let (mut ratios, mut away) = (Vec::new(), Vec::new());
    for &channel in &shown.sampled.channels {
        let place = estimates.place(channel).filter(|_| sample < estimates.len())?;
        let [mean, std] = shown.sampled.moments(channel)?;
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
    match words.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        _ => words.concat(),
    }
}
