//! Lower triangular roots of covariances.

use thiserror::Error;

use super::Matrix;
use crate::mathematics::engine::columns::{self, Rooted};
use crate::mathematics::engine::level::Baseline;

/// Why a symmetric matrix has no root.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum RootError {
    /// A number of it is infinite or undefined.
    #[error("the matrix has an entry that is not a finite number")]
    NotFinite,
    /// It is negative in some direction, by more than rounding explains.
    #[error("the matrix is not positive semidefinite")]
    Indefinite,
}

/// The lower triangular `L` with `L Lᵀ = S` for a symmetric n × n matrix S, zero above the diagonal. A variance that is zero
/// to rounding gives a column of zeros, so that a component known for certain stays so.
///
/// # Errors
/// [`RootError`] where a pivot is negative beyond rounding, or no finite number.
pub(crate) fn lower_root(s: &Matrix) -> Result<Matrix, RootError> {
    let (root, Rooted { holds, is_finite }) = partial_root(s);
    match (holds, is_finite) {
        (true, _) => Ok(root),
        (false, true) => Err(RootError::Indefinite),
        (false, false) => Err(RootError::NotFinite),
    }
}

/// The same, with a column of zeros for each pivot that has no root, and whether there is such a one.
pub(super) fn partial_root(s: &Matrix) -> (Matrix, Rooted<bool>) {
    let n = s.nrows();
    let mut root = Matrix::zeros(n, n);
    let rooted = columns::lower_root(Baseline, s.as_slice(), root.as_mut_slice(), n);
    (root, rooted)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_root_squares_to_the_covariance() {
        let a = Matrix::from_fn(9, 9, |i, j| libm::sin(1.0 + (3 * i + 5 * j * j) as f64));
        let cov = &a * a.transpose();
        let root = lower_root(&cov).unwrap();
        assert!((&root * root.transpose() - cov).amax() < 1e-13);
        assert_eq!(root.upper_triangle(), Matrix::from_diagonal(&root.diagonal()));
    }

    #[test]
    fn a_variance_of_zero_gives_a_column_of_zeros() {
        let cov = Matrix::from_row_slice(3, 3, &[4.0, 0.0, 2.0, 0.0, 0.0, 0.0, 2.0, 0.0, 5.0]);
        let root = lower_root(&cov).unwrap();
        assert_eq!(root.column(1), Matrix::zeros(3, 1).column(0));
        assert!((&root * root.transpose() - cov).amax() < 1e-15);
        let tiny = lower_root(&Matrix::from_row_slice(2, 2, &[1e-310, 0.0, 0.0, 1.0])).unwrap();
        assert_eq!(tiny, Matrix::from_row_slice(2, 2, &[0.0, 0.0, 0.0, 1.0]));
    }

    #[test]
    fn an_indefinite_or_undefined_matrix_is_refused() {
        let of = |entries: [f64; 4]| lower_root(&Matrix::from_row_slice(2, 2, &entries));
        assert_eq!(of([1.0, 2.0, 2.0, 1.0]), Err(RootError::Indefinite));
        assert_eq!(of([f64::NAN, 0.0, 0.0, 1.0]), Err(RootError::NotFinite));
        assert_eq!(of([f64::INFINITY, 0.0, 0.0, 1.0]), Err(RootError::NotFinite));
    }
}
