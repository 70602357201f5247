//! Innovations within ±2√S: the new information of each measurement.

use kalmanscope_core::{Estimates, Quantity};

use crate::plot::chart::Chart;
use crate::plot::heading::Readout;
use crate::plot::layers::Layer;
use crate::plot::series::{Band, Series};
use crate::sheet::{Column, Sheet};
use crate::text::significant;
use crate::view::{View, ViewContext};
use crate::views::{handles, learnt_noise};

/// Limits the number of charts if each filter has its own.
const ROWS: usize = 8;

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
        charts(usize::MAX, context).into_iter().map(Chart::into_sheet).collect()
    }

    fn charts<'a>(&self, context: &ViewContext<'a>) -> Vec<Chart<'a>> {
        // The innovations of several filters in one chart would be one block of colour.
        let (sensors, filters) = (context.session.sensors().len(), context.filters().count());
        charts(if sensors * filters <= ROWS { 1 } else { usize::MAX }, context)
    }

    fn without_charts(&self) -> &'static str {
        "Nothing is measured."
    }
}

/// The charts of each sensor, then those of its learnt noise. One chart shows at most `together` filters.
fn charts<'a>(together: usize, context: &ViewContext<'a>) -> Vec<Chart<'a>> {
    let filters: Vec<&Estimates> = context.filters().map(|(_, estimates)| estimates).collect();
    let groups: Vec<&[&Estimates]> = if filters.is_empty() { vec![&[]] } else { filters.chunks(together).collect() };
    let of = |(sensor, quantity): (usize, Quantity)| {
        groups.iter().map(move |filters| chart(sensor, quantity, filters, context))
    };
    let own = context.session.sensors().into_iter().enumerate().flat_map(of);
    own.chain(learnt_noise::charts(context)).collect()
}

fn variance(estimates: &Estimates, sensor: usize, k: usize) -> f64 {
    estimates.innovation_cov(k)[sensor * (estimates.sensors().len() + 1)]
}

fn columns<'a>(sensor: usize, filters: &[&'a Estimates], context: &ViewContext<'a>) -> Vec<Column<'a>> {
    let column = |&estimates: &&'a Estimates| {
        let text = move |k: usize| {
            let innovation = (k < estimates.len()).then(|| estimates.innovation(k)[sensor])?;
            let numbers = [innovation, 2.0 * variance(estimates, sensor, k).sqrt()];
            let [innovation, band] = numbers.map(|x| significant(x, 3));
            numbers[0].is_finite().then(|| format!("{innovation} ±{band}"))
        };
        Column::new(estimates.name(), context.palette.shade(estimates.color()), text)
    };
    filters.iter().map(column).collect()
}

fn chart<'a>(sensor: usize, quantity: Quantity, filters: &[&'a Estimates], context: &ViewContext<'a>) -> Chart<'a> {
    let ViewContext { session, palette, visible, axis, .. } = *context;
    let k = axis.readout(session);
    let mut layers: Vec<Layer<'a>> = Vec::new();
    let mut readouts = Vec::new();
    for &estimates in filters {
        let variance = move |k: usize| variance(estimates, sensor, k);
        if visible.bands {
            let band = Band::around_zero(estimates.len(), move |samples| samples.map(variance));
            layers.push(Layer::Band {
                band,
                color: palette.shade(estimates.color()),
                under: 0.0,
                filter: Some(estimates.id()),
            });
        }
        if k < estimates.len() {
            let [innovation, std] = [estimates.innovation(k)[sensor], variance(k).sqrt()].map(|x| significant(x, 2));
            let (text, color) = (format!("{innovation} (√S {std})"), palette.shade(estimates.color()));
            readouts.push(Readout::new(text, color, estimates.name().to_owned()));
        }
    }
    layers.push(Layer::Level { value: 0.0, color: palette.weak, label: "" });
    for &estimates in filters {
        layers.push(
            Layer::line(
                Series::new(estimates.len(), move |samples| samples.map(move |k| estimates.innovation(k)[sensor])),
                palette.shade(estimates.color()).gamma_multiply(0.8),
                0.8,
            )
            .of(estimates.id()),
        );
    }
    let of = match filters {
        [one] if context.filters().nth(1).is_some() => format!(", {}", one.name()),
        _ => String::new(),
    };
    Chart {
        key: format!("innovation of {}{of}", quantity.key()),
        title: format!("innovations of the {} sensor{of}", quantity.key()),
        symbol: format!("e({})", quantity.symbol()),
        name: format!("innovation of {}{of}", quantity.key()),
        unit: context.unit(quantity.unit()),
        columns: columns(sensor, filters, context),
        readouts: Some(readouts),
        layers,
        handles: handles::of_sensor(sensor, quantity, filters, context),
        ..Chart::default()
    }
}
