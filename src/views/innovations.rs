//! Innovations within ±2√S: the new information of each measurement.

use egui::Ui;
use kalmanscope_core::{Estimates, Quantity};

use crate::plot::chart::Chart;
use crate::plot::charts::charts_ui;
use crate::plot::heading::Readout;
use crate::plot::layers::Layer;
use crate::plot::series::{Band, Series};
use crate::request::Request;
use crate::sheet::{Column, Sheet};
use crate::text::significant;
use crate::view::{View, ViewContext};
use crate::views::{handles, learnt_noise};

/// Limits the number of charts if each filter has its own.
const ROWS: usize = 8;

/// Measurement minus prediction.
pub(super) struct Innovations;

impl View for Innovations {
    fn name(&self) -> &'static str {
        "Innovations"
    }

    fn help(&self) -> [&'static str; 3] {
        [
            "Measurement minus prediction, in its ±2√S band.",
            "For a well tuned filter they are white noise, and 95 % are in the band.",
            "A rhythm in them, or a band that does not fit, shows that model, Q or R is wrong, without knowledge of the truth. Filters that learn R show it below.",
        ]
    }

    fn sheets<'a>(&self, context: &ViewContext<'a>) -> Vec<Sheet<'a>> {
        let sheet = |(sensor, quantity): (usize, Quantity)| Sheet {
            title: title(quantity),
            unit: context.unit(quantity.unit()),
            columns: columns(sensor, context),
        };
        let innovations = context.session.sensors().into_iter().enumerate().map(sheet);
        innovations.chain(learnt_noise::sheets(context)).collect()
    }

    fn ui(&self, ui: &mut Ui, context: &ViewContext<'_>, requests: &mut Vec<Request>) -> Option<f64> {
        let sensors: Vec<Quantity> = context.session.sensors();
        if sensors.is_empty() {
            ui.weak("Nothing is measured.");
        }
        // The innovations of several filters in one chart would be one block of colour.
        let filters: Vec<&Estimates> = context.filters().map(|(_, estimates)| estimates).collect();
        let rows = if sensors.len() * filters.len() <= ROWS { filters.len().max(1) } else { 1 };
        let own = sensors.len() * rows;
        let count = own + if learnt_noise::is_shown(context) { sensors.len() } else { 0 };
        charts_ui(ui, count, &context.plot_input(), requests, &|i, last_row| {
            if let Some(sensor) = i.checked_sub(own) {
                return learnt_noise::chart(sensor, sensors[sensor], context, last_row);
            }
            let (sensor, row) = (i / rows, i % rows);
            let filters = if rows > 1 { &filters[row..=row] } else { &filters[..] };
            chart(sensor, sensors[sensor], filters, context, last_row)
        })
    }
}

fn title(quantity: Quantity) -> String {
    format!("innovations of the {} sensor", quantity.key())
}

/// The variance that a filter expects of a sensor's innovation.
fn variance(estimates: &Estimates, sensor: usize, k: usize) -> f64 {
    estimates.innovation_cov(k)[sensor * (estimates.sensors().len() + 1)]
}

/// The innovations with their ±2√S.
fn columns<'a>(sensor: usize, context: &ViewContext<'a>) -> Vec<Column<'a>> {
    let column = |(_, estimates): (usize, &'a Estimates)| {
        let text = move |k: usize| {
            let innovation = (k < estimates.len()).then(|| estimates.innovation(k)[sensor])?;
            let numbers = [innovation, 2.0 * variance(estimates, sensor, k).sqrt()];
            let [innovation, band] = numbers.map(|x| significant(x, 3));
            numbers[0].is_finite().then(|| format!("{innovation} ±{band}"))
        };
        Column::new(estimates.name(), context.palette.shade(estimates.color()), text)
    };
    context.filters().map(column).collect()
}

fn chart<'a>(
    sensor: usize,
    quantity: Quantity,
    filters: &[&'a Estimates],
    context: &ViewContext<'a>,
    last_row: bool,
) -> Chart<'a> {
    let ViewContext { session, palette, visible, axis, .. } = *context;
    let k = axis.readout(session);
    let mut layers: Vec<Layer<'a>> = Vec::new();
    let mut readouts = Vec::new();
    for &estimates in filters {
        let variance = move |k: usize| variance(estimates, sensor, k);
        if visible.bands {
            let band = Band::around_zero(estimates.len(), move |samples| samples.map(variance));
            layers.push(Layer::Band { band, color: palette.shade(estimates.color()), under: 0.0 });
        }
        if k < estimates.len() {
            let [innovation, std] = [estimates.innovation(k)[sensor], variance(k).sqrt()].map(|x| significant(x, 2));
            let (text, color) = (format!("{innovation} (√S {std})"), palette.shade(estimates.color()));
            readouts.push(Readout::new(text, color, estimates.name().to_owned()));
        }
    }
    layers.push(Layer::Level { value: 0.0, color: palette.weak, label: "" });
    for &estimates in filters {
        layers.push(Layer::line(
            Series::new(estimates.len(), move |samples| samples.map(move |k| estimates.innovation(k)[sensor])),
            palette.shade(estimates.color()).gamma_multiply(0.8),
            0.8,
        ));
    }
    let of = match filters {
        [one] if context.filters().nth(1).is_some() => format!(", {}", one.name()),
        _ => String::new(),
    };
    Chart {
        key: format!("innovation of {}{of}", quantity.key()),
        title: format!("{}{of}", title(quantity)),
        symbol: format!("e({})", quantity.symbol()),
        name: format!("innovation of {}{of}", quantity.key()),
        unit: context.unit(quantity.unit()),
        readouts,
        layers,
        handles: handles::of_sensor(sensor, quantity, filters, context),
        last_row,
        ..Chart::default()
    }
}
