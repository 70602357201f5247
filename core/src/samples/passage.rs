//! A filter on its way forward, and its way back: the modified Bryson-Frazier smoother runs the adjoint of the filter backward.
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

use crate::Stop;
use crate::mathematics::engine::belief::Belief;
use crate::mathematics::engine::passage;
use crate::mathematics::filter::{FilterError, Gaussian, kalman};
use crate::mathematics::linalg::{Ldl, Matrix, Vector, symmetric};

/// The passages of a filter from one sample to the next, and its belief there.
#[derive(Default)]
pub struct Passages {
    pub(crate) belief: Option<Gaussian>,
    /// Each part of the step that ends with a reading, and its last one.
    pub(crate) all: Vec<Passage>,
    pub(crate) stop: Option<Stop>,
}

impl Passages {
    pub(crate) fn begin(&mut self, belief: &Belief<f64>) {
        self.belief = Some(Gaussian::of(belief));
    }

    pub(crate) fn add(&mut self, passage: &passage::Passage<f64>, belief: &Belief<f64>) -> Result<(), FilterError> {
        self.all.push(Passage::new(passage)?);
        self.begin(belief);
        Ok(())
    }
}

#[derive(Clone, Debug)]
pub(crate) struct Passage {
    /// Φ, n × n.
    pub(crate) transition: Matrix,
    /// The update at the latter sample. `None` if nothing was measured.
    pub(crate) update: Option<Update>,
}

#[derive(Clone, Debug)]
pub(crate) struct Update {
    /// `I - K H`, n × n.
    pub(crate) kept: Matrix,
    /// `Hᵀ S⁻¹ H`, n × n.
    pub(crate) information: Matrix,
    /// `Hᵀ S⁻¹ e`, n numbers.
    pub(crate) score: Vector,
}

impl Passage {
    fn new(of: &passage::Passage<f64>) -> Result<Self, FilterError> {
        let (n, m) = (of.predicted.len().isqrt(), of.innovation.len());
        let update = if m > 0 { Some(Update::new(of, n, m)?) } else { None };
        Ok(Self { transition: Matrix::from_column_slice(n, n, &of.transition), update })
    }
}

impl Update {
    fn new(of: &passage::Passage<f64>, n: usize, m: usize) -> Result<Self, FilterError> {
        let innovation_cov = symmetric(Matrix::from_column_slice(m, m, &of.innovation_cov));
        let gain = Matrix::from_column_slice(n, m, &of.gain);
        let transposed = if of.jacobian.is_empty() {
            let predicted = symmetric(Matrix::from_column_slice(n, n, &of.predicted));
            Ldl::semidefinite(&predicted).divide(&(&innovation_cov * gain.transpose())).transpose()
        } else {
            Matrix::from_column_slice(m, n, &of.jacobian).transpose()
        };
        let weighted = kalman::factor(&innovation_cov)?.divide(&transposed);
        Ok(Self {
            kept: Matrix::identity(n, n) - gain * transposed.transpose(),
            information: &weighted * transposed.transpose(),
            score: weighted * Vector::from_column_slice(&of.innovation),
        })
    }
}

/// The information in all later measurements about a state: `λ`, n numbers, and `Λ`, n × n.
pub(crate) struct Adjoint {
    pub(crate) score: Vector,
    pub(crate) information: Matrix,
}

impl Adjoint {
    pub(crate) fn nothing(n: usize) -> Self {
        Self { score: Vector::zeros(n), information: Matrix::zeros(n, n) }
    }

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
pub(crate) fn congruence(x: &mut Matrix, a: &Matrix) {
    *x = symmetric(a.tr_mul(&(&*x * a)));
}
