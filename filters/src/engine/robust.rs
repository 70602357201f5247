//! Updates that weigh measurements: one that does not fit counts less than others, or not at all.
//!
//! ```text
//! Rᵢ ← Rᵢ / wᵢ,  wᵢ from the misfit of sensor i after the update; again until no weight changes
//! ```
//!
//! A weight of zero leaves a sensor out, as if it had measured nothing; a weight near zero is reported in the same way. Each misfit
//! is divided by the usual one of the sensor's last readings, where that is large: otherwise a filter that is lost would take all
//! readings for outliers. The registry below lists the rules.

use crate::registry::{keyed, registry};

/// The description of a rule for weights.
#[derive(Debug)]
pub struct RobustInfo {
    /// The key in scenario files.
    pub key: &'static str,
    /// The name in running text.
    pub name: &'static str,
    /// Its effect, in a few words.
    pub description: &'static str,
    /// Where it comes from.
    pub reference: &'static str,
    /// Limits the updates by one sample with new weights, after the first one, in which all weights are 1.
    pub passes: usize,
    /// Whether 1 less the weight is the probability that the measurement is an outlier.
    pub is_probable: bool,
    /// The weight of a measurement, from 0 to 1 or somewhat above.
    pub weight: fn(&Misfit) -> f64,
}

/// How far a sensor is from its prediction, and from the state after the update.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Misfit {
    /// `e² / S` of the sensor alone, before any weight: 1 on average where the filter is right.
    pub predicted: f64,
    /// `ε² / R` with the residual `ε = z - h(y⁺)` of the last update and R without a weight.
    pub residual: f64,
    /// `H P⁺ Hᵀ / R`, the variance of the residual that the state's own uncertainty makes.
    pub uncertainty: f64,
}

/// A rule for weights, identified by its key.
#[derive(Clone, Copy)]
pub struct Robust(&'static RobustInfo);

registry! {
    Robust by Robust,
    /// Every rule.
    ALL;
    /// Every measurement counts as its R says.
    NONE = NONE;
    /// Leaves out a measurement that is too far from its prediction.
    GATE = GATE;
    /// Huber's weights: beyond a limit, a measurement pulls with constant force.
    HUBER = HUBER;
    /// The noise of each sensor follows Student's distribution.
    STUDENT_T = STUDENT_T;
    /// Each reading is good or an outlier, with a probability.
    MIXTURE = MIXTURE;
}

static NONE: RobustInfo = RobustInfo {
    key: "none",
    name: "none",
    description: "weighs every measurement by its R",
    reference: "Kalman (1960), A new approach to linear filtering and prediction problems",
    passes: 0,
    is_probable: false,
    weight: |_| 1.0,
};

/// Limits a measurement's distance, in standard deviations: normal noise passes it once in 16,000 readings.
const GATE_LIMIT: f64 = 4.0;

static GATE: RobustInfo = RobustInfo {
    key: "gate",
    name: "gate",
    description: "leaves out a reading more than 4 standard deviations from its prediction",
    reference: "Bar-Shalom, Li and Kirubarajan (2001), *Estimation with Applications to Tracking and Navigation*, section 5.4",
    passes: 1,
    is_probable: false,
    weight: |misfit| if misfit.predicted <= GATE_LIMIT * GATE_LIMIT { 1.0 } else { 0.0 },
};

/// A larger residual, in σ of the sensor, pulls with constant force; under normal noise 95 % of the precision is left.
const HUBER_LIMIT: f64 = 1.345;

static HUBER: RobustInfo = RobustInfo {
    key: "huber",
    name: "Huber",
    description: "lets a reading beyond 1.345 standard deviations pull with constant force",
    reference: "Huber (1964), Robust estimation of a location parameter; Karlgaard and Schaub (2007), Huber-based divided difference filtering",
    passes: 10,
    is_probable: false,
    weight: |misfit| {
        if misfit.residual <= HUBER_LIMIT * HUBER_LIMIT { 1.0 } else { HUBER_LIMIT / misfit.residual.sqrt() }
    },
};

/// ν, the degrees of freedom: the fewer, the heavier the tails.
const DEGREES: f64 = 4.0;

/// Each reading has its own precision, whose expectation given the state is the weight.
///
/// ```text
/// w = (ν + 1) / (ν + (ε² + H P⁺ Hᵀ) / R)
/// ```
static STUDENT_T: RobustInfo = RobustInfo {
    key: "student_t",
    name: "Student-t",
    description: "assumes Student's noise with 4 degrees of freedom for each sensor",
    reference: "Agamennoni, Nieto and Nebot (2012), Approximate inference in state-space models with heavy-tailed noise",
    passes: 10,
    is_probable: false,
    weight: |misfit| (DEGREES + 1.0) / (DEGREES + misfit.residual + misfit.uncertainty),
};

/// The share of readings that are outliers, before one is seen.
const OUTLIERS: f64 = 0.05;

/// The noise of an outlier over that of a good reading: it has a hundredth of the information, next to nothing.
const WIDER: f64 = 10.0;

const MOST_ODDS: f64 = 1e6;

/// A reading is good, with the noise R, or an outlier, whose noise is 10 times as wide; which of both is uncertain, and has a probability
/// given the state. An outlier says next to nothing, so the weight is the probability that the reading is good.
///
/// ```text
/// P = π N(ε; 0, λ² R) / (π N(ε; 0, λ² R) + (1 - π) N(ε; 0, R)),  w = 1 - P,  with ε² + H P⁺ Hᵀ in place of ε²
/// ```
static MIXTURE: RobustInfo = RobustInfo {
    key: "mixture",
    name: "good or outlier",
    description: "weighs each reading by its probability to be good, with 5 % outliers of 10 times the noise",
    reference: "Box and Tiao (1968), A Bayesian approach to some outlier problems",
    passes: 10,
    is_probable: true,
    weight: |misfit| {
        let square = misfit.residual + misfit.uncertainty;
        let odds = OUTLIERS / (1.0 - OUTLIERS) / WIDER * libm::exp(0.5 * square * (1.0 - 1.0 / (WIDER * WIDER)));
        // R / w must stay a number that others can be added to.
        if odds < MOST_ODDS { 1.0 / (1.0 + odds) } else { 0.0 }
    },
};

impl Robust {
    /// A reading with a smaller weight is reported as left out.
    pub const LEFT_OUT: f64 = 0.15;

    /// Its description.
    pub const fn info(self) -> &'static RobustInfo {
        self.0
    }

    const fn key(self) -> &'static str {
        self.0.key
    }

    /// Whether it weighs anything.
    pub fn is_on(self) -> bool {
        self != Self::NONE
    }

    pub(crate) fn weight(self, misfit: Misfit, usual: f64) -> f64 {
        // Only upwards: a filter that fits better than expected must not take ordinary readings for outliers.
        let over = usual.max(1.0);
        let Misfit { predicted, residual, uncertainty } = misfit;
        (self.0.weight)(&Misfit { predicted: predicted / over, residual: residual / over, uncertainty })
    }
}

