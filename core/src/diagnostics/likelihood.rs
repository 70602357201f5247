//! How likely all measurements were to a filter.

use super::Total;
use crate::likelihood::{LogSum, log_likelihood};
use crate::{Estimates, FilterKind};

/// The log likelihood of all measurements.
#[derive(Clone, Copy, Debug)]
pub(super) enum Likelihood {
    /// Of Gaussian beliefs, which needs the NIS besides.
    Gaussian { ln_determinants: LogSum },
    /// Of a particle filter, whose own it is.
    Particles { sum: f64 },
}

impl Default for Likelihood {
    fn default() -> Self {
        Self::Gaussian { ln_determinants: LogSum::ZERO }
    }
}

impl Likelihood {
    /// The likelihood of no measurement, of a filter of this kind.
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

    /// The sum of all, whose NIS come to `nis`.
    pub(super) fn value(self, nis: Total) -> f64 {
        match self {
            Self::Gaussian { .. } if nis.degrees == 0 => 0.0,
            Self::Gaussian { ln_determinants } => log_likelihood(nis.sum, ln_determinants.value(), nis.degrees),
            Self::Particles { sum } => sum,
        }
    }
}
