//! An equation of motion as a scenario's plant.

use super::Scenario;
use crate::mathematics::equation::{EquationError, EquationSettings};
use crate::{Channel, PlantKind};

impl Scenario {
    /// Makes an equation the truth's plant. Filters begin with its guesses, if these differ from the earlier ones.
    ///
    /// # Errors
    /// [`EquationError`] if it is no plant; nothing changes then.
    pub fn set_equation(&mut self, settings: &EquationSettings) -> Result<(), EquationError> {
        let kind = PlantKind::of_equation(settings)?;
        let before = self.plant.kind.channels();
        self.set_plant(kind);
        for &channel in kind.channels() {
            let Some(old) = before.iter().find(|old| **old == channel).map(|old| old.usual()) else { continue };
            let new = channel.usual();
            for filter in &mut self.filters {
                if old.mean != new.mean {
                    filter.initial_mean[channel] = new.mean;
                }
                if old.std != new.std {
                    filter.initial_std[channel] = new.std;
                }
            }
        }
        Ok(())
    }

    /// A sentence about the names in the truth's equation that become parameters although neither `parameters` nor a
    /// value names them, with their guesses. `None` if there are none.
    pub fn assumed_parameters(&self) -> Option<String> {
        let settings = self.plant.kind.own_equation()?.settings();
        let is_named = |channel: Channel| settings.parameter(channel.key()).is_some() || self.plant.has_own(channel);
        let symbols = settings.symbols().ok()?;
        let is_own = |channel: &Channel| {
            symbols.iter().any(|one| one.is_parameter && one.known.is_none() && one.key == channel.key())
        };
        let guess = |channel: Channel| {
            let first = self.filters.iter().find(|filter| filter.plant.is_none());
            first.map_or(channel.usual().mean, |filter| filter.initial_mean[channel])
        };
        let assumed = self.plant.kind.parameters().filter(|channel| is_own(channel) && !is_named(*channel));
        let told: Vec<String> =
            assumed.map(|channel| format!("{} (guess {})", channel.symbol(), guess(channel))).collect();
        let (last, others) = told.split_last()?;
        let all = if others.is_empty() { last.clone() } else { format!("{} and {last}", others.join(", ")) };
        let is = if others.is_empty() { "is taken for a parameter" } else { "are taken for parameters" };
        Some(format!("of the equation, {all} {is}: `parameters` can say name, unit, guess and range"))
    }
}
