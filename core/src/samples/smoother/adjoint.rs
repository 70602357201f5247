//! The modified Bryson-Frazier smoother: it runs the adjoint of the filter backward.
//!
//! ```text
//! Λ̂ₖ = Φᵀ Λ̃ₖ₊₁ Φ,                          λ̂ₖ = Φᵀ λ̃ₖ₊₁,  both zero at the last sample
//! Λ̃ₖ = Hᵀ S⁻¹ H + (I - K H)ᵀ Λ̂ₖ (I - K H),  λ̃ₖ = (I - K H)ᵀ λ̂ₖ - Hᵀ S⁻¹ e
//! Pₖˢ = Pₖ - Pₖ Λ̂ₖ Pₖ,                       yₖˢ = yₖ - Pₖ λ̂ₖ
//! ```
//!
//! In exact arithmetic it is the smoother of Rauch, Tung and Striebel, `G = Pₖ Φᵀ (P⁻ₖ₊₁)⁻¹`. But that one divides by a
//! covariance, which becomes singular where a motion dies out and has no process noise: G then grows as the motion
//! decays, so that the rounding of later samples grows backward until it is as large as the result. The adjoint decays
//! backward as the motion does forward, and needs no inverse but that of S.
//!
//! Φ and H are those that the filter linearises with. Those of sigma points are regressions on the state, of the next
//! state and of the readings: with them `cov(next, now) = Φ P` and `K S = P⁻ Hᵀ`, which is all that both smoothers
//! need. For an update without an H, division by P⁻ gives it; directions that P⁻ has lost are left out.
//!
//! Fading counts as process noise here: `P⁻ = λ Φ P Φᵀ + Q` is a step with the noise `(λ - 1) Φ P Φᵀ + Q`. So does what a
//! jump ([`crate::mathematics::filter::jump`]) adds to P⁻.
//!
//! Source: Bierman (1973), Fixed interval smoothing with discrete measurements; Rauch, Tung and Striebel (1965), Maximum
//! likelihood estimates of linear dynamic systems; Särkkä (2008), Unscented Rauch-Tung-Striebel smoother.

use super::forward::{Passage, Update};
use crate::mathematics::filter::Gaussian;
use crate::mathematics::linalg::{Matrix, Vector, symmetric};

/// The information in all later measurements about a state: `λ`, n numbers, and `Λ`, n × n.
pub(crate) struct Adjoint {
    pub(super) score: Vector,
    pub(super) information: Matrix,
}

impl Adjoint {
    /// No later measurement, about a state of n components.
    pub(crate) fn nothing(n: usize) -> Self {
        Self { score: Vector::zeros(n), information: Matrix::zeros(n, n) }
    }

    /// Adds what it knows to the belief of a filter.
    pub(crate) fn tell(&self, Gaussian { mean, cov }: &mut Gaussian) {
        *mean -= &*cov * &self.score;
        let mut told = self.information.clone();
        congruence(&mut told, cov);
        *cov -= told;
        for i in 0..cov.nrows() {
            // Zero up to rounding.
            cov[(i, i)] = cov[(i, i)].max(0.0);
        }
    }

    /// Goes back over an update, then over the step before it.
    pub(crate) fn pass(&mut self, Passage { transition, update }: &Passage) {
        let Self { score, information } = self;
        if let Some(Update { kept, information: gained, score: told }) = update {
            *score = kept.tr_mul(score) - told;
            congruence(information, kept);
            *information += gained;
        }
        *score = transition.tr_mul(score);
        congruence(information, transition);
    }
}

/// Replaces the symmetric X by `Aᵀ X A`.
pub(super) fn congruence(x: &mut Matrix, a: &Matrix) {
    *x = symmetric(a.tr_mul(&(&*x * a)));
}
