//! Estimation errors over time within their ±2σ, and the Cramér-Rao bound.

use kalmanscope_core::{Channel, Estimates};

use crate::plot::chart::Chart;
use crate::plot::layers::{Layer, line_width};
use crate::plot::series::{Band, Series};
use crate::session::{Bound, Wanted};
use crate::sheet::Column;
use crate::text::{decimals, error_in_hertz, fixed};
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

fn columns<'a>(channel: Channel, context: &ViewContext<'a>) -> Vec<Column<'a>> {
    let ViewContext { session, palette, .. } = *context;
    let truth = session.run().record().truth(channel).unwrap_or_default();
    let decimals = decimals(channel);
    let column = |(_, estimates): (usize, &'a Estimates)| {
        let at = estimates.place(channel)?;
        let text = move |k: usize| {
            let error = estimates.canonical_mean(k, at) - truth[k];
            format!("{} ±{}", fixed(error, decimals), fixed(2.0 * estimates.std(k, at), decimals))
        };
        let color = palette.shade(estimates.color());
        let column = Column::new(estimates.name(), color, move |k| (k < estimates.len()).then(|| text(k)));
        let error = move |k: usize| (k < estimates.len()).then(|| estimates.canonical_mean(k, at) - truth[k]);
        Some(column.with_aside(move |k| error_in_hertz(error(k)?, channel.unit(), decimals)))
    };
    context.filters().filter_map(column).collect()
}

fn chart<'a>(channel: Channel, context: &ViewContext<'a>) -> Chart<'a> {
    let ViewContext { session, palette, visible, .. } = *context;
    let run = session.run();
    let truth = run.record().truth(channel).unwrap_or_default();
    let mut layers: Vec<Layer<'a>> = Vec::new();
    for (_, estimates) in context.filters() {
        let Some(at) = estimates.place(channel) else { continue };
        if visible.bands {
            let variances = estimates.variances(at);
            let band = Band::around_zero(variances.len(), |samples| variances[samples].iter().copied());
            layers.push(Layer::Band {
                band,
                color: palette.shade(estimates.color()),
                under: 0.0,
                filter: Some(estimates.id()),
            });
        }
    }
    layers.push(Layer::Level { value: 0.0, color: palette.truth, label: "" });
    for (place, estimates) in context.filters() {
        let Some(at) = estimates.place(channel) else { continue };
        let means = estimates.canonical_means(at);
        layers.push(
            Layer::line(
                Series::new(means.len(), move |samples| {
                    means[samples.clone()].iter().zip(&truth[samples]).map(|(mean, truth)| mean - truth)
                }),
                palette.shade(estimates.color()),
                line_width(place, 2.0),
            )
            .of(estimates.id()),
        );
    }
    for Bound { bound, filters } in session.bounds().iter().filter(|_| visible.bands) {
        let Some((_, estimates)) = context.filters().find(|(_, of)| filters.contains(&of.id())) else { continue };
        let Some(at) = bound.place(channel) else { continue };
        for sign in [-2.0, 2.0] {
            layers.push(Layer::dashed(
                Series::new(bound.len(), move |samples| samples.map(move |k| sign * bound.std(k, at))),
                palette.shade(estimates.color()),
                1.0,
            ));
        }
    }
    Chart {
        key: format!("error of {}", channel.key()),
        title: format!("error of the {}", channel.name()),
        symbol: format!("{} error", channel.symbol()),
        name: channel.name().to_owned(),
        unit: context.unit(channel.unit()),
        columns: columns(channel, context),
        layers,
        ..Chart::default()
    }
}
