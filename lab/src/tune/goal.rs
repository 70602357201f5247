//! The goal of tuning.

use kalmanscope_core::{Measure, Quantity};
use serde::{Deserialize, Serialize};

/// The number that tuning optimises. In files it is the name of its measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "Measure", into = "Measure")]
pub enum Goal {
    /// The log likelihood of all measurements, from the innovations and their covariances.
    ///
    /// Source: Schweppe (1965), Evaluation of likelihood functions for Gaussian signals.
    Likelihood,
    /// The error of the identified model's free run, for one sensor.
    FreeRun(Quantity),
    /// The distance of the mean NIS from its expectation.
    Consistency,
}

impl Goal {
    /// The measure that it is about.
    pub const fn measure(self) -> Measure {
        match self {
            Self::Likelihood => Measure::LOG_LIKELIHOOD,
            Self::FreeRun(sensor) => Measure::free_run(sensor),
            Self::Consistency => Measure::NIS,
        }
    }

    /// The number for a value of the measure; more is better.
    pub fn score(self, value: f64) -> f64 {
        match self {
            Self::Likelihood => value,
            Self::FreeRun(_) => -libm::log(value),
            Self::Consistency => -libm::log(value).abs(),
        }
    }

    /// The largest change of the score that is not significant.
    pub(super) const fn indifferent(self) -> f64 {
        match self {
            // A 95 % interval of one parameter: half the quantile 3.84 of χ² with one degree of freedom.
            Self::Likelihood => 1.92,
            Self::FreeRun(_) | Self::Consistency => 0.01,
        }
    }
}

impl From<Goal> for Measure {
    fn from(goal: Goal) -> Self {
        goal.measure()
    }
}

impl TryFrom<Measure> for Goal {
    type Error = String;

    fn try_from(measure: Measure) -> Result<Self, Self::Error> {
        if let Some(sensor) = measure.sensor().filter(|sensor| Measure::free_run(*sensor) == measure) {
            return Ok(Self::FreeRun(sensor));
        }
        let goals = [Self::Likelihood, Self::Consistency];
        goals.into_iter().find(|goal| goal.measure() == measure).ok_or_else(|| {
            format!("`{measure}` is no goal of tuning: it may be `log_likelihood`, `nis` or `free_run.SENSOR`")
        })
    }
}
