//! Normal distributions over states, and their square roots.

mod factor;
mod root;

use nalgebra::{SMatrix, SVector};

pub(crate) use factor::Factor;
pub(crate) use root::lower_root;

/// A column of numbers.
pub type Vector<const N: usize> = SVector<f64, N>;
/// A rectangle of numbers.
pub type Matrix<const R: usize, const C: usize> = SMatrix<f64, R, C>;

/// A normal distribution over N components.
#[derive(Clone, Debug, PartialEq)]
pub struct Gaussian<const N: usize> {
    /// Mean.
    pub mean: Vector<N>,
    /// Covariance, symmetric to the last bit.
    pub cov: Matrix<N, N>,
}

impl<const N: usize> Gaussian<N> {
    /// Independent components with the given standard deviations.
    pub fn independent(mean: Vector<N>, std: &Vector<N>) -> Self {
        Self { mean, cov: Matrix::from_diagonal(&std.map(|s| s * s)) }
    }

    /// Whether every number of it is finite.
    pub fn is_finite(&self) -> bool {
        // A sum is finite only if all its terms are. A sum that overflows counts as not finite too.
        let mut sum = self.mean;
        for j in 0..N {
            sum += self.cov.column(j);
        }
        sum.sum().is_finite()
    }

    /// Whether a variance is below zero.
    #[inline]
    pub(crate) fn has_negative_variance(&self) -> bool {
        (0..N).any(|i| self.cov[(i, i)] < 0.0)
    }
}

#[inline]
fn with_inverse(pivot: f64) -> (f64, f64) {
    (pivot, 1.0 / pivot)
}

/// The pivot that follows the one in column `j`, and its inverse, from the determinant of both. It does not need the
/// inverse of the first, so that two divisions take the time of one. `None` if there is no next column, or if the
/// determinant is not positive or leaves the range of numbers.
#[inline]
fn next_pivot<const N: usize>(columns: &Matrix<N, N>, j: usize, pivot: f64, inverse: f64) -> Option<(f64, f64)> {
    if j + 1 == N {
        return None;
    }
    let across = columns[(j + 1, j)];
    let determinant = pivot * columns[(j + 1, j + 1)] - across * across;
    let in_range = (f64::MIN_POSITIVE..=f64::MAX).contains(&determinant);
    in_range.then(|| (determinant * inverse, pivot / determinant))
}

/// A covariance that is symmetric to the last bit: the lower triangle, mirrored. Rounding makes the triangles differ.
#[inline]
pub(crate) fn mirrored<const N: usize>(mut matrix: Matrix<N, N>) -> Matrix<N, N> {
    for j in 1..N {
        for i in 0..j {
            matrix[(i, j)] = matrix[(j, i)];
        }
    }
    matrix
}

/// `X - A Bᵀ`, column by column so that the compiler can use vector instructions.
#[inline]
pub(crate) fn minus_product<const N: usize, const M: usize, const R: usize>(
    mut x: Matrix<R, N>,
    a: &Matrix<R, M>,
    b: &Matrix<N, M>,
) -> Matrix<R, N> {
    for j in 0..N {
        for k in 0..M {
            let share = b[(j, k)];
            for i in 0..R {
                x[(i, j)] -= a[(i, k)] * share;
            }
        }
    }
    x
}
