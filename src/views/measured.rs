//! Measurements against predictions: one step ahead, and by the identified model alone.

use kalmanscope_core::{Estimates, Quantity, Record};

use crate::plot::chart::Chart;
use crate::plot::heading::Readout;
use crate::plot::layers::{Layer, line_width};
use crate::plot::series::Series;
use crate::sheet::{Column, Sheet};
use crate::text::significant;
use crate::view::{View, ViewContext};
use crate::views::weights;

/// Width of a line of predictions \[points\].
const PREDICTED: f32 = 2.2;

pub(super) struct Measured;

impl View for Measured {
    fn name(&self) -> &'static str {
        "Measured and predicted"
    }

    fn help(&self) -> [&'static str; 3] {
        [
            "Dots are measured; those in a filter's colour count less for it, full ones nothing; lines are predicted one step ahead; dashed lines are the free run: the identified model alone, driven by the input.",
            "The fit is 100 % where the free run has no error and 0 % where it is no better than the mean. It is the number by which a model is judged.",
            "The model is the last estimate, or that at the mark A, or the mean from A to B (keys A and B).",
        ]
    }

    fn wants_free_runs(&self) -> bool {
        true
    }

    fn sheets<'a>(&self, context: &ViewContext<'a>) -> Vec<Sheet<'a>> {
        sensors(context).map(|(sensor, quantity)| signals(sensor, quantity, context).into_sheet()).collect()
    }

    fn charts<'a>(&self, context: &ViewContext<'a>) -> Vec<Chart<'a>> {
        let of = |(sensor, quantity): (usize, Quantity)| {
            // A record that is being measured has no free run.
            let errors = (!context.session.is_live()).then(|| errors(sensor, quantity, context));
            std::iter::once(signals(sensor, quantity, context)).chain(errors)
        };
        sensors(context).flat_map(of).collect()
    }

    fn without_charts(&self) -> &'static str {
        "Nothing is measured."
    }
}

fn sensors<'a>(context: &ViewContext<'a>) -> impl Iterator<Item = (usize, Quantity)> + use<'a> {
    context.session.run().record().sensors().iter().copied().enumerate()
}

fn predicted<'a>(
    estimates: &'a Estimates,
    record: &'a Record,
    quantity: Quantity,
) -> Option<impl Fn(usize) -> f64 + Copy + 'a> {
    let place = estimates.sensors().iter().position(|own| *own == quantity)?;
    let measured = estimates.measured(record, place)?;
    Some(move |k: usize| measured(k) - estimates.innovation(k)[place])
}

fn measured<'a>(sensor: usize, context: &ViewContext<'a>) -> &'a [f64] {
    let run = context.session.run();
    &run.record().measured(sensor)[..run.len()]
}

fn columns<'a>((sensor, quantity): (usize, Quantity), context: &ViewContext<'a>) -> Vec<Column<'a>> {
    let all = measured(sensor, context);
    let number = |value: f64| (!value.is_nan()).then(|| significant(value, 4));
    let measured = Column::new("measured", context.palette.measured, move |k| number(*all.get(k)?));
    let one_step = context.filters().filter_map(move |(_, estimates)| {
        let predicted = predicted(estimates, context.session.run().record(), quantity)?;
        let text = move |k: usize| number((k < estimates.len().min(all.len())).then(|| predicted(k))?);
        Some(Column::new(estimates.name(), context.palette.shade(estimates.color()), text))
    });
    std::iter::once(measured).chain(one_step).collect()
}

fn signals<'a>(sensor: usize, quantity: Quantity, context: &ViewContext<'a>) -> Chart<'a> {
    let ViewContext { session, palette, visible, axis, .. } = *context;
    let all = measured(sensor, context);
    let mut layers: Vec<Layer<'a>> = Vec::new();
    if visible.measured {
        layers.push(Layer::Dots { series: Series::of(all), color: palette.measured });
        layers.extend(weights::layers(quantity, all, context));
    }
    for (place, estimates) in context.filters() {
        let Some(values) = predicted(estimates, context.session.run().record(), quantity) else { continue };
        layers.push(
            Layer::line(
                Series::new(estimates.len().min(all.len()), move |samples| samples.map(values)),
                palette.shade(estimates.color()).gamma_multiply(0.7),
                line_width(place, PREDICTED),
            )
            .of(estimates.id()),
        );
    }
    for (place, estimates) in context.filters() {
        if let Some(free) = session.free_run(place) {
            layers.push(Layer::dashed(Series::of(&free.predicted[sensor]), palette.shade(estimates.color()), 1.4));
        }
    }
    let k = axis.readout(session);
    let now = all.get(k).filter(|value| !value.is_nan());
    let readouts = now.map(|value| Readout::new(significant(*value, 4), palette.measured, "measured".to_owned()));
    let said = weights::at(quantity, k, context);
    let said = if said.is_empty() { weights::shares(quantity, all, context) } else { said };
    Chart {
        key: format!("measured {}", quantity.key()),
        title: format!("{} measured and predicted", quantity.name()),
        symbol: quantity.symbol().to_owned(),
        name: format!("{}: measured, predicted{}", quantity.name(), if session.is_live() { "" } else { ", free run" }),
        unit: context.unit(quantity.unit()),
        columns: columns((sensor, quantity), context),
        readouts: Some(readouts.into_iter().chain(said).collect()),
        layers,
        ..Chart::default()
    }
}

fn errors<'a>(sensor: usize, quantity: Quantity, context: &ViewContext<'a>) -> Chart<'a> {
    let ViewContext { session, palette, .. } = *context;
    let all = measured(sensor, context);
    let mut layers: Vec<Layer<'a>> = vec![Layer::Level { value: 0.0, color: palette.weak, label: "" }];
    let mut readouts = Vec::new();
    for (place, estimates) in context.filters() {
        let Some(free) = session.free_run(place) else { continue };
        let values = move |k: usize| all[k] - free.predicted[sensor][k];
        let color = palette.shade(estimates.color());
        layers.push(
            Layer::line(
                Series::new(free.predicted[sensor].len().min(all.len()), move |samples| samples.map(values)),
                color,
                1.0,
            )
            .of(estimates.id()),
        );
        if let Some(fit) = free.fits[sensor] {
            let text = format!("{} rms, fit {:.1} %", significant(fit.rms, 3), fit.percent);
            readouts.push(Readout::new(text, color, format!("free run of {}", estimates.name())));
        }
        let held_out = session.library().held_out().zip(session.held_out_fit(place, sensor));
        if let Some(((name, _), fit)) = held_out {
            let text = format!("held out {:.1} %", fit.percent);
            let hint = format!("fit of {} on “{name}”: {} rms", estimates.name(), significant(fit.rms, 3));
            readouts.push(Readout::new(text, color, hint));
        }
    }
    Chart {
        key: format!("free run of {}", quantity.key()),
        title: format!("error of the free run, {}", quantity.name()),
        symbol: format!("Δ{}", quantity.symbol()),
        name: "error of the free run".to_owned(),
        unit: context.unit(quantity.unit()),
        readouts: Some(readouts),
        layers,
        ..Chart::default()
    }
}
