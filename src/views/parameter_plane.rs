//! Two parameters against each other, with the covariance between them.

mod posterior;

use egui::{Align2, Color32, RichText, Ui};
use egui_plot::{Line, MarkerShape, Points, Text};
use kalmanscope_core::{Channel, Estimates};

use crate::laboratory::Posteriors;
use crate::plot::plane::{aged_path, around, drawable, plane_ui};
use crate::request::Request;
use crate::view::{View, ViewContext};

type Points2 = Vec<[f64; 2]>;

pub(super) struct ParameterPlane;

/// Semi-axes of the ellipse that holds 95 % of a normal distribution in the plane, in standard deviations.
const ELLIPSE: f64 = 2.447_746_830_680_816;

impl View for ParameterPlane {
    fn name(&self) -> &'static str {
        "Parameter plane"
    }

    fn help(&self) -> [&'static str; 3] {
        [
            "The path of each filter's estimate in the plane of the first two parameters, and its 95 % ellipse.",
            "The cross is the truth: the ellipse of a consistent filter contains it 19 times of 20.",
            "A tilted ellipse: the filter cannot tell the two apart, only a combination of them. *Posterior of* draws what the readings say without the belief that it is normal.",
        ]
    }

    fn ui(&self, ui: &mut Ui, context: &ViewContext<'_>, requests: &mut Vec<Request>) -> Option<f64> {
        let ViewContext { session, palette, visible, axis, .. } = *context;
        let run = session.run();
        let parameters: Vec<Channel> = run.channels().into_iter().filter(|c| c.is_parameter()).collect();
        let [x, y, ..] = parameters[..] else {
            ui.weak("There are not two parameters.");
            return None;
        };
        let posteriors = context.laboratory.map(|laboratory| &laboratory.posteriors);
        if let Some(posteriors) = posteriors {
            posterior::head_ui(ui, context, posteriors, requests);
        }
        let cloud = posteriors.and_then(|posteriors| cloud(context, posteriors, [x, y]));
        let k = axis.readout(session);
        let mut paths: Vec<(Points2, Points2, Color32)> = Vec::new();
        for (_, estimates) in context.filters() {
            let (Some(i), Some(j)) = (estimates.place(x), estimates.place(y)) else { continue };
            let Some(last) = estimates.len().checked_sub(1).map(|last| last.min(k)) else { continue };
            let stride = (last / 800).max(1);
            let path = (0..=last).rev().step_by(stride);
            let path = path.map(|k| [estimates.canonical_mean(k, i), estimates.canonical_mean(k, j)]).collect();
            paths.push((path, ellipse(estimates, last, [i, j]), palette.shade(estimates.color())));
        }
        let truth = run.record().truth(x).zip(run.record().truth(y)).and_then(|(x, y)| Some([*x.get(k)?, *y.get(k)?]));
        let truth = truth.filter(|_| visible.truth);
        let seen = |axis: usize| {
            // The range includes the ellipses and the truth at this time; a wide initial belief may go beyond it.
            paths
                .iter()
                .flat_map(|(path, ellipse, _)| ellipse.iter().chain(path.first()))
                .chain(&truth)
                .chain(cloud.iter().flat_map(|(points, _)| points))
                .map(move |p| p[axis])
        };
        let range = around(seen(0)).zip(around(seen(1))).map(|(x, y)| [x, y]);
        let label = |c: Channel| match context.unit(c.unit()) {
            "" => format!("{} {}", c.name(), c.symbol()),
            unit => format!("{} {} [{unit}]", c.name(), c.symbol()),
        };
        let mut labelled = false;
        plane_ui(ui, "parameter plane", [&label(x), &label(y)], palette, range, |plot| {
            // Behind points a path is only a hint.
            let strength = if cloud.is_some() { 0.4 } else { 1.0 };
            for (path, _, color) in &paths {
                aged_path(plot, path, color.gamma_multiply(strength), 1.4);
            }
            if let Some((points, color)) = cloud {
                let points: Points2 = points.into_iter().map(|point| drawable(plot, point)).collect();
                plot.points(Points::new("posterior", points).color(color).radius(1.8).allow_hover(false));
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
}

/// The points of the posterior in the plane, and their colour: the filter's, fainter where they are of another time.
fn cloud(context: &ViewContext<'_>, posteriors: &Posteriors, [x, y]: [Channel; 2]) -> Option<(Points2, Color32)> {
    let shown = posteriors.shown.as_ref()?;
    let (_, estimates) = context.filters().find(|(_, estimates)| estimates.id() == shown.filter())?;
    let [x, y] = [shown.sampled.values(x)?, shown.sampled.values(y)?];
    let points = x.into_iter().zip(y).map(|(x, y)| [x, y]).collect();
    let strength = if shown.is_of_now { 0.6 } else { 0.25 };
    Some((points, context.palette.shade(estimates.color()).gamma_multiply(strength)))
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
