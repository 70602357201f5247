//! Normal distributions over states, and their square roots.

use nalgebra::{SMatrix, SVector};

use crate::FilterError;

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
        // A sum is finite only if all its terms are, short of an overflow, which is as bad.
        (self.mean.sum() + self.cov.sum()).is_finite()
    }
}

/// The lower triangular `L` with `L Lᵀ = cov`, zero above the diagonal. A variance that is zero to rounding gives a column of
/// zeros, so that a component known for certain stays so.
///
/// # Errors
/// [`FilterError::IndefiniteCovariance`] where a pivot is negative beyond rounding or not a number.
///
/// Source: Golub and Van Loan (2013), *Matrix Computations*, section 4.2.8 (semidefinite systems).
pub fn lower_root<const N: usize>(cov: &Matrix<N, N>) -> Result<Matrix<N, N>, FilterError> {
    let mut root = Matrix::<N, N>::zeros();
    for j in 0..N {
        let mut pivot = cov[(j, j)];
        for k in 0..j {
            pivot -= root[(j, k)] * root[(j, k)];
        }
        let rounding = 4.0 * N as f64 * f64::EPSILON * cov[(j, j)];
        if pivot > rounding {
            let diagonal = pivot.sqrt();
            let inverse = 1.0 / diagonal;
            root[(j, j)] = diagonal;
            for i in j + 1..N {
                let mut entry = cov[(i, j)];
                for k in 0..j {
                    entry -= root[(i, k)] * root[(j, k)];
                }
                root[(i, j)] = entry * inverse;
            }
        } else if pivot < -1e4 * rounding || pivot.is_nan() {
            return Err(FilterError::IndefiniteCovariance);
        }
    }
    Ok(root)
}

/// The symmetric part `(X + Xᵀ) / 2`: what rounding has made of a covariance, symmetric to the last bit again.
#[inline]
pub(crate) fn symmetric<const N: usize>(matrix: &Matrix<N, N>) -> Matrix<N, N> {
    (matrix + matrix.transpose()) * 0.5
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_root_squares_to_the_covariance() {
        let a = Matrix::<4, 4>::from_fn(|i, j| libm::sin(1.0 + (3 * i + 5 * j * j) as f64));
        let cov = a * a.transpose();
        let root = lower_root(&cov).unwrap();
        assert!((root * root.transpose() - cov).amax() < 1e-14);
        assert_eq!(root.upper_triangle(), Matrix::<4, 4>::from_diagonal(&root.diagonal()));
    }

    #[test]
    fn a_zero_variance_gives_a_zero_column() {
        let cov = Matrix::<3, 3>::new(4.0, 0.0, 2.0, 0.0, 0.0, 0.0, 2.0, 0.0, 5.0);
        let root = lower_root(&cov).unwrap();
        assert_eq!(root.column(1), Matrix::<3, 1>::zeros());
        assert!((root * root.transpose() - cov).amax() < 1e-15);
    }

    #[test]
    fn a_rank_one_covariance_has_a_root() {
        let v = Vector::<3>::new(1.0, -2.0, 0.3);
        let cov = v * v.transpose();
        let root = lower_root(&cov).unwrap();
        assert!((root * root.transpose() - cov).amax() < 1e-14);
    }

    #[test]
    fn an_indefinite_or_undefined_covariance_is_refused() {
        let indefinite = Matrix::<2, 2>::new(1.0, 2.0, 2.0, 1.0);
        assert_eq!(lower_root(&indefinite), Err(FilterError::IndefiniteCovariance));
        let undefined = Matrix::<2, 2>::new(f64::NAN, 0.0, 0.0, 1.0);
        assert_eq!(lower_root(&undefined), Err(FilterError::IndefiniteCovariance));
    }
}
