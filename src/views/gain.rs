//! The Kalman gain over time.

use egui::Ui;
use kalmanscope_core::Channel;

use super::chart::{Chart, Layer, Readout};
use super::{View, ViewContext, grid};
use crate::command::Command;
use crate::text::significant;

/// What a unit of innovation does to each channel.
pub(super) struct Gain;

impl View for Gain {
    fn name(&self) -> &'static str {
        "Kalman gain"
    }

    fn help(&self) -> [&'static str; 3] {
        [
            "How far each channel moves for an innovation of one standard deviation: K times √S, for the first sensor.",
            "Large at first, when the filter knows little; then it settles where new evidence balances process noise and fading.",
            "A gain that goes to zero is a filter that no longer listens.",
        ]
    }

    fn ui(&self, ui: &mut Ui, context: &ViewContext<'_>, commands: &mut Vec<Command>) -> Option<f64> {
        let channels: Vec<Channel> = context.session.run().channels();
        let (parameters, states): (Vec<Channel>, Vec<Channel>) = channels.into_iter().partition(|c| c.is_parameter());
        let channels = [parameters, states].concat();
        if context.session.scenario().sensors.is_empty() {
            ui.weak("Nothing is measured.");
            return None;
        }
        let mut pointed = None;
        grid(ui, channels.len(), |ui, i, last_row| {
            pointed = chart(channels[i], context, last_row).show(ui, context, commands).or(pointed);
        });
        pointed
    }
}

fn chart<'a>(channel: Channel, context: &ViewContext<'a>, names_time: bool) -> Chart<'a> {
    let ViewContext { session, palette, shown, axis } = *context;
    let k = axis.readout(session);
    let mut layers: Vec<Layer<'a>> = vec![Layer::Level { value: 0.0, color: palette.weak }];
    let mut readouts = Vec::new();
    for (place, estimates) in session.run().estimates().iter().enumerate().filter(|&(place, _)| shown.filter(place)) {
        let Some(at) = estimates.place(channel) else { continue };
        let value = move |k: usize| estimates.gain(k)[at] * estimates.innovation_cov(k)[0].sqrt();
        layers.push(Layer::Line {
            value: Box::new(value),
            len: estimates.len(),
            color: palette.filter(place),
            width: 1.2,
            dashed: false,
            bounds: false,
        });
        if k < estimates.len() {
            readouts.push(Readout {
                text: significant(value(k), 3),
                color: palette.filter(place),
                hint: estimates.name().to_owned(),
            });
        }
    }
    Chart {
        key: format!("gain of {}", channel.key()),
        title: format!("gain of the {}", channel.name()),
        symbol: format!("K√S → {}", channel.symbol()),
        name: channel.name().to_owned(),
        unit: channel.unit(),
        readouts,
        layers,
        names_time,
        least: None,
    }
}
