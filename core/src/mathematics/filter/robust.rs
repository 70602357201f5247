//! Updates that weigh measurements: one that does not fit counts less than others, or not at all.
//!
//! ```text
//! Rᵢ ← Rᵢ / wᵢ,  wᵢ from the misfit of sensor i after the update; again until no weight changes
//! ```
//!
//! A weight of zero leaves a sensor out, as if it had measured nothing; a weight near zero is reported in the same way. Each misfit
//! is divided by the usual one of the sensor's last readings, where that is large: otherwise a filter that is lost would take all
//! readings for outliers. Each rule has a file of its own; the registry below lists them.

mod gate;
mod huber;
mod mixture;
mod student_t;

use std::fmt;
use std::sync::LazyLock;

use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

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

/// The registry: a constant for each rule, and the list of all of them.
macro_rules! registry {
    ($($(#[$doc:meta])* $name:ident = $info:expr;)*) => {
        impl Robust {
            $($(#[$doc])* pub const $name: Self = Self(&$info);)*

            /// Every rule.
            pub const ALL: [Self; [$(stringify!($name)),*].len()] = [$(Self::$name),*];
        }
    };
}
registry! {
    /// Every measurement counts as its R says.
    NONE = NONE;
    /// Leaves out a measurement that is too far from its prediction.
    GATE = gate::GATE;
    /// Huber's weights: beyond a limit, a measurement pulls with constant force.
    HUBER = huber::HUBER;
    /// The noise of each sensor follows Student's distribution.
    STUDENT_T = student_t::STUDENT_T;
    /// Each reading is good or an outlier, with a probability.
    MIXTURE = mixture::MIXTURE;
}

static NONE: RobustInfo = RobustInfo {
    key: "none",
    name: "none",
    description: "takes every measurement as its R says",
    reference: "Kalman (1960), A new approach to linear filtering and prediction problems",
    passes: 0,
    is_probable: false,
    weight: |_| 1.0,
};

impl Robust {
    /// A reading with a smaller weight is reported as left out.
    pub const LEFT_OUT: f64 = 0.15;

    /// Its description.
    pub const fn info(self) -> &'static RobustInfo {
        self.0
    }

    /// Whether it weighs anything.
    pub fn is_on(self) -> bool {
        self != Self::NONE
    }

    /// The weight of a measurement of a sensor with this usual misfit.
    pub(crate) fn weight(self, misfit: Misfit, usual: f64) -> f64 {
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
        self.0.key == other.0.key
    }
}

impl fmt::Debug for Robust {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0.key)
    }
}

impl Serialize for Robust {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.0.key)
    }
}

impl<'de> Deserialize<'de> for Robust {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        static KEYS: LazyLock<Vec<&'static str>> =
            LazyLock::new(|| Robust::ALL.iter().map(|rule| rule.0.key).collect());
        let key = String::deserialize(deserializer)?;
        let rule = Self::ALL.into_iter().find(|rule| rule.0.key == key);
        rule.ok_or_else(|| de::Error::unknown_variant(&key, &KEYS))
    }
}

/// The median of e² / S where the filter is right: that of χ² with one degree of freedom.
const MEDIAN: f64 = 0.454_936;

/// The usual misfit goes by this share towards each reading's, and not below this level.
const STEP: f64 = 0.2;
const LEAST_LEVEL: f64 = 0.5;

/// The usual misfit of a sensor, over that of a filter that is right, before its first reading.
pub(crate) const FIRST_LEVEL: f64 = LEAST_LEVEL;

/// The usual misfit of a sensor after a reading with this predicted misfit.
pub(crate) fn usual_after(usual: f64, predicted: f64) -> f64 {
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
