//! The noise of a sensor that filters have learnt, with ±2σ.

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

/// √R of each sensor; there is none where no filter learns R.
pub(super) fn charts<'a>(context: &ViewContext<'a>) -> Vec<Chart<'a>> {
    let sensors = if learning(context).next().is_some() { context.session.sensors() } else { Vec::new() };
    sensors.into_iter().enumerate().map(|(sensor, quantity)| chart(sensor, quantity, context)).collect()
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
