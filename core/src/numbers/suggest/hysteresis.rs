//! Start values of a spring that yields.

use super::rounded;
use crate::{Channel, FilterSettings, InputKind, PlantKind};

/// Share of the load that the spring keeps after yielding, to begin with.
const POST_YIELD: (f64, f64) = (0.5, 0.25);

/// Start values for a filter with a Bouc-Wen plant: the spring yields at a large motion, at about twice the root mean
/// square `displacement` \[m\]. Returns false for another plant.
pub(super) fn start(filter: &mut FilterSettings, truth: PlantKind, input: InputKind, displacement: f64) -> bool {
    let model = filter.model(truth, input);
    let shapes = [
        (Channel::YIELD_BETA, Channel::YIELD_GAMMA, 1.0 / (2.0 * displacement)),
        (Channel::HYSTERESIS_BETA, Channel::HYSTERESIS_GAMMA, 1.0 / (4.0 * displacement * displacement)),
    ];
    let Some((beta, gamma, shape)) = shapes.into_iter().find(|(beta, ..)| model.place(*beta).is_some()) else {
        return false;
    };
    if !(shape.is_finite() && shape > 0.0) {
        return false;
    }
    let (ratio, spread) = POST_YIELD;
    for (channel, mean, std) in [
        (Channel::HYSTERETIC_DISPLACEMENT, 0.0, 0.1 * displacement),
        (Channel::POST_YIELD_RATIO, ratio, spread),
        (beta, 0.5 * shape, shape),
        (gamma, 0.0, shape),
    ] {
        filter.initial_mean[channel] = rounded(mean);
        filter.initial_std[channel] = rounded(std);
        filter.process_std[channel] = 0.0;
    }
    true
}
