//! Two quantities against each other: two parameters with the covariance between them, and velocity over displacement.

use egui::{Align2, Color32, RichText, Ui};
use egui_plot::{Line, MarkerShape, Points, Text};
use kalmanscope_core::{Channel, Estimates};

use crate::plot::plane::{Plane, aged_path, around, drawable};
use crate::request::Request;
use crate::view::{View, ViewContext};

type Points2 = Vec<[f64; 2]>;

/// Semi-axes of the ellipse that holds 95 % of a normal distribution in the plane, in standard deviations.
const ELLIPSE: f64 = 2.447_746_830_680_816;

pub(super) static VIEW: View = View {
    name: "Parameter plane",
    help: [
        "The path of each filter's estimate in the plane of the first two parameters, and its 95 % ellipse.",
        "The cross is the truth: the ellipse of a consistent filter contains it 19 times of 20.",
        "A tilted ellipse: the filter cannot tell the two apart, only a combination of them.",
    ],
    ui: Some(view_ui),
    ..View::NONE
};

fn view_ui(ui: &mut Ui, context: &ViewContext<'_>, _: &mut Vec<Request>) -> Option<f64> {
    let ViewContext { session, palette, visible, axis, .. } = *context;
    let run = session.run();
    let parameters: Vec<Channel> = run.channels().into_iter().filter(|c| c.is_parameter()).collect();
    let [x, y, ..] = parameters[..] else {
        ui.weak("There are not two parameters.");
        return None;
    };
    let k = axis.readout(session);
    let mut paths: Vec<(Points2, Points2, Color32)> = Vec::new();
    for (_, estimates) in context.filters() {
        let (Some(i), Some(j)) = (estimates.place(x), estimates.place(y)) else { continue };
        let Some(last) = estimates.len().checked_sub(1).map(|last| last.min(k)) else { continue };
        let stride = (last / 800).max(1);
        let path = (0..=last).rev().step_by(stride);
        let path = path.map(|k| [estimates.canonical_mean(k, i), estimates.canonical_mean(k, j)]).collect();
        paths.push((path, ellipse(estimates, last, [i, j]), context.color(estimates)));
    }
    let truth = run.record().truth(x).zip(run.record().truth(y)).and_then(|(x, y)| Some([*x.get(k)?, *y.get(k)?]));
    let truth = truth.filter(|_| visible.truth);
    let seen = |axis: usize| {
        // The range includes the ellipses and the truth at this time; a wide initial belief may go beyond it.
        paths
            .iter()
            .flat_map(|(path, ellipse, _)| ellipse.iter().chain(path.first()))
            .chain(&truth)
            .map(move |p| p[axis])
    };
    let range = around(seen(0)).zip(around(seen(1))).map(|(x, y)| [x, y]);
    let label = |c: Channel| match context.unit(c.unit()) {
        "" => format!("{} {}", c.name(), c.symbol()),
        unit => format!("{} {} [{unit}]", c.name(), c.symbol()),
    };
    let mut labelled = false;
    Plane::linear("parameter plane", [&label(x), &label(y)]).show(ui, palette, range, |plot| {
        for (path, _, color) in &paths {
            aged_path(plot, path, *color, 1.4);
        }
        for (path, ellipse, color) in paths {
            let now = path.first().map(|now| drawable(plot, *now));
            let ellipse: Points2 = ellipse.into_iter().map(|point| drawable(plot, point)).collect();
            if visible.bands {
                if let Some(top) = ellipse.iter().max_by(|a, b| a[1].total_cmp(&b[1])).filter(|_| !labelled) {
                    labelled = true;
                    let text = Text::new("ellipse's name", (*top).into(), RichText::new("95 %").size(11.5));
                    plot.text(text.color(color).anchor(Align2::CENTER_BOTTOM).allow_hover(false));
                }
                plot.line(Line::new("ellipse", ellipse).color(color).width(2.0).allow_hover(false));
            }
            if let Some(now) = now {
                plot.points(Points::new("now", vec![now]).color(color).radius(4.0).allow_hover(false));
            }
        }
        if let Some(truth) = truth.map(|truth| drawable(plot, truth)) {
            let text = Text::new("truth's name", truth.into(), RichText::new("  truth").size(11.5));
            plot.text(text.color(palette.truth).anchor(Align2::LEFT_BOTTOM).allow_hover(false));
            let cross = Points::new("truth", vec![truth]).shape(MarkerShape::Plus).color(palette.truth).radius(8.0);
            plot.points(cross.allow_hover(false));
        }
    });
    None
}

fn ellipse(estimates: &Estimates, k: usize, [i, j]: [usize; 2]) -> Vec<[f64; 2]> {
    let n = estimates.channels().len();
    let cov = |a: usize, b: usize| {
        estimates.cov(k)[a * n + b] * estimates.canonical_sign(k, a) * estimates.canonical_sign(k, b)
    };
    let centre = [estimates.canonical_mean(k, i), estimates.canonical_mean(k, j)];
    // A lower triangular root of the two by two covariance.
    let a = cov(i, i).sqrt();
    let b = if a > 0.0 { cov(i, j) / a } else { 0.0 };
    let c = (cov(j, j) - b * b).max(0.0).sqrt();
    (0..=72)
        .map(|step| {
            let (sin, cos) = (f64::from(step) * 5.0).to_radians().sin_cos();
            [centre[0] + ELLIPSE * a * cos, centre[1] + ELLIPSE * (b * cos + c * sin)]
        })
        .collect()
}

const TAIL: f64 = 5.0;

pub(super) static PHASE: View = View {
    name: "Phase portrait",
    help: [
        "Velocity over displacement of the last five seconds, fading with age: truth thick, each filter's estimate in its colour.",
        "A free linear oscillator spirals inwards along ellipses; a hardening spring makes them taller than wide.",
        "The dots are where truth and estimates are now.",
    ],
    ui: Some(phase_ui),
    ..View::NONE
};

fn phase_ui(ui: &mut Ui, context: &ViewContext<'_>, _: &mut Vec<Request>) -> Option<f64> {
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
    Plane::linear("phase portrait", names.each_ref().map(String::as_str)).show(ui, palette, range, |plot| {
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
