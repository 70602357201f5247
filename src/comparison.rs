//! Changes of the whole scenario by one key, to compare their results.

use kalmanscope_core::{Channel, Hold, Scenario};

pub(crate) fn with_other_hold(scenario: &Scenario) -> Scenario {
    let hold = match scenario.hold {
        Hold::Zero => Hold::First,
        Hold::First => Hold::Zero,
    };
    Scenario { hold, ..scenario.clone() }
}

pub(crate) fn with_other_gain(scenario: &Scenario) -> Scenario {
    let mut scenario = scenario.clone();
    let all = scenario.filters.iter().all(|filter| filter.augment.contains(&Channel::INPUT_GAIN));
    for filter in &mut scenario.filters {
        filter.augment.retain(|channel| *channel != Channel::INPUT_GAIN);
        filter.augment.extend((!all).then_some(Channel::INPUT_GAIN));
    }
    scenario
}
