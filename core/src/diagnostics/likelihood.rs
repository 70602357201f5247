//! The likelihood of all measurements under a filter's beliefs.

use super::Total;
use crate::gaussian_likelihood::log_likelihood;
use crate::log_sum::LogSum;
use crate::{Estimates, FilterKind};

/// The log likelihood of all measurements.
#[derive(Clone, Copy, Debug)]
pub(super) enum Likelihood {
    /// Of Gaussian beliefs: the value needs the sum of the NIS as well.
    Gaussian { ln_determinants: LogSum },
    /// Of a particle filter, which reports its own log likelihood.
    Particles { sum: f64 },
}

impl Default for Likelihood {
    fn default() -> Self {
        Self::Gaussian { ln_determinants: LogSum::ZERO }
    }
}

impl Likelihood {
    /// The likelihood of no measurements, for a filter of this kind.
    pub(super) fn new(kind: FilterKind) -> Self {
        if kind.has_own_likelihood() { Self::Particles { sum: 0.0 } } else { Self::default() }
    }

    /// Takes in sample `k`.
    #[inline]
    pub(super) fn push(&mut self, estimates: &Estimates, k: usize) {
        let determinant = estimates.determinant()[k];
        if determinant.is_nan() {
            return;
        }
        match self {
            Self::Gaussian { ln_determinants } => ln_determinants.add(determinant, || estimates.ln_determinant(k)),
            Self::Particles { sum } => *sum += estimates.log_likelihood(k),
        }
    }

    /// The sum over all samples; `nis` is the sum of their NIS.
    pub(super) fn value(self, nis: Total) -> f64 {
        match self {
            Self::Gaussian { .. } if nis.degrees == 0 => 0.0,
            Self::Gaussian { ln_determinants } => log_likelihood(nis.sum, ln_determinants.value(), nis.degrees),
            Self::Particles { sum } => sum,
        }
    }
}