impl Default for Robust {
    fn default() -> Self {
        Self::NONE
    }
}

impl PartialEq for Robust {
    fn eq(&self, other: &Self) -> bool {
        self.key() == other.key()
    }
}

keyed!(Robust, also read);

/// The median of e² / S where the filter is right: that of χ² with one degree of freedom.
const MEDIAN: f64 = 0.454_936;

/// The usual misfit goes by this share towards each reading's: tenfold in 12 readings. It stops at this level, since
/// it would otherwise rise too late after a long quiet time.
const STEP: f64 = 0.2;
const LEAST_LEVEL: f64 = 0.5;

/// The usual misfit of a sensor, over that of a filter that is right, before its first reading.
pub(crate) const FIRST_LEVEL: f64 = LEAST_LEVEL;

pub(crate) fn usual_after(usual: f64, predicted: f64) -> f64 {
    // By the sign alone, so that the level goes to the median: a mean would follow a single outlier.
    let is_above = predicted > MEDIAN * usual;
    (usual * libm::exp(if is_above { STEP } else { -STEP })).max(LEAST_LEVEL)
}

/// A change of a weight, relative to it, that ends the passes.
pub(crate) const SETTLED: f64 = 1e-3;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_those_of_their_sources() {
        let misfit = |predicted: f64, residual: f64| Misfit { predicted, residual, uncertainty: 0.5 };
        let weigh = |rule: Robust, predicted, residual| (rule.info().weight)(&misfit(predicted, residual));
        assert_eq!([weigh(Robust::GATE, 15.9, 0.0), weigh(Robust::GATE, 16.1, 0.0)], [1.0, 0.0]);
        assert_eq!([weigh(Robust::HUBER, 0.0, 1.0), weigh(Robust::HUBER, 0.0, 4.0)], [1.0, 1.345 / 2.0]);
        assert_eq!(weigh(Robust::STUDENT_T, 0.0, 5.5), 0.5);
    }
}
