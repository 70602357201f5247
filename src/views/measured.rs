//! Measurements against predictions: one step ahead, and by the identified model alone.

use kalmanscope_core::{Estimates, Quantity, Record};

use crate::plot::chart::{Chart, Curve};
use crate::plot::heading::Readout;
use crate::plot::layers::{Layer, line_width};
use crate::plot::series::PlotSeries;
use crate::plot::sheet::{Sheet, SheetColumn};
use crate::text::significant;
use crate::view::{View, ViewContext};
use crate::views::weights;

const PREDICTED: f32 = 2.2;

pub(super) static VIEW: View = View {
    name: "Measured and predicted",
    help: [
        "Dots are measured, in a filter's colour where it counts them less; lines are predicted one step ahead; dashed lines are the free run: the identified model alone, driven by the input.",
        "The fit is 100 % where the free run has no error and 0 % where it is no better than the mean. It is the number by which a model is judged.",
        "The model is the last estimate, or that at the mark A, or the mean from A to B (keys A and B).",
    ],
    wants_free_runs: true,
    sheets: Some(sheets),
    charts,
    plots,
    without_charts: "Nothing is measured.",
    ..View::NONE
};

fn sheets<'a>(context: &ViewContext<'a>) -> Vec<Sheet<'a>> {
    sensors(context).map(|(sensor, quantity)| signals(sensor, quantity, context).into_sheet()).collect()
}

fn charts<'a>(context: &ViewContext<'a>) -> Vec<Chart<'a>> {
    let of = |(sensor, quantity): (usize, Quantity)| {
        // A record that is being measured has no free run.
        let errors = (!context.session.is_live()).then(|| errors(sensor, quantity, context));
        std::iter::once(signals(sensor, quantity, context)).chain(errors)
    };
    sensors(context).flat_map(of).collect()
}

fn plots(context: &ViewContext<'_>) -> usize {
    sensors(context).count() * if context.session.is_live() { 1 } else { 2 }
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

fn signals<'a>(sensor: usize, quantity: Quantity, context: &ViewContext<'a>) -> Chart<'a> {
    let ViewContext { session, palette, visible, axis, .. } = *context;
    let all = measured(sensor, context);
    let number = |value: f64| (!value.is_nan()).then(|| significant(value, 4));
    let mut chart = Chart {
        key: format!("measured {}", quantity.key()),
        title: format!("{} measured and predicted", quantity.name()),
        symbol: quantity.symbol().to_owned(),
        name: format!("{}: measured, predicted{}", quantity.name(), if session.is_live() { "" } else { ", free run" }),
        unit: context.unit(quantity.unit()),
        columns: vec![SheetColumn::new("measured", palette.measured, move |k| number(*all.get(k)?))],
        ..Chart::default()
    };
    if visible.measured {
        chart.layers.push(Layer::Dots { series: PlotSeries::of(all), color: palette.measured });
        chart.layers.extend(weights::layers(quantity, all, context));
    }
    for (place, of) in context.filters() {
        let Some(values) = predicted(of, session.run().record(), quantity) else { continue };
        let len = of.len().min(all.len());
        let curve = Curve { line: PlotSeries::each(len, values), band: None, width: line_width(place, PREDICTED) };
        context.add(&mut chart, of, curve, move |k| number((k < len).then(|| values(k))?));
    }
    for (place, of) in context.filters() {
        if let Some(free) = session.free_run(place) {
            chart.layers.push(Layer::dashed(PlotSeries::of(&free.predicted[sensor]), context.color(of), 1.4));
        }
    }
    let k = axis.readout(session);
    let now = chart.columns[0].text(k);
    let readouts = now.map(|text| Readout::new(text, palette.measured, "measured".to_owned()));
    let said = weights::at(quantity, k, context);
    let said = if said.is_empty() { weights::shares(quantity, all, context) } else { said };
    Chart { readouts: Some(readouts.into_iter().chain(said).collect()), ..chart }
}

fn errors<'a>(sensor: usize, quantity: Quantity, context: &ViewContext<'a>) -> Chart<'a> {
    let ViewContext { session, palette, .. } = *context;
    let all = measured(sensor, context);
    let mut layers: Vec<Layer<'a>> = vec![Layer::zero(palette.weak)];
    let mut readouts = Vec::new();
    for (place, estimates) in context.filters() {
        let Some(free) = session.free_run(place) else { continue };
        let color = context.color(estimates);
        let len = free.predicted[sensor].len().min(all.len());
        let error = PlotSeries::each(len, move |k| all[k] - free.predicted[sensor][k]);
        layers.push(Layer::line(error, color, 1.0).of(estimates.id()));
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
