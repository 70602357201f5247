//! Lower triangular roots of covariances.

use super::{Matrix, next_pivot, with_inverse};
use crate::FilterError;

/// The lower triangular `L` with `L Lᵀ = cov`, zero above the diagonal. A variance that is zero to rounding gives a column of
/// zeros, so that a component known for certain stays so.
///
/// Columns are scaled by their pivots' square roots only in the end: a pivot then waits for one division, not for a
/// root and a division, and every second pivot for none.
///
/// # Errors
/// [`FilterError::IndefiniteCovariance`] where a pivot is negative beyond rounding, [`FilterError::NotFinite`] where one is
/// no finite number.
///
/// Source: Golub and Van Loan (2013), *Matrix Computations*, section 4.2.8 (semidefinite systems).
pub(crate) fn lower_root<const N: usize>(cov: &Matrix<N, N>) -> Result<Matrix<N, N>, FilterError> {
    let mut columns = *cov;
    let mut root = Matrix::<N, N>::zeros();
    let mut next = None;
    let mut take = |j: usize| -> Result<(), FilterError> {
        next = take_column(cov, &mut columns, &mut root, j, next)?;
        Ok(())
    };
    if N == 4 {
        // Unrolled by hand: as a loop, the usual size takes four times as many instructions.
        take(0)?;
        take(1)?;
        take(2)?;
        take(3)?;
    } else {
        (0..N).try_for_each(take)?;
    }
    Ok(root)
}

/// Makes column `j` of the root and subtracts its share from the columns after it. `known` is the pivot and its
/// inverse, if the last column has found them; returns the next ones, if this one has.
#[inline(always)]
fn take_column<const N: usize>(
    cov: &Matrix<N, N>,
    columns: &mut Matrix<N, N>,
    root: &mut Matrix<N, N>,
    j: usize,
    known: Option<(f64, f64)>,
) -> Result<Option<(f64, f64)>, FilterError> {
    let (pivot, inverse) = known.unwrap_or_else(|| with_inverse(columns[(j, j)]));
    let rounding = 4.0 * N as f64 * f64::EPSILON * cov[(j, j)];
    if pivot > rounding && pivot.is_normal() {
        let next = if known.is_none() { next_pivot(columns, j, pivot, inverse) } else { None };
        if N > 4 {
            eliminate(columns, j, inverse);
        } else {
            for k in j + 1..N {
                let share = columns[(k, j)] * inverse;
                for i in k..N {
                    columns[(i, k)] -= columns[(i, j)] * share;
                }
            }
        }
        let scale = inverse * pivot.sqrt();
        for i in j..N {
            root[(i, j)] = columns[(i, j)] * scale;
        }
        return Ok(next);
    }
    if !pivot.is_finite() {
        Err(FilterError::NotFinite)
    } else if pivot < -1e4 * rounding {
        Err(FilterError::IndefiniteCovariance)
    } else {
        Ok(None)
    }
}

/// Subtracts the share of column `j` from the columns after it, half a column at a time, so that the compiler uses
/// vector instructions. It also changes numbers above the diagonal, which are not used.
#[inline]
fn eliminate<const N: usize>(columns: &mut Matrix<N, N>, j: usize, inverse: f64) {
    let column = columns.data.0[j];
    for k in j + 1..N {
        if column[k] == 0.0 {
            continue;
        }
        let share = column[k] * inverse;
        let target = &mut columns.data.0[k];
        if k < N / 2 {
            for i in 0..N / 2 {
                target[i] -= column[i] * share;
            }
        }
        for i in N / 2..N {
            target[i] -= column[i] * share;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mathematics::kernel::gaussian::Vector;

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
        assert_eq!(lower_root(&undefined), Err(FilterError::NotFinite));
        let infinite = Matrix::<2, 2>::new(f64::INFINITY, 0.0, 0.0, 1.0);
        assert_eq!(lower_root(&infinite), Err(FilterError::NotFinite));
    }

    #[test]
    fn a_variance_that_is_too_small_to_divide_by_is_zero() {
        let tiny = Matrix::<2, 2>::new(1e-310, 0.0, 0.0, 1.0);
        assert_eq!(lower_root(&tiny), Ok(Matrix::from_diagonal(&Vector::<2>::new(0.0, 1.0))));
    }
}
