//! The settings that can be dragged in plots over time.

use kalmanscope_core::setting::INITIAL_MEAN;
use kalmanscope_core::{Channel, Signal};

use crate::plot::handles::PlotHandle;
use crate::text::significant;
use crate::view::ViewContext;

/// The least value of a positive channel that a handle sets.
const LEAST: f64 = 1e-6;

pub(super) fn of_channel<'a>(channel: Channel, context: &ViewContext<'a>) -> Vec<PlotHandle<'a>> {
    let session = context.session;
    let record = session.run().record();
    let mut handles = Vec::new();
    let has_truth = context.visible.truth && !session.is_measured();
    if let Some(Signal::Step(step)) = session.scenario().plant.parameter(channel).filter(|_| has_truth) {
        handles.push(PlotHandle {
            name: format!("time and size of the change of the {}", channel.name()),
            time: record.time_of(0) + step.at,
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
    // The guess stands at the first sample, which a long live record has forgotten.
    if !channel.is_parameter() || record.forgotten() > 0 {
        return handles;
    }
    for (_, estimates) in context.filters() {
        let id = estimates.id();
        let Some(filter) = session.scenario().filters.iter().find(|filter| filter.id == id) else { continue };
        if filter.knows(channel) {
            continue;
        }
        let address = filter.address(&format!("{}.{}", INITIAL_MEAN.key, channel.key()));
        handles.push(PlotHandle {
            name: format!("{}'s guess of the {}", filter.name, channel.name()),
            time: record.time_of(0),
            value: filter.initial_mean[channel],
            color: context.color(estimates),
            set: Box::new(move |_, value| vec![(address.clone(), rounded(value))]),
        });
    }
    handles
}

fn rounded(value: f64) -> f64 {
    // A drag gives sixteen digits, which nobody wants in a field or a link.
    crate::text::parse(&significant(value, 3)).unwrap_or(value)
}
