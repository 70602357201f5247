//! Equations of motion that a user types, as plants.
//!
//! ```text
//! text ──tokens──▶ trees ──solve──▶ a list of operations for the rates ──derivatives──▶ one for A = ∂g/∂y
//! ```
//!
//! `x'' + 2 ζ ωₙ x' + ωₙ² x + μ x³ = f`: masses are `x`, or `x1`, `x2`, …; a component that moves with one prime (`z' = …`) is an
//! internal state; `f` is the force over mass; every other name is a parameter. Several equations are apart by `;`.

mod own_equation;
mod parse;
mod solve;
mod token;
pub(crate) mod typed;
mod typeset;

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use kalmanscope_filters::channel::Sign;
use kalmanscope_records::document::is_default;

pub(crate) use own_equation::RESERVED;
pub use own_equation::{Equation, Symbol};
use solve::solve;
use token::key;
pub use typeset::{TextLevel, TextRun, typeset};

/// An equation that cannot be a plant.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{what}{}", self.pointed())]
pub struct EquationError {
    /// The fault, and what is allowed.
    pub what: String,
    /// The place of the faulty character, from 0 on, and the equation. `None` if the fault is in all of it.
    pub place: Option<(usize, String)>,
}

impl EquationError {
    fn new(what: impl Into<String>) -> Self {
        Self { what: what.into(), place: None }
    }

    fn at(place: usize, what: impl Into<String>) -> Self {
        Self { what: what.into(), place: Some((place, String::new())) }
    }

    fn within(mut self, text: &str) -> Self {
        if let Some((_, whole)) = &mut self.place {
            text.clone_into(whole);
        }
        self
    }

    fn pointed(&self) -> String {
        let Some((place, text)) = &self.place else { return String::new() };
        let before: String = text.chars().take(*place).collect();
        let after: String = text.chars().skip(*place).collect();
        format!(", at character {} (▶): {before}▶{after}", place + 1)
    }
}

/// An equation of motion and its parameters.
///
/// ```toml
/// plant = { equation = "x'' + c x' + k x = f", k = 30.0, parameters = { k = { unit = "1/s²", guess = 36.0 } } }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub struct EquationSettings {
    /// The equation; `;` separates several.
    pub equation: String,
    /// Names, units and usual numbers of parameters and internal states by their symbols, and the unit of the state `x`; others are usual.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub parameters: BTreeMap<String, ParameterSettings>,
}

/// A parameter of an equation, or an internal state.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, expecting = "a table")]
pub struct ParameterSettings {
    /// The name in running text; `parameter` or `internal state` and the symbol if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The unit, empty for a pure number.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub unit: String,
    /// The usual guess: 1 for a parameter, 0 for an internal state if left out. The truth's usual value is the same.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub guess: Option<f64>,
    /// The standard deviation of a guess; half of it, or 1 for a guess of 0, if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub std: Option<f64>,
    /// Limits of a slider; from 0 or from minus to plus five guesses if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range: Option<[f64; 2]>,
    /// The allowed sign.
    #[serde(skip_serializing_if = "is_default")]
    pub sign: Sign,
}

/// The numbers of a parameter or an internal state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Numbers {
    /// The guess.
    pub mean: f64,
    /// The standard deviation of the guess.
    pub std: f64,
    /// The limits of the slider.
    pub range: [f64; 2],
}

impl ParameterSettings {
    /// The numbers, with the usual ones in place of missing ones.
    pub fn numbers(&self, is_parameter: bool) -> Numbers {
        let mean = self.guess.unwrap_or(if is_parameter { 1.0 } else { 0.0 });
        let size = size(mean);
        let low = if self.sign == Sign::Any { -5.0 * size } else { 0.0 };
        Numbers { mean, std: self.std.unwrap_or(0.5 * size), range: self.range.unwrap_or([low, 5.0 * size]) }
    }
}

fn size(mean: f64) -> f64 {
    if mean == 0.0 { 1.0 } else { mean.abs() }
}

impl EquationSettings {
    /// An equation with the usual numbers for its parameters.
    pub fn new(equation: impl Into<String>) -> Self {
        Self { equation: equation.into(), parameters: BTreeMap::new() }
    }

    /// The settings of a parameter or an internal state by its key, if there are some.
    pub fn parameter(&self, of: &str) -> Option<&ParameterSettings> {
        self.parameters.iter().find(|(name, _)| key(name) == of).map(|(_, one)| one)
    }

    /// The same, mutable; inserts the usual ones if there are none.
    pub fn parameter_mut(&mut self, of: &str) -> &mut ParameterSettings {
        let name = self.parameters.keys().find(|name| key(name) == of).cloned();
        self.parameters.entry(name.unwrap_or_else(|| of.to_owned())).or_default()
    }

    /// The same without the numbers of parameters that the equation does not have.
    ///
    /// # Errors
    /// [`EquationError`] if the text is not an equation.
    pub fn checked(&self) -> Result<Self, EquationError> {
        let components = solve(&self.equation)?.components;
        let mut checked = self.clone();
        checked.parameters.retain(|name, _| name == "x" || components.iter().any(|one| one.key() == Some(&key(name))));
        Ok(checked)
    }
}
