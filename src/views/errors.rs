//! Estimation errors over time within their ±2σ, and the Cramér-Rao bound.

use egui::Ui;
use kalmanscope_core::Channel;

use super::channels::decimals;
use super::chart::Chart;
use super::charts::charts_ui;
use super::heading::Readout;
use super::layer::{Layer, line_width};
use super::sampled::{Band, Series};
use super::{View, ViewContext};
use crate::command::Command;
use crate::session::Bound;
use crate::text::fixed;

/// Estimate minus truth.
pub(super) struct Errors;

impl View for Errors {
    fn name(&self) -> &'static str {
        "Errors"
    }

    fn help(&self) -> [&'static str; 3] {
        [
            "Estimate minus truth over time, in the band ±2σ that the filter claims; dashed is ±2 times the Cramér-Rao bound.",
            "An error outside its band more than 5 % of the time: the filter is overconfident. Far inside all the time: it is too modest.",
            "No unbiased filter with the same knowledge can be surer than the dashed lines.",
        ]
    }

    fn ui(&self, ui: &mut Ui, context: &ViewContext<'_>, commands: &mut Vec<Command>) -> Option<f64> {
        let record = context.session.run().record();
        let channels = context.session.run().channels();
        let (parameters, states): (Vec<Channel>, Vec<Channel>) = channels
            .into_iter()
            .filter(|c| record.truth(*c).is_some() && context.in_doubt(*c))
            .partition(|c| c.is_parameter());
        let channels = context.shown.channels([parameters, states].concat());
        if channels.is_empty() {
            ui.weak("The truth of this record is not known.");
        }
        charts_ui(ui, channels.len(), context, commands, |i, last_row| chart(channels[i], context, last_row))
    }
}

fn chart<'a>(channel: Channel, context: &ViewContext<'a>, last_row: bool) -> Chart<'a> {
    let ViewContext { session, palette, shown, axis, .. } = *context;
    let run = session.run();
    let truth = run.record().truth(channel).unwrap_or_default();
    let k = axis.readout(session);
    let decimals = decimals(channel);
    let mut layers: Vec<Layer<'a>> = Vec::new();
    let mut readouts = Vec::new();
    let filters = || run.estimates().iter().enumerate().filter(|&(place, _)| shown.filter(place));
    for (place, estimates) in filters() {
        let Some(at) = estimates.place(channel) else { continue };
        if shown.bands {
            let variances = estimates.variances(at);
            let band = Band::around_zero(variances.len(), |samples| variances[samples].iter().copied());
            layers.push(Layer::Band { band, color: palette.filter(place), under: 0.0 });
        }
        if k < estimates.len() {
            let error = estimates.canonical_mean(k, at) - truth[k];
            readouts.push(Readout {
                text: format!("{} ±{}", fixed(error, decimals), fixed(2.0 * estimates.std(k, at), decimals)),
                color: palette.filter(place),
                hint: estimates.name().to_owned(),
            });
        }
    }
    layers.push(Layer::Level { value: 0.0, color: palette.truth });
    for (place, estimates) in filters() {
        let Some(at) = estimates.place(channel) else { continue };
        let means = estimates.canonical_means(at);
        layers.push(Layer::Line {
            series: Series::new(means.len(), move |samples| {
                means[samples.clone()].iter().zip(&truth[samples]).map(|(mean, truth)| mean - truth)
            }),
            color: palette.filter(place),
            width: line_width(place, 2.0),
            dashed: false,
            bounds: false,
        });
    }
    for Bound { bound, places } in session.bounds().iter().filter(|_| shown.bands) {
        let Some(&place) = places.iter().find(|&&place| shown.filter(place)) else { continue };
        let Some(at) = bound.place(channel) else { continue };
        for sign in [-2.0, 2.0] {
            layers.push(Layer::Line {
                series: Series::new(bound.len(), move |samples| samples.map(move |k| sign * bound.std(k, at))),
                color: palette.filter(place),
                width: 1.0,
                dashed: true,
                bounds: false,
            });
        }
    }
    Chart {
        key: format!("error of {}", channel.key()),
        title: format!("error of the {}", channel.name()),
        symbol: format!("{} error", channel.symbol()),
        name: channel.name().to_owned(),
        unit: channel.unit(),
        readouts,
        layers,
        last_row,
        least: None,
        logarithmic: false,
    }
}
