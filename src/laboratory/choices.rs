//! The user's choices in the laboratory, for links and sessions.

use kalmanscope_core::Scenario;
use kalmanscope_lab::Trial;

use super::{Choice, Laboratory, SeedChoice, Trials, TuneChoice};

/// The choices of all views of the laboratory. `None` stands for the usual choice.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Choices {
    /// The map.
    pub map: Option<Choice>,
    /// The seeds of Monte Carlo.
    pub seeds: Option<SeedChoice>,
    /// The settings to tune and the goal.
    pub tuning: Option<TuneChoice>,
    /// The id of the filter whose posterior is shown.
    pub posterior: Option<u32>,
    /// The results of several records.
    pub trials: Vec<Trial>,
}

impl Choices {
    /// Whether the choices are possible with a scenario.
    ///
    /// # Errors
    /// A sentence that says what is wrong.
    pub fn check(&self, scenario: &Scenario) -> Result<(), String> {
        let Self { map, seeds, tuning, posterior: _, trials } = self;
        Trials::check(trials).map_err(|reason| format!("Your own oscillator: {reason}"))?;
        map.as_ref().map_or(Ok(()), |map| map.check(scenario))?;
        seeds.as_ref().map_or(Ok(()), SeedChoice::check).map_err(|reason| format!("Monte Carlo: {reason}"))?;
        tuning
            .as_ref()
            .map_or(Ok(()), |tuning| tuning.check(scenario))
            .map_err(|reason| format!("Tune for me: {reason}"))
    }

    /// These choices; those that are `None` come from `others`.
    pub(crate) fn or(self, others: Self) -> Self {
        let Self { map, seeds, tuning, posterior, trials } = self;
        Self {
            map: map.or(others.map),
            seeds: seeds.or(others.seeds),
            tuning: tuning.or(others.tuning),
            posterior: posterior.or(others.posterior),
            trials,
        }
    }
}

impl Laboratory {
    /// The choices of all views.
    pub fn choices(&self) -> Choices {
        Choices {
            map: self.choice().cloned(),
            seeds: Some(*self.seeds().choice()),
            tuning: self.tuning().chosen().cloned(),
            posterior: self.posteriors().chosen(),
            trials: self.trials().rows().to_vec(),
        }
    }

    /// Takes over the choices of all views, and adds the trials.
    pub fn restore(&mut self, Choices { map, seeds, tuning, posterior, trials }: Choices) {
        self.choose(map);
        self.seeds_mut().choose(seeds.unwrap_or_default());
        self.tuning_mut().choose(tuning);
        self.posteriors_mut().choose(posterior);
        // Results of a user are never replaced by those of another file or link.
        self.trials_mut().add(trials);
    }
}
