//! Good readings and outliers, each with a probability.

use super::RobustInfo;

/// The share of readings that are outliers, before one is seen.
const SHARE: f64 = 0.05;

/// The noise of an outlier over that of a good reading.
const WIDER: f64 = 10.0;

/// A reading with larger odds is left out.
const MOST_ODDS: f64 = 1e6;

/// A reading is good, with the noise R, or an outlier, whose noise is 10 times as wide; which of both has a probability of its own
/// given the state. An outlier tells next to nothing, so the weight is the probability that the reading is good.
///
/// ```text
/// P = π N(ε; 0, λ² R) / (π N(ε; 0, λ² R) + (1 - π) N(ε; 0, R)),  w = 1 - P,  with ε² + H P⁺ Hᵀ in place of ε²
/// ```
pub(super) static MIXTURE: RobustInfo = RobustInfo {
    key: "mixture",
    name: "good or outlier",
    description: "weighs each reading by the probability that it is no outlier, of which there are 5 % with 10 times the noise",
    reference: "Box and Tiao (1968), A Bayesian approach to some outlier problems",
    passes: 10,
    is_probable: true,
    weight: |misfit| {
        let square = misfit.residual + misfit.uncertainty;
        let odds = SHARE / (1.0 - SHARE) / WIDER * libm::exp(0.5 * square * (1.0 - 1.0 / (WIDER * WIDER)));
        // R / w must stay a number that others can be added to.
        if odds < MOST_ODDS { 1.0 / (1.0 + odds) } else { 0.0 }
    },
};
