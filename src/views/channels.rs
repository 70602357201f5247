//! States and parameters over time: truth, measurement, each filter's estimate with its ±2σ band, and its error.

use kalmanscope_core::{Channel, Quantity, Signal};

use crate::plot::chart::{Chart, Curve};
use crate::plot::layers::{Layer, line_width};
use crate::plot::notes::Note;
use crate::plot::series::PlotSeries;
use crate::plot::sheet::{SheetColumn, plus_minus};
use crate::session::{Bound, Wanted};
use crate::text::{decimals, error_in_hertz, fixed, in_hertz, significant};
use crate::view::{View, ViewContext};
use crate::views::{handles, weights};

const ESTIMATE: f32 = 2.8;

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

fn of_channel<'a>(channel: Channel, [title, symbol]: [String; 2], context: &ViewContext<'a>) -> Chart<'a> {
    let name = channel.name().to_owned();
    let (unit, settles) = (context.unit(channel.unit()), channel.is_parameter());
    Chart { key: title.clone(), title, symbol, name, unit, settles, ..Chart::default() }
}

fn notes(channel: Channel, context: &ViewContext<'_>) -> Vec<Note> {
    let ViewContext { session, palette, .. } = *context;
    let (run, record) = (session.run(), session.run().record());
    let truth = record.truth(channel).filter(|_| context.visible.truth && !session.is_measured());
    let (Some(truth), Some(Signal::Step(step))) = (truth, run.scenario().plant.parameter(channel)) else {
        return Vec::new();
    };
    let at = record.time_of(0) + step.at;
    // Words must not tell of a change before it comes.
    if session.time() < at || step.from == step.to {
        return Vec::new();
    }
    let size = match step.to / step.from - 1.0 {
        share if share.is_finite() => format!("{}{} %", if share > 0.0 { "+" } else { "" }, fixed(100.0 * share, 0)),
        _ => "changes".to_owned(),
    };
    let words = format!("{size} at {} s", significant(step.at, 3));
    let change = Note { time: at, value: 0.5 * (step.from + step.to), words, color: palette.truth, leftwards: true };
    let settled = context.diagnostics().filter_map(|(_, of, diagnostics)| {
        let (sample, place, last) = (diagnostics.settled(channel)?, of.place(channel)?, of.len().checked_sub(1)?);
        let means = of.canonical_means(place);
        let time = record.time_of(sample);
        // A filter may settle at a wrong value.
        let is_right = (means[last] - truth.get(last)?).abs() <= 2.0 * of.std(last, place);
        let words = format!("settles after {} s", fixed(time - at, 1));
        (is_right && time > at).then(|| Note {
            time,
            value: means[sample],
            words,
            color: context.color(of),
            leftwards: false,
        })
    });
    std::iter::once(change).chain(settled).collect()
}

fn chart<'a>(channel: Channel, context: &ViewContext<'a>) -> Chart<'a> {
    let ViewContext { session, palette, visible, .. } = *context;
    let run = session.run();
    let record = run.record();
    let decimals = decimals(channel);
    let mut chart = of_channel(channel, [channel.name().to_owned(), channel.symbol().to_owned()], context);
    chart.notes = notes(channel, context);
    chart.handles = handles::of_channel(channel, context);
    let quantity = Quantity::all().iter().find(|q| q.channel() == Some(channel));
    if let Some(z) = quantity.and_then(|q| record.measured_quantity(*q)).filter(|_| visible.measured) {
        chart.layers.push(Layer::Dots { series: PlotSeries::of(&z[..run.len()]), color: palette.measured });
        chart.layers.extend(quantity.into_iter().flat_map(|q| weights::layers(*q, &z[..run.len()], context)));
    }
    if let Some(truth) = record.truth(channel) {
        let series = PlotSeries::of(&truth[..run.len()]);
        chart.layers.extend(visible.truth.then(|| Layer::truth(series, palette.truth)));
        let column = SheetColumn::new("truth", palette.truth, move |k| Some(fixed(*truth.get(k)?, decimals)));
        chart.columns.push(column.with_aside(move |k| in_hertz(*truth.get(k)?, channel.unit())));
    }
    let truth_before = session.before().and_then(|before| before.truth(channel)).filter(|_| visible.truth);
    chart.layers.extend(truth_before.map(|truth| Layer::dashed(PlotSeries::of(truth), palette.weak, 1.2)));
    let before = context.before().filter_map(|before| Some(before.canonical_means(before.place(channel)?)));
    chart.layers.extend(before.map(|means| Layer::line(PlotSeries::of(means), palette.weak, 1.2)));
    for (place, of, at) in context.estimating(channel) {
        let (means, variances) = (of.canonical_means(at), of.variances(at));
        let band = Some(PlotSeries::around(means, variances));
        let curve = Curve { line: PlotSeries::of(means), band, width: line_width(place, ESTIMATE) };
        context.add(&mut chart, of, curve, move |k| Some(plus_minus(means[k], of.std(k, at), decimals)));
        chart.aside(move |k| in_hertz(means[k], channel.unit()));
    }
    for of in session.smoothed().iter().filter(|of| visible.hindsight && visible.filter(of.id())) {
        let Some(at) = of.place(channel) else { continue };
        chart.layers.push(Layer::dashed(PlotSeries::of(of.canonical_means(at)), context.color(of), 1.4));
    }
    chart
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
    let names = [format!("error of the {}", channel.name()), format!("{} error", channel.symbol())];
    let mut chart = of_channel(channel, names, context);
    chart.layers.push(Layer::zero(palette.truth));
    for (place, of, at) in context.estimating(channel) {
        let (means, variances) = (of.canonical_means(at), of.variances(at));
        let error = move |k: usize| means[k] - truth[k];
        let line = PlotSeries::each(means.len(), error);
        let curve = Curve { line, band: Some(PlotSeries::of(variances).around_zero()), width: line_width(place, 2.0) };
        context.add(&mut chart, of, curve, move |k| Some(plus_minus(error(k), of.std(k, at), decimals)));
        chart.aside(move |k| error_in_hertz(error(k), channel.unit(), decimals));
    }
    for Bound { bound, filters } in session.bounds().iter().filter(|_| visible.bands) {
        let Some((_, of)) = context.filters().find(|(_, of)| filters.contains(&of.id())) else { continue };
        let Some(at) = bound.place(channel) else { continue };
        for sign in [-2.0, 2.0] {
            let series = PlotSeries::each(bound.len(), move |k| sign * bound.std(k, at));
            chart.layers.push(Layer::dashed(series, context.color(of), 1.0));
        }
    }
    chart
}
