//! Innovations within ±2√S: the new information of each measurement.

use std::f64::consts::LN_10;

use kalmanscope_core::{Estimates, FilterSettings, Quantity};

use crate::plot::chart::{Chart, Curve};
use crate::plot::heading::Readout;
use crate::plot::layers::Layer;
use crate::plot::series::PlotSeries;
use crate::plot::sheet::Sheet;
use crate::text::significant;
use crate::view::{View, ViewContext};

/// Limits the number of charts if each filter has its own.
const ROWS: usize = 8;

pub(super) static VIEW: View = View {
    name: "Innovations",
    help: [
        "Measurement minus prediction, in its ±2√S band.",
        "For a well tuned filter they are white noise, and 95 % are in the band.",
        "A rhythm in them, or a band that does not fit, shows that model, Q or R is wrong, without knowledge of the truth. Filters that learn R show it below.",
    ],
    sheets: Some(sheets),
    charts: all_charts,
    plots,
    without_charts: "Nothing is measured.",
    ..View::NONE
};

fn sheets<'a>(context: &ViewContext<'a>) -> Vec<Sheet<'a>> {
    charts(usize::MAX, context).into_iter().map(Chart::into_sheet).collect()
}

fn all_charts<'a>(context: &ViewContext<'a>) -> Vec<Chart<'a>> {
    charts(if is_apart(context) { 1 } else { usize::MAX }, context)
}

fn plots(context: &ViewContext<'_>) -> usize {
    let groups = if is_apart(context) { context.filters().count().max(1) } else { 1 };
    let learnt = usize::from(learning(context).next().is_some());
    context.session.sensors().len() * (groups + learnt) + usize::from(scaling(context).is_some())
}

fn is_apart(context: &ViewContext<'_>) -> bool {
    context.session.sensors().len() * context.filters().count() <= ROWS
}

fn charts<'a>(together: usize, context: &ViewContext<'a>) -> Vec<Chart<'a>> {
    let filters: Vec<&Estimates> = context.filters().map(|(_, estimates)| estimates).collect();
    let groups: Vec<&[&Estimates]> = if filters.is_empty() { vec![&[]] } else { filters.chunks(together).collect() };
    let of = |(sensor, quantity): (usize, Quantity)| {
        groups.iter().map(move |filters| chart(sensor, quantity, filters, context))
    };
    let own = context.session.sensors().into_iter().enumerate().flat_map(of);
    own.chain(learnt_noise(context)).collect()
}

fn variance(estimates: &Estimates, sensor: usize, k: usize) -> f64 {
    estimates.innovation_cov(k)[sensor * (estimates.sensors().len() + 1)]
}

fn chart<'a>(sensor: usize, quantity: Quantity, filters: &[&'a Estimates], context: &ViewContext<'a>) -> Chart<'a> {
    let ViewContext { session, palette, axis, .. } = *context;
    let now = axis.readout(session);
    let of = match filters {
        [one] if context.filters().nth(1).is_some() => format!(", {}", one.name()),
        _ => String::new(),
    };
    let mut chart = Chart {
        key: format!("innovation of {}{of}", quantity.key()),
        title: format!("innovations of the {} sensor{of}", quantity.key()),
        symbol: format!("e({})", quantity.symbol()),
        name: format!("innovation of {}{of}", quantity.key()),
        unit: context.unit(quantity.unit()),
        layers: vec![Layer::zero(palette.weak)],
        ..Chart::default()
    };
    let mut readouts = Vec::new();
    for &of in filters {
        let innovation = move |k: usize| of.innovation(k)[sensor];
        let std = move |k: usize| variance(of, sensor, k).sqrt();
        let band = PlotSeries::each(of.len(), move |k| variance(of, sensor, k)).around_zero();
        let curve = Curve { line: PlotSeries::each(of.len(), innovation), band: Some(band), width: 0.8 };
        context.add(&mut chart, of, curve, move |k| {
            let [text, band] = [innovation(k), 2.0 * std(k)].map(|x| significant(x, 3));
            innovation(k).is_finite().then(|| format!("{text} ±{band}"))
        });
        if now < of.len() {
            let [innovation, std] = [innovation(now), std(now)].map(|x| significant(x, 2));
            let text = format!("{innovation} (√S {std})");
            readouts.push(Readout::new(text, context.color(of), of.name().to_owned()));
        }
    }
    Chart { readouts: Some(readouts), ..chart }
}

fn learning<'a>(context: &ViewContext<'a>) -> impl Iterator<Item = &'a Estimates> + use<'a> {
    context.filters().map(|(_, estimates)| estimates).filter(|estimates| estimates.learns_sensor_noise)
}

