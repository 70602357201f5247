//! The likelihood of all measurements under a filter's beliefs.

use super::Total;
use crate::FilterKind;
use crate::mathematics::gaussian_likelihood::LogSum;
use crate::mathematics::gaussian_likelihood::log_likelihood;

/// The log likelihood of all measurements.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Likelihood {
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
    pub(crate) fn new(kind: FilterKind) -> Self {
        if kind.has_own_likelihood() { Self::Particles { sum: 0.0 } } else { Self::default() }
    }

    /// Takes in a sample: det S, NaN where nothing was measured, with its logarithm, and the log likelihood of particles.
    #[inline]
    pub(crate) fn push(&mut self, determinant: f64, ln: impl FnOnce() -> f64, own: impl FnOnce() -> f64) {
        match self {
            _ if determinant.is_nan() => {}
            Self::Gaussian { ln_determinants } => ln_determinants.add(determinant, ln),
            Self::Particles { sum } => *sum += own(),
        }
    }

    /// The sum over all samples; `nis` is the sum of their NIS.
    pub(crate) fn value(self, nis: Total) -> f64 {
        match self {
            Self::Gaussian { .. } if nis.degrees == 0 => 0.0,
            Self::Gaussian { ln_determinants } => log_likelihood(nis.sum, ln_determinants.value(), nis.degrees),
            Self::Particles { sum } => sum,
        }
    }
}
