//! The noise that filters have learnt, with ±2σ: of each sensor, and how large Q is.

use std::f64::consts::LN_10;

use kalmanscope_core::{Estimates, Quantity};

use crate::plot::chart::Chart;
use crate::plot::layers::Layer;
use crate::plot::series::{Band, Series};
use crate::sheet::Column;
use crate::text::significant;
use crate::view::ViewContext;

/// The filters on screen that learn R.
fn learning<'a>(context: &ViewContext<'a>) -> impl Iterator<Item = &'a Estimates> + use<'a> {
    context.filters().map(|(_, estimates)| estimates).filter(|estimates| estimates.learns_sensor_noise())
}

/// √R and twice its standard deviation, in words.
fn words(estimates: &Estimates, sensor: usize, k: usize) -> Option<String> {
    let [std, spread] = estimates.sensor_noise(k, sensor)?;
    Some(format!("{} ±{}", significant(std, 3), significant(2.0 * spread, 2)))
}

/// √R of each sensor, and the scale of √Q; there is none where no filter learns it.
pub(super) fn charts<'a>(context: &ViewContext<'a>) -> Vec<Chart<'a>> {
    let sensors = if learning(context).next().is_some() { context.session.sensors() } else { Vec::new() };
    let of_sensors = sensors.into_iter().enumerate().map(|(sensor, quantity)| chart(sensor, quantity, context));
    of_sensors.chain(of_process(context)).collect()
}

/// s, where √Q is s times that of the settings, for the filters that have several scales of it.
fn of_process<'a>(context: &ViewContext<'a>) -> Option<Chart<'a>> {
    let ViewContext { palette, visible, .. } = *context;
    let scaling = || context.filters().map(|(_, estimates)| estimates).filter(|of| of.tells_process_scale());
    let (mut layers, mut columns): (Vec<Layer<'a>>, Vec<Column<'a>>) = (Vec::new(), Vec::new());
    for estimates in scaling() {
        let color = palette.shade(estimates.color());
        let of = move |k: usize| estimates.process_scale(k).unwrap_or([f64::NAN; 2]);
        if visible.bands {
            let edges = move |[mean, std]: [f64; 2]| ((mean - 2.0 * std) / LN_10, (mean + 2.0 * std) / LN_10);
            let band = Band::made(estimates.len(), move |samples| samples.map(|k| edges(of(k))).collect());
            layers.push(Layer::Band { band, color, under: 0.0 });
        }
        columns.push(Column::new(estimates.name(), color, move |k| {
            let [mean, std] = estimates.process_scale(k)?;
            let [low, middle, high] = [-2.0, 0.0, 2.0].map(|sigmas| significant((mean + sigmas * std).exp(), 3));
            Some(format!("{middle} ({low} to {high})"))
        }));
    }
    let scenario = context.session.run().scenario();
    let first = scaling().next()?.id();
    let settings = scenario.filters.iter().find(|settings| settings.id == first);
    let truth = settings.filter(|_| !context.session.is_measured()).and_then(|of| scenario.true_process_scale(of));
    if let Some(value) = truth.filter(|_| visible.truth) {
        layers.push(Layer::Level { value: value.log10(), color: palette.truth, label: "truth" });
    }
    for estimates in scaling() {
        let value = move |k: usize| estimates.process_scale(k).map_or(f64::NAN, |[mean, _]| mean / LN_10);
        let series = Series::new(estimates.len(), move |samples| samples.map(value));
        layers.push(Layer::line(series, palette.shade(estimates.color()), 1.2));
    }
    Some(Chart {
        key: "learnt scale of Q".to_owned(),
        title: "learnt √Q over the one that is set".to_owned(),
        symbol: "s(√Q)".to_owned(),
        name: "scale of √Q".to_owned(),
        columns,
        layers,
        logarithmic: true,
        ..Chart::default()
    })
}

/// The true standard deviation of a sensor's noise for the first filter that learns it; known of simulated sensors without faults only.
fn truth(sensor: usize, context: &ViewContext<'_>) -> Option<f64> {
    let scenario = context.session.run().scenario();
    let filter = learning(context).next()?.id();
    let filter = scenario.filters.iter().find(|settings| settings.id == filter)?;
    let is_plain = scenario.sensors.get(sensor)?.faults.is_empty() && !context.session.is_measured();
    scenario.true_noise_for(filter).0.get(sensor).copied().filter(|_| is_plain)
}

/// The chart of a sensor.
fn chart<'a>(sensor: usize, quantity: Quantity, context: &ViewContext<'a>) -> Chart<'a> {
    let ViewContext { palette, visible, .. } = *context;
    let (mut layers, mut columns): (Vec<Layer<'a>>, Vec<Column<'a>>) = (Vec::new(), Vec::new());
    for estimates in learning(context) {
        let color = palette.shade(estimates.color());
        let of = move |k: usize| estimates.sensor_noise(k, sensor).unwrap_or([f64::NAN; 2]);
        if visible.bands {
            let edges = move |[std, spread]: [f64; 2]| (std - 2.0 * spread, std + 2.0 * spread);
            let band = Band::made(estimates.len(), move |samples| samples.map(|k| edges(of(k))).collect());
            layers.push(Layer::Band { band, color, under: 0.0 });
        }
        columns.push(Column::new(estimates.name(), color, move |k| words(estimates, sensor, k)));
    }
    if let Some(value) = truth(sensor, context).filter(|_| visible.truth) {
        layers.push(Layer::Level { value, color: palette.truth, label: "truth" });
    }
    for estimates in learning(context) {
        let value = move |k: usize| estimates.sensor_noise(k, sensor).map_or(f64::NAN, |[std, _]| std);
        let series = Series::new(estimates.len(), move |samples| samples.map(value));
        layers.push(Layer::line(series, palette.shade(estimates.color()), 1.2));
    }
    Chart {
        key: format!("learnt noise of {}", quantity.key()),
        title: format!("learnt noise of the {} sensor", quantity.key()),
        symbol: format!("√R({})", quantity.symbol()),
        name: "learnt noise".to_owned(),
        unit: context.unit(quantity.unit()),
        columns,
        layers,
        ..Chart::default()
    }
}
