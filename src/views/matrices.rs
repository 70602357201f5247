//! Predict and update of one sample: the flow of the filter, and the same step by hand.

mod by_hand;
mod diagram;
mod step;

use by_hand::{HIDDEN, equations_ui};
use diagram::Diagram;
use egui::{ComboBox, Id, RichText, ScrollArea, Ui};
use kalmanscope_core::{Channel, Estimates};
use step::{FilterStep, StepResult};

use crate::plot::medium::Medium;
use crate::request::Request;
use crate::text::significant;
use crate::theme;
use crate::view::{View, ViewContext};
use crate::views::gain::sensor_ui;

pub(super) static VIEW: View = View {
    name: "Predict and update",
    help: [
        "One sample as a flow: the belief before, the prediction, the innovation, the gain, the belief after; below it the same by hand.",
        "Predicting carries mean and covariance over a step and widens σ; updating moves the mean by K e and narrows σ. Dots are sigma points.",
        "Step with the button (→) and follow how each number leads to the next, or hide the results and work them out.",
    ],
    ui: Some(view_ui),
    ..View::NONE
};

fn view_ui(ui: &mut Ui, context: &ViewContext<'_>, requests: &mut Vec<Request>) -> Option<f64> {
    let ViewContext { session, axis, visible, .. } = *context;
    let k = axis.readout(session);
    let channels = channels(context);
    let first = channels.iter().find(|channel| channel.is_parameter()).or(channels.first()).copied();
    let Some(channel) = visible.channel.filter(|channel| channels.contains(channel)).or(first) else {
        ui.weak("There is no filter.");
        return None;
    };
    let choice = (channel, visible.sensor.min(session.sensors().len().saturating_sub(1)));
    if Medium::of(ui.ctx()) == Medium::Screen {
        head_ui(ui, context, &channels, choice, requests);
    }
    let width = ui.available_width();
    ScrollArea::both().auto_shrink(false).show(ui, |ui| {
        // An equation may be wider, and scrolls.
        ui.set_max_width(width);
        for (place, estimates) in context.filters().filter(|(_, estimates)| k < estimates.len()) {
            let record = session.run().record();
            let number = record.forgotten() + k;
            let title = format!("{}, sample {number}, t = {:.3} s", estimates.name(), record.time(k));
            ui.label(RichText::new(title).family(theme::strong()).color(context.color(estimates)));
            if number == 0 {
                ui.weak("The initial belief: nothing has been predicted or measured yet.");
            } else if k == 0 {
                ui.weak("The sample before is no longer kept.");
            } else if let Some(step) = FilterStep::of(context, place, choice, k) {
                step_ui(ui, context, estimates, &step, number);
                let (nis, log_likelihood) = (estimates.nis()[k], estimates.log_likelihood(k));
                if !nis.is_nan() {
                    let [nis, ln] = [nis, log_likelihood].map(|x| significant(x, 4));
                    ui.weak(format!("NIS {nis} · log likelihood {ln}"));
                }
            } else {
                ui.weak(format!("This filter does not estimate the {}.", channel.name()));
            }
            ui.add_space(8.0);
        }
    });
    None
}

/// The channels to choose from: those that some filter is in doubt about, if there are any.
fn channels(context: &ViewContext<'_>) -> Vec<Channel> {
    let all = context.visible.channels(context.session.run().channels());
    let in_doubt: Vec<Channel> = all.iter().copied().filter(|channel| context.in_doubt(*channel)).collect();
    if in_doubt.is_empty() { all } else { in_doubt }
}

fn head_ui(
    ui: &mut Ui,
    context: &ViewContext<'_>,
    channels: &[Channel],
    (channel, sensor): (Channel, usize),
    requests: &mut Vec<Request>,
) {
    ui.horizontal_wrapped(|ui| {
        let words = |of: Channel| format!("{} {}", of.symbol(), of.name());
        let combo = ComboBox::from_id_salt("channel of the step").selected_text(words(channel)).show_ui(ui, |ui| {
            for &other in channels {
                if ui.selectable_label(other == channel, words(other)).clicked() {
                    requests.push(Request::ChooseChannel(other));
                }
            }
        });
        ui.ctx().accesskit_node_builder(combo.response.id, |node| node.set_label("Channel of the step"));
        sensor_ui(ui, &context.session.sensors(), sensor, requests);
        let mut hides = context.visible.hides_results;
        if ui.checkbox(&mut hides, "Hide results").on_hover_text("Work each one out, then click its ?").changed() {
            requests.push(Request::HideResults(hides));
        }
    });
}

fn step_ui(ui: &mut Ui, context: &ViewContext<'_>, estimates: &Estimates, step: &FilterStep, number: usize) {
    // The results that the reader has asked for, until the next sample.
    let id = Id::unique(("results of a step", estimates.id()));
    let looked = ui.data(|data| data.get_temp::<(usize, Vec<StepResult>)>(id));
    let mut looked = looked.filter(|(of, _)| *of == number).map_or_else(Vec::new, |(_, looked)| looked);
    let hides = context.visible.hides_results && Medium::of(ui.ctx()) == Medium::Screen;
    let shown = |result: StepResult, text: String| {
        if hides && !looked.contains(&result) { HIDDEN.to_owned() } else { text }
    };
    let (color, palette) = (context.color(estimates), context.palette);
    Diagram { step, name: estimates.name(), color, palette, shown: &shown }.ui(ui);
    for (_, sentence) in remarks(step).into_iter().filter(|(is_so, _)| *is_so) {
        ui.weak(sentence);
    }
    // A figure is for paper or a slide, which has no room for more than the flow.
    if Medium::of(ui.ctx()) == Medium::Figure {
        return;
    }
    if let Some(wanted) = equations_ui(ui, estimates.id(), step, &shown) {
        looked.push(wanted);
        ui.data_mut(|data| data.insert_temp(id, (number, looked)));
    }
}

fn remarks(step: &FilterStep) -> [(bool, &'static str); 4] {
    let (is_read, is_any_read) = (step.update.is_some(), !step.terms.is_empty());
    [
        (
            step.spread.as_ref().is_some_and(|spread| spread.parts > 1),
            "The step has several parts; each draws its points.",
        ),
        (!is_any_read, "No reading: the belief stays as predicted."),
        (is_any_read && !is_read, "This sensor has no reading; others have moved the belief."),
        (!step.is_exact, "The prediction of this filter is not kept: it is taken back from K e and K S Kᵀ."),
    ]
}
