//! The settings that can be dragged in plots over time.

use kalmanscope_core::setting::{Entry, INITIAL_MEAN, INITIAL_STD, SENSOR_STD, TableInfo};
use kalmanscope_core::{Channel, Estimates, FilterSettings, Quantity, Sensor, Signal, Source};

use crate::plot::handles::{Handle, Set};
use crate::text::significant;
use crate::view::ViewContext;

/// The least standard deviation that a handle sets.
const LEAST: f64 = 1e-6;

/// In a chart of a channel: each filter's guess and its ±2σ at the beginning, and a sudden change of the truth.
pub(super) fn of_channel<'a>(channel: Channel, context: &ViewContext<'a>) -> Vec<Handle<'a>> {
    let session = context.session;
    let record = session.run().record();
    let mut handles = Vec::new();
    let has_truth = context.visible.truth && !session.is_measured();
    if let Some(Signal::Step(step)) = session.scenario().plant.parameter(channel).filter(|_| has_truth) {
        handles.push(Handle {
            name: format!("time and size of the change of the {}", channel.name()),
            time: Some(record.time_of(0) + step.at),
            value: step.to,
            color: context.palette.truth,
            set: Box::new(move |time, value| {
                let at = rounded(time - record.time_of(0)).clamp(0.0, session.scenario().duration);
                let to = rounded(value);
                let to = if channel.is_positive() { to.max(LEAST) } else { to };
                let address = |number: &str| format!("plant.{}.step.{number}", channel.key());
                vec![(address("to"), to), (address("at"), at)]
            }),
        });
    }
    if !channel.is_parameter() || record.forgotten() > 0 {
        return handles;
    }
    for (_, estimates) in context.filters() {
        let id = estimates.id();
        let Some(filter) = session.scenario().filters.iter().find(|filter| filter.id == id) else { continue };
        if filter.knows(channel) {
            continue;
        }
        let (mean, std) = (filter.initial_mean[channel], filter.initial_std[channel]);
        let color = context.color(estimates);
        let time = Some(record.time_of(0));
        let name = &filter.name;
        handles.push(Handle {
            name: format!("{name}'s guess of the {}", channel.name()),
            time,
            value: mean,
            color,
            set: set(filter, &INITIAL_MEAN, Entry::Channel(channel), rounded),
        });
        handles.push(Handle {
            name: format!("2σ of {name}'s guess of the {}", channel.name()),
            time,
            value: mean + 2.0 * std,
            color: color.gamma_multiply(0.6),
            set: set(filter, &INITIAL_STD, Entry::Channel(channel), move |value| std_of(value - mean)),
        });
    }
    handles
}

/// In a chart of a measured state: 2σ of the sensor's true noise above the truth, at the beginning, since the truth
/// stays in place there while the record grows.
pub(super) fn of_noise<'a>(channel: Channel, context: &ViewContext<'a>) -> Option<Handle<'a>> {
    let ViewContext { session, visible, palette, .. } = *context;
    let record = session.run().record();
    let is_simulated = matches!(session.run().source(), Source::Simulated);
    let is_sensor = move |sensor: &Sensor| sensor.measures.channel() == Some(channel);
    let sensor = session.scenario().sensors.iter().find(|sensor| is_sensor(sensor)).filter(|_| is_simulated)?;
    let first = *record.truth(channel)?.first().filter(|_| visible.measured && record.forgotten() == 0)?;
    Some(Handle {
        name: format!("2σ of the noise of the {} sensor", sensor.measures.key()),
        time: Some(record.time_of(0)),
        value: first + 2.0 * sensor.noise_std,
        color: palette.weak,
        set: Box::new(move |_, value| {
            vec![(format!("sensors.{}.noise_std", sensor.measures.key()), std_of(value - first))]
        }),
    })
}

/// In a chart of innovations: 2√R of each filter, at the right edge.
pub(super) fn of_sensor<'a>(
    sensor: usize,
    quantity: Quantity,
    filters: &[&'a Estimates],
    context: &ViewContext<'a>,
) -> Vec<Handle<'a>> {
    let session = context.session;
    let of = |estimates: &Estimates| {
        let id = estimates.id();
        let filter = session.scenario().filters.iter().find(|filter| filter.id == id)?;
        let std = *filter.sensor_std.get(sensor)?;
        Some(Handle {
            name: format!("2√R of {} for the {} sensor", filter.name, quantity.key()),
            time: None,
            value: 2.0 * std,
            color: context.color(estimates),
            set: set(filter, &SENSOR_STD, Entry::Sensor(quantity), std_of),
        })
    };
    filters.iter().filter_map(|estimates| of(estimates)).collect()
}

/// Sets a number of a table of a filter to that of the handle's value.
fn set<'a>(filter: &FilterSettings, table: &TableInfo, entry: Entry, of: impl Fn(f64) -> f64 + 'a) -> Set<'a> {
    let address = filter.address(&format!("{}.{}", table.key, entry.key()));
    Box::new(move |_, value| vec![(address.clone(), of(value))])
}

/// The standard deviation for a handle at this distance, 2σ.
fn std_of(distance: f64) -> f64 {
    rounded(0.5 * distance).max(LEAST)
}

fn rounded(value: f64) -> f64 {
    crate::text::parse(&significant(value, 3)).unwrap_or(value)
}
