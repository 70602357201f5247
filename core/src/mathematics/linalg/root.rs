//! Lower triangular roots of covariances.

use thiserror::Error;

use super::Matrix;

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
///
/// Source: Golub and Van Loan (2013), *Matrix Computations*, section 4.2.8 (semidefinite systems).
pub(crate) fn lower_root(s: &Matrix) -> Result<Matrix, RootError> {
    let n = s.nrows();
    let mut root = Matrix::zeros(n, n);
    let entries = root.as_mut_slice();
    for j in 0..n {
        // Column j less its part in the columns before.
        let (before, column) = entries.split_at_mut(j * n);
        let column = &mut column[j..n];
        column.copy_from_slice(&s.as_slice()[j * n..][j..n]);
        for earlier in before.chunks_exact(n) {
            let share = earlier[j];
            if share != 0.0 {
                for (entry, earlier) in column.iter_mut().zip(&earlier[j..]) {
                    *entry -= earlier * share;
                }
            }
        }
        let pivot = column[0];
        let rounding = 4.0 * n as f64 * f64::EPSILON * s[(j, j)];
        if pivot > rounding && pivot.is_normal() {
            let scale = 1.0 / pivot.sqrt();
            column.iter_mut().for_each(|entry| *entry *= scale);
        } else if !pivot.is_finite() {
            return Err(RootError::NotFinite);
        } else if pivot < -1e4 * rounding {
            return Err(RootError::Indefinite);
        } else {
            column.fill(0.0);
        }
    }
    Ok(root)
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
