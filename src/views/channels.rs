//! States and parameters over time: truth, measurement, each filter's estimate and its ±2σ band.

use egui::Ui;
use kalmanscope_core::{Channel, Quantity};

use super::chart::Chart;
use super::charts::charts_ui;
use super::heading::Readout;
use super::layer::{Layer, line_width};
use super::sampled::{Band, Series};
use super::{View, ViewContext};
use crate::command::Command;
use crate::text::fixed;

/// The width of the first filter's line \[points\].
const ESTIMATE: f32 = 2.4;

/// What moves.
pub(super) struct States;

impl View for States {
    fn name(&self) -> &'static str {
        "States"
    }

    fn help(&self) -> [&'static str; 3] {
        [
            "The motion over time: truth thick, measurements as dots, each filter's estimate with its ±2σ band.",
            "A filter that is right about itself has the truth in its band 95 % of the time.",
            "The estimate should be closer to the truth than the dots are: that is what filtering is for.",
        ]
    }

    fn ui(&self, ui: &mut Ui, context: &ViewContext<'_>, commands: &mut Vec<Command>) -> Option<f64> {
        channels_ui(ui, context, commands, |channel| !channel.is_parameter())
    }
}

/// What the plant is.
pub(super) struct Parameters;

impl View for Parameters {
    fn name(&self) -> &'static str {
        "Parameters"
    }

    fn help(&self) -> [&'static str; 3] {
        [
            "The plant's parameters over time: truth thick, each filter's estimate with its ±2σ band.",
            "Nobody measures them: a filter infers them from how the motion answers the force.",
            "The band narrows as evidence comes in. A change of the truth is followed only by a filter that forgets or doubts.",
        ]
    }

    fn ui(&self, ui: &mut Ui, context: &ViewContext<'_>, commands: &mut Vec<Command>) -> Option<f64> {
        channels_ui(ui, context, commands, Channel::is_parameter)
    }
}

fn channels_ui(
    ui: &mut Ui,
    context: &ViewContext<'_>,
    commands: &mut Vec<Command>,
    wanted: impl Fn(Channel) -> bool,
) -> Option<f64> {
    let channels: Vec<Channel> = context.session.run().channels().into_iter().filter(|c| wanted(*c)).collect();
    let channels = context.shown.channels(channels);
    charts_ui(ui, channels.len(), context, commands, |i, last_row| chart(channels[i], context, last_row))
}

/// One channel's chart: bands under measurements under truth under estimates.
fn chart<'a>(channel: Channel, context: &ViewContext<'a>, last_row: bool) -> Chart<'a> {
    let ViewContext { session, palette, shown, .. } = *context;
    let run = session.run();
    let record = run.record();
    let mut layers: Vec<Layer<'a>> = Vec::new();
    let filters = || run.estimates().iter().enumerate().filter(|&(place, _)| shown.filter(place));
    for (place, estimates) in filters().filter(|_| shown.bands) {
        let Some(at) = estimates.place(channel) else { continue };
        let band = Band::around(estimates.canonical_means(at), estimates.variances(at));
        layers.push(Layer::Band { band, color: palette.filter(place), under: line_width(place, ESTIMATE) });
    }
    let quantity = Quantity::all().into_iter().find(|q| q.channel() == Some(channel));
    if let Some(z) = quantity.and_then(|q| record.measured_quantity(q)).filter(|_| shown.measured) {
        layers.push(Layer::Dots { series: Series::of(&z[..run.len()]), color: palette.measured });
    }
    // Where all agree, each line still shows beside the narrower one above it.
    if let Some(truth) = record.truth(channel).filter(|_| shown.truth) {
        layers.push(Layer::Line {
            series: Series::of(&truth[..run.len()]),
            color: palette.truth,
            width: 4.0,
            dashed: false,
            bounds: true,
        });
    }
    for (place, estimates) in filters() {
        let Some(at) = estimates.place(channel) else { continue };
        layers.push(Layer::Line {
            series: Series::of(estimates.canonical_means(at)),
            color: palette.filter(place),
            width: line_width(place, ESTIMATE),
            dashed: false,
            bounds: false,
        });
    }
    for (place, estimates) in session.smoothed().iter().filter(|(place, _)| shown.filter(*place)) {
        let Some(at) = estimates.place(channel) else { continue };
        layers.push(Layer::Line {
            series: Series::of(estimates.canonical_means(at)),
            color: palette.filter(*place),
            width: 1.4,
            dashed: true,
            bounds: false,
        });
    }
    Chart {
        key: channel.key().to_owned(),
        title: channel.name().to_owned(),
        symbol: channel.symbol().to_owned(),
        name: channel.name().to_owned(),
        unit: channel.unit(),
        readouts: readouts(channel, context),
        layers,
        last_row,
        least: None,
        logarithmic: false,
    }
}

/// Truth and estimates at the cursor, or at playback.
fn readouts(channel: Channel, context: &ViewContext<'_>) -> Vec<Readout> {
    let ViewContext { session, palette, shown, axis, .. } = *context;
    let k = axis.readout(session);
    let decimals = decimals(channel);
    let truth = session.run().record().truth(channel).and_then(|truth| truth.get(k)).map(|truth| Readout {
        text: fixed(*truth, decimals),
        color: palette.truth,
        hint: "truth".to_owned(),
    });
    let filters = session.run().estimates().iter().enumerate().filter_map(|(place, estimates)| {
        let at = estimates.place(channel).filter(|_| shown.filter(place) && k < estimates.len())?;
        let mean = fixed(estimates.canonical_mean(k, at), decimals);
        let text = format!("{mean} ±{}", fixed(2.0 * estimates.std(k, at), decimals));
        Some(Readout { text, color: palette.filter(place), hint: estimates.name().to_owned() })
    });
    truth.into_iter().chain(filters).collect()
}

/// Decimals that show a channel's usual values well.
pub(super) fn decimals(channel: Channel) -> usize {
    match channel {
        Channel::stiffness(0) | Channel::stiffness(1) | Channel::stiffness(2) | Channel::stiffness(3) => 1,
        Channel::CUBIC_STIFFNESS | Channel::HYSTERESIS_BETA | Channel::HYSTERESIS_GAMMA => 1,
        Channel::NATURAL_FREQUENCY | Channel::STOREY_DAMPING => 3,
        _ if channel.unit() == "m/s" => 3,
        _ => 4,
    }
}
