//! The ways in which a linearising filter moves.

use serde::{Deserialize, Serialize};

/// The motion of a linearising filter's mean, and the transition matrix of its covariance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Propagation {
    /// `y⁻ = y + dt φ₁(A dt) g(y, f)` and `Φ = exp(A dt)`: exact where the parameters are known and the plant is linear.
    LocalLinearisation,
    /// One classical Runge-Kutta step, and its derivative.
    RungeKutta,
    /// `y⁻ = y + dt g(y, f)` and `Φ = I + A dt`: the textbooks' first example, and unstable for a long dt.
    Euler,
}

impl Propagation {
    /// Every way.
    pub const ALL: [Self; 3] = [Self::LocalLinearisation, Self::RungeKutta, Self::Euler];
}