pub(super) fn learnt_noise<'a>(context: &ViewContext<'a>) -> Vec<Chart<'a>> {
    let sensors = if learning(context).next().is_some() { context.session.sensors() } else { Vec::new() };
    let of_sensors = sensors.into_iter().enumerate().map(|(sensor, quantity)| of_sensor(sensor, quantity, context));
    of_sensors.chain(of_process(context)).collect()
}

/// The true standard deviation of a sensor's noise for the first filter that learns it; known of simulated sensors without faults only.
fn truth(sensor: usize, context: &ViewContext<'_>) -> Option<f64> {
    let scenario = context.session.run().scenario();
    let filter = learning(context).next()?.id();
    let filter = scenario.filters.iter().find(|settings| settings.id == filter)?;
    let is_plain = scenario.sensors.get(sensor)?.faults.is_empty() && !context.session.is_measured();
    scenario.true_noise_for(filter).0.get(sensor).copied().filter(|_| is_plain)
}

fn of_sensor<'a>(sensor: usize, quantity: Quantity, context: &ViewContext<'a>) -> Chart<'a> {
    let band = move |estimates: &Estimates, k: usize| {
        let [std, spread] = estimates.sensor_noise(k, sensor)?;
        Some([-2.0, 0.0, 2.0].map(|sigmas| std + sigmas * spread))
    };
    let words = move |estimates: &Estimates, k: usize| {
        let [std, spread] = estimates.sensor_noise(k, sensor)?;
        Some(format!("{} ±{}", significant(std, 3), significant(2.0 * spread, 2)))
    };
    let chart = Chart {
        key: format!("learnt noise of {}", quantity.key()),
        title: format!("learnt noise of the {} sensor", quantity.key()),
        symbol: format!("√R({})", quantity.symbol()),
        name: "learnt noise".to_owned(),
        unit: context.unit(quantity.unit()),
        ..Chart::default()
    };
    drawn(chart, context, &learning(context).collect::<Vec<_>>(), (band, words), truth(sensor, context))
}

fn scaling<'a>(context: &ViewContext<'a>) -> Option<(&'a FilterSettings, Vec<&'a Estimates>)> {
    let filters = context.filters().map(|(_, estimates)| estimates);
    let scaling: Vec<&Estimates> = filters.filter(|of| of.has_process_scale).collect();
    let first = scaling.first()?.id();
    let settings = context.session.run().scenario().filters.iter().find(|settings| settings.id == first)?;
    Some((settings, scaling))
}

/// The factor s between √Q and the √Q of the settings, of the filters that have several scales of it.
fn of_process<'a>(context: &ViewContext<'a>) -> Option<Chart<'a>> {
    let (settings, scaling) = scaling(context)?;
    let truth = Some(settings).filter(|_| !context.session.is_measured());
    let scenario = context.session.run().scenario();
    let truth = truth.and_then(|settings| scenario.true_process_scale(settings)).map(f64::log10);
    let band = |estimates: &Estimates, k: usize| {
        let [mean, std] = estimates.process_scale(k)?;
        Some([-2.0, 0.0, 2.0].map(|sigmas| (mean + sigmas * std) / LN_10))
    };
    let words = move |estimates: &Estimates, k: usize| {
        let [low, middle, high] = band(estimates, k)?.map(|logarithm| significant(10_f64.powf(logarithm), 3));
        Some(format!("{middle} ({low} to {high})"))
    };
    let chart = Chart {
        key: "learnt scale of Q".to_owned(),
        title: "learnt √Q over the one that is set".to_owned(),
        symbol: "s(√Q)".to_owned(),
        name: "scale of √Q".to_owned(),
        logarithmic: true,
        ..Chart::default()
    };
    Some(drawn(chart, context, &scaling, (band, words), truth))
}

fn drawn<'a>(
    chart: Chart<'a>,
    context: &ViewContext<'a>,
    filters: &[&'a Estimates],
    (band, words): (
        impl Fn(&Estimates, usize) -> Option<[f64; 3]> + Copy + 'a,
        impl Fn(&Estimates, usize) -> Option<String> + Copy + 'a,
    ),
    truth: Option<f64>,
) -> Chart<'a> {
    let at = move |estimates: &Estimates, k: usize| band(estimates, k).unwrap_or([f64::NAN; 3]);
    let truth = truth.filter(|_| context.visible.truth);
    let truth = truth.map(|value| Layer::Level { value, color: context.palette.truth, label: "truth" });
    let mut chart = Chart { layers: truth.into_iter().collect(), ..chart };
    for &of in filters {
        let band = PlotSeries::each(of.len(), move |k| (at(of, k)[0], at(of, k)[2]));
        let curve = Curve { line: PlotSeries::each(of.len(), move |k| at(of, k)[1]), band: Some(band), width: 1.2 };
        context.add(&mut chart, of, curve, move |k| words(of, k));
    }
    chart
}
