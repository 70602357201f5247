//! The update of the iterated EKF: a Gauss-Newton descent to the most probable state.
//!
//! ```text
//! yᵢ₊₁ = y⁻ + Kᵢ (z - h(yᵢ) - Hᵢ (y⁻ - yᵢ)),  y₀ = y⁻
//! ```
//!
//! Innovation, S, NIS and likelihood that are reported are those of the first step, at y⁻; gain and covariance are those of the last.
//!
//! Source: Huang and Yuen (2023), *Bayesian Real-Time System Identification*; Gelb, ed. (1974), *Applied Optimal Estimation*, section
//! 6.1; Bell and Cathey (1993), The iterated Kalman filter update as a Gauss-Newton method.

use super::belief::Belief;
use super::number::{Mask, Number};

/// The step of an iteration counts as none when it is this small, squared, against the variance.
const CONVERGED: f64 = 1e-12;

/// Memory of a descent.
#[derive(Clone, Debug)]
pub(super) struct Descent<T> {
    /// The belief before the update.
    pub(super) prior: Belief<T>,
    /// The state in which the sensors are linearised.
    pub(super) at: Vec<T>,
    /// Innovation, S and the factor of S of the first step.
    pub(super) first: [Vec<T>; 3],
}

impl<T: Number> Descent<T> {
    /// Memory for n components.
    pub(super) fn new(n: usize) -> Self {
        let zeros = |count: usize| vec![T::of(0.0); count];
        let prior = Belief { mean: zeros(n), cov: zeros(n * n) };
        Self { prior, at: zeros(n), first: [const { Vec::new() }; 3] }
    }

    /// Begins the next step, at the result of the last.
    pub(super) fn linearise_again(&mut self, belief: &mut Belief<T>) {
        self.at.copy_from_slice(&belief.mean);
        belief.copy_from(&self.prior);
    }

    /// Whether no component has moved by more than 1e-6 of its standard deviation.
    pub(super) fn has_converged(&self, belief: &Belief<T>) -> bool {
        let n = belief.size();
        (0..n).all(|i| {
            let moved = belief.mean[i] - self.at[i];
            (moved * moved).le(belief.cov[i * (n + 1)] * CONVERGED).all()
        })
    }
}
