//! Equations of motion that a user types, as plants.
//!
//! ```text
//! text ──tokens──▶ trees ──solve──▶ a list of operations for the rates ──derivatives──▶ one for A = ∂g/∂y
//! ```
//!
//! `x'' + 2 ζ ωₙ x' + ωₙ² x + μ x³ = f`: masses are `x`, or `x1`, `x2`, …; a component that moves with one prime (`z' = …`) is an
//! internal state; `f` is the force over mass; every other name is a parameter. Several equations are apart by `;`.

mod own;
mod parse;
mod plant_kind;
mod settings;
mod solve;
mod token;
mod typeset;
mod word;
pub use own::{Equation, Symbol};
pub(crate) use plant_kind::{channels, is_read};
pub use settings::{AllowedSign, EquationSettings, Numbers, ParameterSettings};
pub use typeset::{Level, TextRun, typeset};

/// An equation that cannot be a plant.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{what}{}", self.pointed())]
pub struct EquationError {
    /// The fault, and what is allowed.
    pub what: String,
    /// The place of the faulty character, counted from 0, and the equation. `None` if the fault is in the whole
    /// equation.
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
