//! What is wrong with an equation, and where.

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
    pub(super) fn new(what: impl Into<String>) -> Self {
        Self { what: what.into(), place: None }
    }

    pub(super) fn at(place: usize, what: impl Into<String>) -> Self {
        Self { what: what.into(), place: Some((place, String::new())) }
    }

    /// The same with its equation.
    pub(super) fn within(mut self, text: &str) -> Self {
        if let Some((_, whole)) = &mut self.place {
            text.clone_into(whole);
        }
        self
    }

    /// The equation with a mark before the character.
    fn pointed(&self) -> String {
        let Some((place, text)) = &self.place else { return String::new() };
        let before: String = text.chars().take(*place).collect();
        let after: String = text.chars().skip(*place).collect();
        format!(", at character {} (▶): {before}▶{after}", place + 1)
    }
}
