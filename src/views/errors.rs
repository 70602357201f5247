//! Estimation errors over time within their ±2σ, and the Cramér-Rao bound.

use kalmanscope_core::Channel;

use crate::plot::chart::Chart;
use crate::plot::layers::{Layer, line_width};
use crate::plot::series::{Band, Series};
use crate::session::{Bound, Wanted};
use crate::sheet::plus_minus;
use crate::text::{decimals, error_in_hertz};
use crate::view::{View, ViewContext};

pub(super) struct Errors;

impl View for Errors {
    fn name(&self) -> &'static str {
        "Errors"
    }

    fn help(&self) -> [&'static str; 3] {
        [
            "Estimate minus truth over time, in the filter's ±2σ band; dashed is ±2 times the Cramér-Rao bound.",
            "An error outside its band more than 5 % of the time: the filter is overconfident. Far inside all the time: it is underconfident.",
            "No unbiased filter with the same initial belief and noise has a band inside the dashed lines.",
        ]
    }

    fn wanted(&self) -> Wanted {
        Wanted::BOUNDS
    }

    fn charts<'a>(&self, context: &ViewContext<'a>) -> Vec<Chart<'a>> {
        channels(context).into_iter().map(|channel| chart(channel, context)).collect()
    }

    fn plots(&self, context: &ViewContext<'_>) -> usize {
        channels(context).len()
    }

    fn without_charts(&self) -> &'static str {
        "The truth of this record is not known."
    }
}

fn channels(context: &ViewContext<'_>) -> Vec<Channel> {
    let record = context.session.run().record();
    let channels = context.session.run().channels();
    let (parameters, states): (Vec<Channel>, Vec<Channel>) = channels
        .into_iter()
        .filter(|c| record.truth(*c).is_some() && context.in_doubt(*c))
        .partition(|c| c.is_parameter());
    context.visible.channels([parameters, states].concat())
}

fn chart<'a>(channel: Channel, context: &ViewContext<'a>) -> Chart<'a> {
    let ViewContext { session, palette, visible, .. } = *context;
    let truth = session.run().record().truth(channel).unwrap_or_default();
    let decimals = decimals(channel);
    let bands = context.estimating(channel).filter(|_| visible.bands).map(|(_, of, at)| {
        let variances = of.variances(at);
        context.band(of, Band::around_zero(variances.len(), |samples| variances[samples].iter().copied()), 0.0)
    });
    let mut layers: Vec<Layer<'a>> = bands.chain([Layer::zero(palette.truth)]).collect();
    let mut columns = Vec::new();
    for (place, of, at) in context.estimating(channel) {
        let means = of.canonical_means(at);
        let errors = Series::new(means.len(), move |samples| {
            means[samples.clone()].iter().zip(&truth[samples]).map(|(mean, truth)| mean - truth)
        });
        layers.push(context.line(of, errors, line_width(place, 2.0)));
        let error = move |k: usize| of.canonical_mean(k, at) - truth[k];
        let text = move |k| Some(plus_minus(error(k), of.std(k, at), decimals));
        columns.push(context.column(of, text).with_aside(move |k| error_in_hertz(error(k), channel.unit(), decimals)));
    }
    for Bound { bound, filters } in session.bounds().iter().filter(|_| visible.bands) {
        let Some((_, of)) = context.filters().find(|(_, of)| filters.contains(&of.id())) else { continue };
        let Some(at) = bound.place(channel) else { continue };
        for sign in [-2.0, 2.0] {
            let series = Series::new(bound.len(), move |samples| samples.map(move |k| sign * bound.std(k, at)));
            layers.push(Layer::dashed(series, context.color(of), 1.0));
        }
    }
    Chart {
        key: format!("error of {}", channel.key()),
        title: format!("error of the {}", channel.name()),
        symbol: format!("{} error", channel.symbol()),
        name: channel.name().to_owned(),
        unit: context.unit(channel.unit()),
        columns,
        layers,
        ..Chart::default()
    }
}
