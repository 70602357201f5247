//! Equations of motion that a user types, as plants.
//!
//! ```text
//! text ──tokens──▶ trees ──solve──▶ a list of operations for the rates ──derivatives──▶ one for A = ∂g/∂y
//! ```
//!
//! `x'' + 2 ζ ωₙ x' + ωₙ² x + μ x³ = f`: masses are `x`, or `x1`, `x2`, …; a component that moves with one prime (`z' = …`) is an
//! internal state; `f` is the force over mass; every other name is a parameter. Several equations are apart by `;`.

mod error;
mod interned;
mod own;
mod parse;
mod plant_kind;
mod settings;
mod solve;
mod symbols;
mod token;
mod typeset;
mod word;

pub use error::EquationError;
pub(crate) use interned::{channels, is_read};
pub use own::Equation;
pub use settings::{AllowedSign, EquationSettings, Numbers, ParameterSettings};
pub use symbols::Symbol;
pub use typeset::{Level, TextRun, typeset};
