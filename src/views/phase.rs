//! Velocity over displacement.

use egui::Ui;
use egui_plot::Points;
use kalmanscope_core::Channel;

use crate::plot::plane::{aged_path, around, drawable, plane_ui};
use crate::request::Request;
use crate::view::{View, ViewContext};

/// Duration of the past that is drawn \[s\].
const TAIL: f64 = 5.0;

pub(super) static VIEW: View = View {
    name: "Phase portrait",
    help: [
        "Velocity over displacement of the last five seconds, fading with age: truth thick, each filter's estimate in its colour.",
        "A free linear oscillator spirals inwards along ellipses; a hardening spring makes them taller than wide.",
        "The dots are where truth and estimates are now.",
    ],
    ui: Some(view_ui),
    ..View::NONE
};

fn view_ui(ui: &mut Ui, context: &ViewContext<'_>, _: &mut Vec<Request>) -> Option<f64> {
    let ViewContext { session, palette, visible, axis, .. } = *context;
    let run = session.run();
    let record = run.record();
    let last = axis.readout(session);
    let first = last.saturating_sub((TAIL / record.dt()) as usize);
    // A few hundred points are smooth enough.
    let stride = ((last - first) / 600).max(1);
    let samples = |end: usize| (first..(last + 1).min(end)).rev().step_by(stride);
    let truth = record.truth(Channel::DISPLACEMENT).zip(record.truth(Channel::VELOCITY)).filter(|_| visible.truth);
    let mut paths: Vec<(Vec<[f64; 2]>, egui::Color32, f32)> = Vec::new();
    if let Some((x, v)) = truth {
        paths.push((samples(run.len()).map(|k| [x[k], v[k]]).collect(), palette.truth, 3.0));
    }
    for (_, estimates) in context.filters() {
        let at = |channel| estimates.place(channel);
        if let (Some(x), Some(v)) = (at(Channel::DISPLACEMENT), at(Channel::VELOCITY)) {
            let path = samples(estimates.len()).map(|k| [estimates.mean(k)[x], estimates.mean(k)[v]]);
            paths.push((path.collect(), context.color(estimates), 1.4));
        }
    }
    // Some more of the motion than is drawn, so that the frame changes little.
    let begin = last.saturating_sub((3.0 * TAIL / record.dt()) as usize);
    let past = || (begin..last + 1).step_by(((last - begin) / 600).max(1));
    let reach = |channel: Channel| match record.truth(channel) {
        // A simulation that overflows at once has no sample.
        Some(truth) => around(past().filter_map(|k| truth.get(k).copied())),
        None => around(paths.iter().flat_map(|(path, ..)| path).map(|p| p[usize::from(channel == Channel::VELOCITY)])),
    };
    let range = reach(Channel::DISPLACEMENT).zip(reach(Channel::VELOCITY)).map(|(x, y)| [x, y]);
    let names = [("displacement x", "m"), ("velocity v", "m/s")];
    let names = names.map(|(name, unit)| format!("{name} [{}]", context.unit(unit)));
    plane_ui(ui, "phase portrait", names.each_ref().map(String::as_str), palette, range, |plot| {
        for (path, color, width) in paths {
            let now = path.first().map(|now| drawable(plot, *now));
            aged_path(plot, &path, color, width);
            if let Some(now) = now {
                plot.points(Points::new("now", vec![now]).color(color).radius(2.0 + width).allow_hover(false));
            }
        }
    });
    None
}
