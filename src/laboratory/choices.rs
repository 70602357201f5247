//! The user's choices in the laboratory, for links and sessions.

use kalmanscope_core::Scenario;
use serde::{Deserialize, Serialize};

use super::{Choice, Laboratory, SeedChoice, TuneChoice};

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Choices {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub map: Option<Choice>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seeds: Option<SeedChoice>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tuning: Option<TuneChoice>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub posterior: Option<u32>,
}

impl Choices {
    /// Whether the choices are possible with a scenario.
    ///
    /// # Errors
    /// A sentence with the reason.
    pub fn check(&self, scenario: &Scenario) -> Result<(), String> {
        let Self { map, seeds, tuning, posterior: _ } = self;
        map.as_ref().map_or(Ok(()), |map| map.check(scenario))?;
        seeds.as_ref().map_or(Ok(()), SeedChoice::check).map_err(|reason| format!("Monte Carlo: {reason}"))?;
        tuning
            .as_ref()
            .map_or(Ok(()), |tuning| tuning.check(scenario))
            .map_err(|reason| format!("Tune for me: {reason}"))
    }

    /// These choices without those of filters and settings that a scenario no longer has: no view fits a choice that is not shown.
    pub(crate) fn possible_with(self, scenario: &Scenario) -> Self {
        Self {
            map: self.map.filter(|map| map.check(scenario).is_ok()),
            tuning: self.tuning.filter(|tuning| tuning.check(scenario).is_ok()),
            ..self
        }
    }

    /// These choices; those that are `None` come from `others`.
    pub(crate) fn or(self, others: Self) -> Self {
        let Self { map, seeds, tuning, posterior } = self;
        Self {
            map: map.or(others.map),
            seeds: seeds.or(others.seeds),
            tuning: tuning.or(others.tuning),
            posterior: posterior.or(others.posterior),
        }
    }
}

impl Laboratory {
    pub fn choices(&self) -> Choices {
        Choices {
            map: self.choice().cloned(),
            seeds: Some(*self.seeds().choice()),
            tuning: self.tuning().chosen().cloned(),
            posterior: self.posteriors().chosen(),
        }
    }

    pub fn restore(&mut self, Choices { map, seeds, tuning, posterior }: Choices) {
        self.choose(map);
        self.seeds_mut().choose(seeds.unwrap_or_default());
        self.tuning_mut().choose(tuning);
        self.posteriors_mut().choose(posterior);
    }
}
