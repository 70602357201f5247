//! States and parameters over time: truth, measurement, each filter's estimate with its ±2σ band, and its error.

use kalmanscope_core::{Channel, Quantity};

use crate::plot::chart::Chart;
use crate::plot::layers::{Layer, line_width};
use crate::plot::series::{Band, Series};
use crate::session::{Bound, Wanted};
use crate::sheet::{Column, plus_minus};
use crate::text::{decimals, error_in_hertz, fixed, in_hertz};
use crate::view::{View, ViewContext};
use crate::views::{handles, weights};

/// The width of the first filter's line \[points\].
const ESTIMATE: f32 = 2.4;

pub(super) static STATES: View = View {
    name: "States",
    help: [
        "The motion over time: truth thick, measurements as dots, each filter's estimate with its ±2σ band.",
        "The band of a consistent filter contains the truth 95 % of the time.",
        "The estimate should be closer to the truth than the dots. A robust filter leaves out those in its colour.",
    ],
    charts: |context| channel_charts(false, context),
    plots: |context| channels(false, context).len(),
    ..View::NONE
};

pub(super) static PARAMETERS: View = View {
    name: "Parameters",
    help: [
        "The plant's parameters over time: truth thick, each filter's estimate with its ±2σ band.",
        "They are not measured: a filter infers them from the response of the motion to the force.",
        "The band narrows with every measurement. Only a filter with fading memory or process noise follows a change of the truth.",
    ],
    charts: |context| channel_charts(true, context),
    plots: |context| channels(true, context).len(),
    ..View::NONE
};

fn channels(are_parameters: bool, context: &ViewContext<'_>) -> Vec<Channel> {
    let is_wanted = |channel: &Channel| channel.is_parameter() == are_parameters;
    context.visible.channels(context.session.run().channels().into_iter().filter(is_wanted).collect())
}

fn channel_charts<'a>(are_parameters: bool, context: &ViewContext<'a>) -> Vec<Chart<'a>> {
    channels(are_parameters, context).into_iter().map(|channel| chart(channel, context)).collect()
}

fn chart<'a>(channel: Channel, context: &ViewContext<'a>) -> Chart<'a> {
    let ViewContext { session, palette, visible, .. } = *context;
    let run = session.run();
    let record = run.record();
    let decimals = decimals(channel);
    let bands = context.estimating(channel).filter(|_| visible.bands).map(|(place, of, at)| {
        let band = Band::around(of.canonical_means(at), of.variances(at));
        context.band(of, band, line_width(place, ESTIMATE))
    });
    let mut layers: Vec<Layer<'a>> = bands.collect();
    let quantity = Quantity::all().iter().find(|q| q.channel() == Some(channel));
    if let Some(z) = quantity.and_then(|q| record.measured_quantity(*q)).filter(|_| visible.measured) {
        layers.push(Layer::Dots { series: Series::of(&z[..run.len()]), color: palette.measured });
        layers.extend(quantity.into_iter().flat_map(|q| weights::layers(*q, &z[..run.len()], context)));
    }
    let truth = record.truth(channel);
    if let Some(truth) = truth.filter(|_| visible.truth) {
        layers.push(Layer::Line {
            series: Series::of(&truth[..run.len()]),
            color: palette.truth,
            width: 4.0,
            dashed: false,
            bounds: true,
            filter: None,
        });
    }
    let truth_before = session.before().and_then(|before| before.truth(channel));
    if let Some(truth) = truth_before.filter(|_| visible.truth) {
        layers.push(Layer::dashed(Series::of(truth), palette.weak, 1.2));
    }
    for before in context.before() {
        let now = context.estimating(channel).position(|(_, of, _)| of.id() == before.id());
        if let (Some(at), Some(now)) = (before.place(channel), now) {
            layers.push(Layer::Before { series: Series::of(before.canonical_means(at)), color: palette.weak, now });
        }
    }
    let words = truth.map(|truth| {
        let column = Column::new("truth", palette.truth, move |k| Some(fixed(*truth.get(k)?, decimals)));
        column.with_aside(move |k| in_hertz(*truth.get(k)?, channel.unit()))
    });
    let mut columns: Vec<Column<'a>> = words.into_iter().collect();
    for (place, of, at) in context.estimating(channel) {
        layers.push(context.line(of, Series::of(of.canonical_means(at)), line_width(place, ESTIMATE)));
        let text = move |k| Some(plus_minus(of.canonical_mean(k, at), of.std(k, at), decimals));
        let aside = move |k| in_hertz(of.canonical_mean(k, at), channel.unit());
        columns.push(context.column(of, text).with_aside(aside));
    }
    for of in session.smoothed().iter().filter(|of| visible.hindsight && visible.filter(of.id())) {
        let Some(at) = of.place(channel) else { continue };
        layers.push(Layer::dashed(Series::of(of.canonical_means(at)), context.color(of), 1.4));
    }
    Chart {
        key: channel.key().to_owned(),
        title: channel.name().to_owned(),
        symbol: channel.symbol().to_owned(),
        name: channel.name().to_owned(),
        unit: context.unit(channel.unit()),
        columns,
        layers,
        handles: handles::of_channel(channel, context).into_iter().chain(handles::of_noise(channel, context)).collect(),
        ..Chart::default()
    }
}

pub(super) static ERRORS: View = View {
    name: "Errors",
    help: [
        "Estimate minus truth over time, in the filter's ±2σ band; dashed is ±2 times the Cramér-Rao bound.",
        "An error outside its band more than 5 % of the time: the filter is overconfident. Far inside all the time: it is underconfident.",
        "No unbiased filter with the same initial belief and noise has a band inside the dashed lines.",
    ],
    wanted: Wanted::BOUNDS,
    charts: error_charts,
    plots: |context| known_channels(context).len(),
    without_charts: "The truth of this record is not known.",
    ..View::NONE
};

fn error_charts<'a>(context: &ViewContext<'a>) -> Vec<Chart<'a>> {
    known_channels(context).into_iter().map(|channel| error_chart(channel, context)).collect()
}

fn known_channels(context: &ViewContext<'_>) -> Vec<Channel> {
    let record = context.session.run().record();
    let channels = context.session.run().channels();
    let (parameters, states): (Vec<Channel>, Vec<Channel>) = channels
        .into_iter()
        .filter(|c| record.truth(*c).is_some() && context.in_doubt(*c))
        .partition(|c| c.is_parameter());
    context.visible.channels([parameters, states].concat())
}

fn error_chart<'a>(channel: Channel, context: &ViewContext<'a>) -> Chart<'a> {
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
