//! The noise that filters have learnt, with ±2σ: of each sensor, and how large Q is.

use std::f64::consts::LN_10;

use kalmanscope_core::{Estimates, Quantity};

use crate::plot::chart::Chart;
use crate::plot::layers::Layer;
use crate::plot::series::{Band, Series};
use crate::sheet::Column;
use crate::text::significant;
use crate::view::ViewContext;

fn learning<'a>(context: &ViewContext<'a>) -> impl Iterator<Item = &'a Estimates> + use<'a> {
    context.filters().map(|(_, estimates)| estimates).filter(|estimates| estimates.learns_sensor_noise())
}

fn words(estimates: &Estimates, sensor: usize, k: usize) -> Option<String> {
    let [std, spread] = estimates.sensor_noise(k, sensor)?;
    Some(format!("{} ±{}", significant(std, 3), significant(2.0 * spread, 2)))
}

/// √R of each sensor, and the scale of √Q; no charts if no filter learns them.
pub(super) fn charts<'a>(context: &ViewContext<'a>) -> Vec<Chart<'a>> {
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
    let words = move |estimates: &Estimates, k: usize| words(estimates, sensor, k);
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

/// The factor s between √Q and the √Q of the settings, of the filters that have several scales of it.
fn of_process<'a>(context: &ViewContext<'a>) -> Option<Chart<'a>> {
    let scaling: Vec<&Estimates> =
        context.filters().map(|(_, estimates)| estimates).filter(|of| of.tells_process_scale()).collect();
    let scenario = context.session.run().scenario();
    let settings = scenario.filters.iter().find(|settings| scaling.first().is_some_and(|of| of.id() == settings.id))?;
    let truth = Some(settings).filter(|_| !context.session.is_measured());
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
    let ViewContext { palette, visible, .. } = *context;
    let (mut layers, mut columns): (Vec<Layer<'a>>, Vec<Column<'a>>) = (Vec::new(), Vec::new());
    let at = move |estimates: &Estimates, k: usize| band(estimates, k).unwrap_or([f64::NAN; 3]);
    for &estimates in filters {
        let color = palette.shade(estimates.color());
        if visible.bands {
            let edges = move |k: usize| {
                let [low, _, high] = at(estimates, k);
                (low, high)
            };
            let band = Band::made(estimates.len(), move |samples| samples.map(edges).collect());
            layers.push(Layer::Band { band, color, under: 0.0, filter: Some(estimates.id()) });
        }
        columns.push(Column::new(estimates.name(), color, move |k| words(estimates, k)));
    }
    if let Some(value) = truth.filter(|_| visible.truth) {
        layers.push(Layer::Level { value, color: palette.truth, label: "truth" });
    }
    for &estimates in filters {
        let series = Series::new(estimates.len(), move |samples| samples.map(move |k| at(estimates, k)[1]));
        layers.push(Layer::line(series, palette.shade(estimates.color()), 1.2).of(estimates.id()));
    }
    Chart { columns, layers, ..chart }
}
