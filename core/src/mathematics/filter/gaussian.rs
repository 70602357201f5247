//! Normal distributions over states.

use super::FilterError;
use crate::mathematics::linalg::{Matrix, Vector};

/// A normal distribution over n components.
#[derive(Clone, Debug, PartialEq)]
pub struct Gaussian {
    /// Mean, n numbers.
    pub mean: Vector,
    /// Covariance, n × n, symmetric to the last bit.
    pub cov: Matrix,
}

impl Gaussian {
    /// Independent components with the given standard deviations.
    pub fn independent(mean: Vector, std: &Vector) -> Self {
        Self { mean, cov: Matrix::from_diagonal(&std.map(|s| s * s)) }
    }

    /// Makes it a copy of another one, in its own memory.
    pub fn copy_from(&mut self, other: &Self) {
        self.mean.clone_from(&other.mean);
        self.cov.clone_from(&other.cov);
    }

    /// n, the number of components.
    pub fn size(&self) -> usize {
        self.mean.len()
    }

    /// Whether every number of it is finite.
    pub fn is_finite(&self) -> bool {
        // A sum is finite only if all its terms are; a sum that overflows counts as not finite too. Four independent
        // sums, for speed.
        let mut sums = [self.mean.sum(), 0.0, 0.0, 0.0];
        let entries = self.cov.as_slice().chunks_exact(4);
        entries.remainder().iter().for_each(|entry| sums[0] += entry);
        entries.for_each(|four| sums.iter_mut().zip(four).for_each(|(sum, entry)| *sum += entry));
        sums.iter().sum::<f64>().is_finite()
    }

    /// Checks that the numbers are those of a valid belief.
    ///
    /// # Errors
    /// [`FilterError::NotFinite`] and, where a variance is below zero, [`FilterError::IndefiniteCovariance`].
    pub fn check(&self) -> Result<(), FilterError> {
        if !self.is_finite() {
            return Err(FilterError::NotFinite);
        }
        if (0..self.size()).any(|i| self.cov[(i, i)] < 0.0) {
            return Err(FilterError::IndefiniteCovariance);
        }
        Ok(())
    }
}
