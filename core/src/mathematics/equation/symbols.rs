//! The names of an equation, and their meanings.

use super::error::EquationError;
use super::own::of_all_plants;
use super::settings::EquationSettings;
use super::solve::{Component, solve};
use super::word::symbol;
use crate::Channel;

/// A name of an equation that is neither a displacement nor the force.
#[derive(Clone, Debug, PartialEq)]
pub struct Symbol {
    /// The key in files.
    pub key: String,
    /// The name as it is shown.
    pub shown: String,
    /// Whether it is a parameter; an internal state if not.
    pub is_parameter: bool,
    /// The channel of built-in plants that it means; its numbers are those of all plants.
    pub known: Option<Channel>,
}

impl EquationSettings {
    /// The internal states and the parameters of the equation, in the order of its state.
    ///
    /// # Errors
    /// [`EquationError`] where the text is no equation.
    pub fn symbols(&self) -> Result<Vec<Symbol>, EquationError> {
        let of = |component| {
            let (key, is_parameter) = match component {
                Component::Internal(key) => (key, false),
                Component::Parameter(key) => (key, true),
                Component::Displacement(_) | Component::Velocity(_) => return None,
            };
            Some(Symbol { shown: symbol(&key), known: of_all_plants(&key), key, is_parameter })
        };
        Ok(solve(&self.equation)?.components.into_iter().filter_map(of).collect())
    }
}
