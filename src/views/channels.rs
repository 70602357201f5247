//! States and parameters over time: truth, measurement, each filter's estimate and its ±2σ band.

use kalmanscope_core::{Channel, Quantity};

use crate::plot::chart::Chart;
use crate::plot::layers::{Layer, line_width};
use crate::plot::series::{Band, Series};
use crate::sheet::Column;
use crate::text::{decimals, fixed, in_hertz};
use crate::view::{View, ViewContext};
use crate::views::{handles, weights};

/// The width of the first filter's line \[points\].
const ESTIMATE: f32 = 2.4;

pub(super) enum Channels {
    States,
    Parameters,
}

impl View for Channels {
    fn name(&self) -> &'static str {
        match self {
            Self::States => "States",
            Self::Parameters => "Parameters",
        }
    }

    fn help(&self) -> [&'static str; 3] {
        match self {
            Self::States => [
                "The motion over time: truth thick, measurements as dots, each filter's estimate with its ±2σ band.",
                "The band of a consistent filter contains the truth 95 % of the time.",
                "The estimate should be closer to the truth than the dots. A robust filter leaves out those in its colour.",
            ],
            Self::Parameters => [
                "The plant's parameters over time: truth thick, each filter's estimate with its ±2σ band.",
                "They are not measured: a filter infers them from the response of the motion to the force.",
                "The band narrows with every measurement. Only a filter with fading memory or process noise follows a change of the truth.",
            ],
        }
    }

    fn charts<'a>(&self, context: &ViewContext<'a>) -> Vec<Chart<'a>> {
        let is_wanted = |channel: &Channel| channel.is_parameter() == matches!(self, Self::Parameters);
        let channels = context.session.run().channels().into_iter().filter(is_wanted).collect();
        context.visible.channels(channels).into_iter().map(|channel| chart(channel, context)).collect()
    }
}

fn chart<'a>(channel: Channel, context: &ViewContext<'a>) -> Chart<'a> {
    let ViewContext { session, palette, visible, .. } = *context;
    let run = session.run();
    let record = run.record();
    let mut layers: Vec<Layer<'a>> = Vec::new();
    for (place, estimates) in context.filters().filter(|_| visible.bands) {
        let Some(at) = estimates.place(channel) else { continue };
        let band = Band::around(estimates.canonical_means(at), estimates.variances(at));
        layers.push(Layer::Band {
            band,
            color: palette.shade(estimates.color()),
            under: line_width(place, ESTIMATE),
            filter: Some(estimates.id()),
        });
    }
    let quantity = Quantity::all().iter().find(|q| q.channel() == Some(channel));
    if let Some(z) = quantity.and_then(|q| record.measured_quantity(*q)).filter(|_| visible.measured) {
        layers.push(Layer::Dots { series: Series::of(&z[..run.len()]), color: palette.measured });
        layers.extend(quantity.into_iter().flat_map(|q| weights::layers(*q, &z[..run.len()], context)));
    }
    if let Some(truth) = record.truth(channel).filter(|_| visible.truth) {
        layers.push(Layer::Line {
            series: Series::of(&truth[..run.len()]),
            color: palette.truth,
            width: 4.0,
            dashed: false,
            bounds: true,
            filter: None,
        });
    }
    let truth_before = session.before().and_then(|before| before.truth(channel));
    if let Some(truth) = truth_before.filter(|_| visible.truth) {
        let series = Series::of(truth);
        layers.push(Layer::dashed(series, palette.weak, 1.2));
    }
    let lines: Vec<u32> =
        context.filters().filter(|(_, of)| of.place(channel).is_some()).map(|(_, of)| of.id()).collect();
    for estimates in context.before() {
        let now = lines.iter().position(|id| *id == estimates.id());
        if let (Some(at), Some(now)) = (estimates.place(channel), now) {
            let series = Series::of(estimates.canonical_means(at));
            layers.push(Layer::Before { series, color: palette.weak, now });
        }
    }
    for (place, estimates) in context.filters() {
        let Some(at) = estimates.place(channel) else { continue };
        layers.push(
            Layer::line(
                Series::of(estimates.canonical_means(at)),
                palette.shade(estimates.color()),
                line_width(place, ESTIMATE),
            )
            .of(estimates.id()),
        );
    }
    for estimates in session.smoothed().iter().filter(|of| visible.hindsight && visible.filter(of.id())) {
        let Some(at) = estimates.place(channel) else { continue };
        layers.push(Layer::dashed(Series::of(estimates.canonical_means(at)), palette.shade(estimates.color()), 1.4));
    }
    Chart {
        key: channel.key().to_owned(),
        title: channel.name().to_owned(),
        symbol: channel.symbol().to_owned(),
        name: channel.name().to_owned(),
        unit: context.unit(channel.unit()),
        columns: columns(channel, context),
        layers,
        handles: handles::of_channel(channel, context).into_iter().chain(handles::of_noise(channel, context)).collect(),
        ..Chart::default()
    }
}

fn columns<'a>(channel: Channel, context: &ViewContext<'a>) -> Vec<Column<'a>> {
    let ViewContext { session, palette, .. } = *context;
    let decimals = decimals(channel);
    let truth = session.run().record().truth(channel).map(|truth| {
        let column = Column::new("truth", palette.truth, move |k| Some(fixed(*truth.get(k)?, decimals)));
        column.with_aside(move |k| in_hertz(*truth.get(k)?, channel.unit()))
    });
    let filters = context.filters().filter_map(|(_, estimates)| {
        let at = estimates.place(channel)?;
        let text = move |k: usize| {
            let mean = fixed(estimates.canonical_mean(k, at), decimals);
            format!("{mean} ±{}", fixed(2.0 * estimates.std(k, at), decimals))
        };
        let color = palette.shade(estimates.color());
        let column = Column::new(estimates.name(), color, move |k| (k < estimates.len()).then(|| text(k)));
        let mean = move |k: usize| (k < estimates.len()).then(|| estimates.canonical_mean(k, at));
        Some(column.with_aside(move |k| in_hertz(mean(k)?, channel.unit())))
    });
    truth.into_iter().chain(filters).collect()
}
