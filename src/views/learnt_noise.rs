//! The noise of a sensor that filters have learnt, with ±2σ.

use kalmanscope_core::{Estimates, Quantity};

use crate::plot::chart::Chart;
use crate::plot::heading::Readout;
use crate::plot::layers::Layer;
use crate::plot::series::{Band, Series};
use crate::sheet::{Column, Sheet};
use crate::text::significant;
use crate::view::ViewContext;

/// The filters on screen that learn R.
fn learning<'a>(context: &ViewContext<'a>) -> impl Iterator<Item = &'a Estimates> + use<'a> {
    context.filters().map(|(_, estimates)| estimates).filter(|estimates| estimates.learns_sensor_noise())
}

/// Whether there is anything to show.
pub(super) fn is_shown(context: &ViewContext<'_>) -> bool {
    learning(context).next().is_some()
}

fn title(quantity: Quantity) -> String {
    format!("learnt noise of the {} sensor", quantity.key())
}

/// √R and twice its standard deviation, in words.
fn words(estimates: &Estimates, sensor: usize, k: usize) -> Option<String> {
    let [std, spread] = estimates.sensor_noise(k, sensor)?;
    Some(format!("{} ±{}", significant(std, 3), significant(2.0 * spread, 2)))
}

/// A table of √R for each sensor; there is none where no filter learns R.
pub(super) fn sheets<'a>(context: &ViewContext<'a>) -> Vec<Sheet<'a>> {
    let sheet = |(sensor, quantity): (usize, Quantity)| {
        let column = |estimates: &'a Estimates| {
            let text = move |k: usize| words(estimates, sensor, k);
            Column::new(estimates.name(), context.palette.shade(estimates.color()), text)
        };
        let columns = learning(context).map(column).collect();
        Sheet { title: title(quantity), unit: context.unit(quantity.unit()), columns }
    };
    let sensors = if is_shown(context) { context.session.sensors() } else { Vec::new() };
    sensors.into_iter().enumerate().map(sheet).collect()
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
pub(super) fn chart<'a>(sensor: usize, quantity: Quantity, context: &ViewContext<'a>, last_row: bool) -> Chart<'a> {
    let ViewContext { session, palette, visible, axis, .. } = *context;
    let (k, mut layers, mut readouts): (usize, Vec<Layer<'a>>, Vec<Readout>) =
        (axis.readout(session), Vec::new(), Vec::new());
    for estimates in learning(context) {
        let color = palette.shade(estimates.color());
        let of = move |k: usize| estimates.sensor_noise(k, sensor).unwrap_or([f64::NAN; 2]);
        if visible.bands {
            let edges = move |[std, spread]: [f64; 2]| (std - 2.0 * spread, std + 2.0 * spread);
            let band = Band::made(estimates.len(), move |samples| samples.map(|k| edges(of(k))).collect());
            layers.push(Layer::Band { band, color, under: 0.0 });
        }
        readouts.extend(words(estimates, sensor, k).map(|text| Readout::new(text, color, estimates.name().to_owned())));
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
        title: title(quantity),
        symbol: format!("√R({})", quantity.symbol()),
        name: "learnt noise".to_owned(),
        unit: context.unit(quantity.unit()),
        readouts,
        layers,
        last_row,
        ..Chart::default()
    }
}
