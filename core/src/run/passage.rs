//! The passages of a filter on its way forward, and the adjoint that passes them backward.

use kalmanscope_filters::Stop;
use kalmanscope_filters::engine::belief::GaussianBelief;
use kalmanscope_filters::engine::passage;
use kalmanscope_filters::filter::{FilterError, Gaussian, kalman};
use kalmanscope_filters::linalg::{Ldl, Matrix, Vector, symmetric};

/// The passages of a filter from one sample to the next, and its belief there.
#[derive(Default)]
pub struct Passages {
    pub(crate) belief: Option<Gaussian>,
    pub(crate) all: Vec<Passage>,
    pub(crate) stop: Option<Stop>,
}

impl Passages {
    pub(crate) fn begin(&mut self, belief: &GaussianBelief<f64>) {
        self.belief = Some(Gaussian::of(belief));
    }
}

pub(crate) struct Passage {
    /// Φ, n × n.
    pub transition: Matrix,
    /// The update at the latter sample. `None` if nothing was measured.
    pub(crate) update: Option<PassageUpdate>,
}

pub(crate) struct PassageUpdate {
    /// `I - K H`, n × n.
    pub(crate) kept: Matrix,
    /// `Hᵀ S⁻¹ H`, n × n.
    pub(crate) information: Matrix,
    /// `Hᵀ S⁻¹ e`, n numbers.
    pub(crate) score: Vector,
}

impl Passage {
    pub(crate) fn new(of: &passage::Passage<f64>) -> Result<Self, FilterError> {
        let (n, m) = (of.predicted.len().isqrt(), of.innovation.len());
        let transition = Matrix::from_column_slice(n, n, &of.transition);
        if m == 0 {
            return Ok(Self { transition, update: None });
        }
        let innovation_cov = symmetric(Matrix::from_column_slice(m, m, &of.innovation_cov));
        let gain = Matrix::from_column_slice(n, m, &of.gain);
        let transposed = if of.jacobian.is_empty() {
            let predicted = symmetric(Matrix::from_column_slice(n, n, &of.predicted));
            Ldl::semidefinite(&predicted).divide(&(&innovation_cov * gain.transpose())).transpose()
        } else {
            Matrix::from_column_slice(m, n, &of.jacobian).transpose()
        };
        let weighted = kalman::factor(&innovation_cov)?.divide(&transposed);
        let kept = Matrix::identity(n, n) - gain * transposed.transpose();
        let information = &weighted * transposed.transpose();
        let score = weighted * Vector::from_column_slice(&of.innovation);
        Ok(Self { transition, update: Some(PassageUpdate { kept, information, score }) })
    }
}

pub(crate) struct Adjoint {
    pub(crate) score: Vector,
    pub(crate) information: Matrix,
}

impl Adjoint {
    pub(crate) fn nothing(n: usize) -> Self {
        Self { score: Vector::zeros(n), information: Matrix::zeros(n, n) }
    }

    pub(crate) fn correct(&self, Gaussian { mean, cov }: &mut Gaussian) {
        *mean -= &*cov * &self.score;
        let mut less = self.information.clone();
        congruence(&mut less, cov);
        *cov -= less;
        for i in 0..cov.nrows() {
            // Zero up to rounding.
            cov[(i, i)] = cov[(i, i)].max(0.0);
        }
    }

    pub(crate) fn pass(&mut self, Passage { transition, update }: &Passage) {
        let Self { score, information } = self;
        if let Some(PassageUpdate { kept, information: gained, score: gradient }) = update {
            *score = kept.tr_mul(score) - gradient;
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
