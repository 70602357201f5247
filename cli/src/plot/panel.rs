//! The subject of one plot: a channel, or the readings of a sensor.

use kalmanscope_core::{Channel, Estimates, Quantity, Record, Run};

use crate::estimates_csv::Reading;

/// A channel with its estimates, or a sensor with its predictions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Panel {
    Channel(Channel),
    Sensor(Quantity),
}

/// Mean and standard deviation at a sample; NaN where there is none.
pub(super) type Curve<'a> = Box<dyn Fn(usize) -> (f64, f64) + 'a>;

impl Panel {
    /// The plots of a run, from top to bottom. A sensor has its own plot if no channel equals its reading, or if no
    /// truth is known: then its prediction is the only comparison.
    pub(super) fn all(run: &Run) -> Vec<Self> {
        let (channels, record) = (run.channels(), run.record());
        let knows_truth = Channel::all().iter().any(|&channel| record.truth(channel).is_some());
        let is_shown = |sensor: &Quantity| sensor.channel().is_some_and(|channel| channels.contains(&channel));
        let sensors = record.sensors().iter().copied().filter(|sensor| !(knows_truth && is_shown(sensor)));
        let used = |sensor: &Quantity| run.estimates().iter().any(|estimates| estimates.sensors().contains(sensor));
        let sensors: Vec<Self> = sensors.filter(used).map(Self::Sensor).collect();
        channels.iter().copied().map(Self::Channel).chain(sensors).collect()
    }

    /// The label of the value axis.
    pub(super) fn title(self) -> String {
        let (name, symbol, unit) = match self {
            Self::Channel(channel) => (channel.name().to_owned(), channel.symbol(), channel.unit()),
            Self::Sensor(sensor) => (format!("predicted {}", sensor.name()), sensor.symbol(), sensor.unit()),
        };
        format!("{name} {symbol} [{}]", if unit.is_empty() { "-" } else { unit })
    }

    /// The measurements, if there is a sensor.
    pub(super) fn measured(self, record: &Record) -> Option<&[f64]> {
        let sensor = match self {
            Self::Channel(channel) => *Quantity::all().iter().find(|q| q.channel() == Some(channel))?,
            Self::Sensor(sensor) => sensor,
        };
        record.measured_quantity(sensor)
    }

    /// The truth, where it is known.
    pub(super) fn truth(self, record: &Record) -> Option<&[f64]> {
        match self {
            Self::Channel(channel) => record.truth(channel),
            Self::Sensor(_) => None,
        }
    }

    /// A filter's estimate, or its prediction from all earlier samples. `None` if it has neither.
    pub(super) fn curve<'a>(self, estimates: &'a Estimates, record: &'a Record) -> Option<Curve<'a>> {
        Some(match self {
            Self::Channel(channel) => {
                let place = estimates.place(channel)?;
                Box::new(move |k| (estimates.canonical_mean(k, place), estimates.std(k, place)))
            }
            Self::Sensor(sensor) => {
                estimates.sensors().contains(&sensor).then_some(())?;
                Box::new(move |k| {
                    let Reading { std, predicted, .. } = Reading::of(estimates, record, sensor, k);
                    (predicted, std)
                })
            }
        })
    }
}
