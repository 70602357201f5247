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

/// The lower triangular `L` with `L Lᵀ = cov`, zero above the diagonal. A variance that is zero to rounding gives a column of
/// zeros, so that a component known for certain stays so.
///
/// Columns are scaled by their pivots' square roots only in the end: a pivot then waits for one division, not for a root
/// and a division, and every other pivot for none (see [`next_pivot`]).
///
/// # Errors
/// [`FilterError::IndefiniteCovariance`] where a pivot is negative beyond rounding, [`FilterError::NotFinite`] where one is
/// no finite number.
///
/// Source: Golub and Van Loan (2013), *Matrix Computations*, section 4.2.8 (semidefinite systems).
pub fn lower_root<const N: usize>(cov: &Matrix<N, N>) -> Result<Matrix<N, N>, FilterError> {
    let mut columns = *cov;
    let mut root = Matrix::<N, N>::zeros();
    let mut next = None;
    let mut take = |j: usize| -> Result<(), FilterError> {
        next = take_column(cov, &mut columns, &mut root, j, next)?;
        Ok(())
    };
    if N == 4 {
        // One by one: left as a loop, the usual size takes four times as many instructions.
        take(0)?;
        take(1)?;
        take(2)?;
        take(3)?;
    } else {
        (0..N).try_for_each(take)?;
    }
    Ok(root)
}

/// Makes column `j` of the root and takes its share from the columns after it. `known` is the pivot and its inverse, if the
/// last column has found them; returns the next ones, if this one has.
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

/// Takes from the columns after `j` their share in it, half columns at a time, which the compiler turns into vector
/// instructions; what that makes of the numbers above the diagonal does not matter.
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

/// Makes of the lower triangular root `L` that of `L Lᵀ + d dᵀ`, by Givens rotations.
///
/// Source: Golub and Van Loan (2013), *Matrix Computations*, section 6.5.4.
#[inline]
pub fn add_to_root<const N: usize>(root: &mut Matrix<N, N>, mut d: Vector<N>) {
    for j in 0..N {
        let length = (root[(j, j)] * root[(j, j)] + d[j] * d[j]).sqrt();
        if length == 0.0 {
            continue;
        }
        if length == f64::INFINITY {
            // Its quotients would be zeros, and what is too large to square would vanish without a word.
            root[(j, j)] = length;
            return;
        }
        let (cos, sin) = (root[(j, j)] / length, d[j] / length);
        for i in j..N {
            let (kept, added) = (root[(i, j)], d[i]);
            root[(i, j)] = cos * kept + sin * added;
            d[i] = cos * added - sin * kept;
        }
    }
}

#[inline]
fn with_inverse(pivot: f64) -> (f64, f64) {
    (pivot, 1.0 / pivot)
}

/// The pivot that follows the one in column `j`, and its inverse, from the determinant of both. That does not wait for the
/// inverse of the first: two divisions take the time of one. `None` where there is no next column, where the determinant
/// is not positive, and where it leaves the range of numbers.
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

/// `S = L D Lᵀ` with a unit lower triangular L and a positive diagonal D: a Cholesky factor without square roots.
///
/// Source: Golub and Van Loan (2013), *Matrix Computations*, section 4.1.2.
#[derive(Clone, Copy, Debug)]
pub struct Factor<const M: usize> {
    lower: Matrix<M, M>,
    inverse_pivots: Vector<M>,
    determinant: f64,
}

impl<const M: usize> Factor<M> {
    /// The factor of the symmetric matrix `s`, or `None` if it is not positive definite.
    #[inline]
    pub fn new(s: &Matrix<M, M>) -> Option<Self> {
        let mut columns = *s;
        let mut factor = Self { lower: Matrix::identity(), inverse_pivots: Vector::zeros(), determinant: 1.0 };
        let mut next = None;
        for j in 0..M {
            let known = next.take();
            let (pivot, inverse) = known.unwrap_or_else(|| with_inverse(columns[(j, j)]));
            if !(pivot > 0.0 && inverse.is_normal()) {
                return None;
            }
            if known.is_none() {
                next = next_pivot(&columns, j, pivot, inverse);
            }
            for k in j + 1..M {
                factor.lower[(k, j)] = columns[(k, j)] * inverse;
                for i in k..M {
                    columns[(i, k)] -= columns[(i, j)] * factor.lower[(k, j)];
                }
            }
            factor.inverse_pivots[j] = inverse;
            factor.determinant *= pivot;
        }
        Some(factor)
    }

    /// The factor of a symmetric matrix that may be only semidefinite: a direction of no variance is left out, and a
    /// quotient has no part in it.
    pub fn semidefinite(s: &Matrix<M, M>) -> Self {
        let mut columns = *s;
        let mut factor = Self { lower: Matrix::identity(), inverse_pivots: Vector::zeros(), determinant: 0.0 };
        for j in 0..M {
            let pivot = columns[(j, j)];
            if pivot > 4.0 * M as f64 * f64::EPSILON * s[(j, j)] {
                let inverse = 1.0 / pivot;
                for k in j + 1..M {
                    factor.lower[(k, j)] = columns[(k, j)] * inverse;
                    for i in k..M {
                        columns[(i, k)] -= columns[(i, j)] * factor.lower[(k, j)];
                    }
                }
                factor.inverse_pivots[j] = inverse;
            }
        }
        factor
    }

    /// `X S⁻¹`, R × M.
    #[inline]
    pub fn divide<const R: usize>(&self, x: &Matrix<R, M>) -> Matrix<R, M> {
        let Self { lower, inverse_pivots, .. } = self;
        let mut result = *x;
        for j in 0..M {
            for k in 0..j {
                let share = lower[(j, k)];
                for i in 0..R {
                    result[(i, j)] -= result[(i, k)] * share;
                }
            }
        }
        for j in (0..M).rev() {
            for i in 0..R {
                result[(i, j)] *= inverse_pivots[j];
            }
            for k in j + 1..M {
                let share = lower[(k, j)];
                for i in 0..R {
                    result[(i, j)] -= result[(i, k)] * share;
                }
            }
        }
        result
    }

    /// `eᵀ S⁻¹ e`
    #[inline]
    pub fn square(&self, e: &Vector<M>) -> f64 {
        let Self { lower, inverse_pivots, .. } = self;
        let mut white = *e;
        let mut sum = 0.0;
        for j in 0..M {
            for k in 0..j {
                white[j] -= lower[(j, k)] * white[k];
            }
            sum += white[j] * white[j] * inverse_pivots[j];
        }
        sum
    }

    /// ln det S, which is a number even where the determinant is none.
    pub fn ln_determinant(&self) -> f64 {
        if self.determinant.is_normal() {
            libm::log(self.determinant)
        } else {
            -self.inverse_pivots.iter().map(|&inverse| libm::log(inverse)).sum::<f64>()
        }
    }

    /// det S
    pub fn determinant(&self) -> f64 {
        self.determinant
    }
}

/// What rounding has made of a covariance, symmetric to the last bit again: the lower triangle, mirrored.
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
    fn a_root_can_be_added_to() {
        let mut root = Matrix::<3, 3>::new(2.0, 0.0, 0.0, -0.3, 0.0, 0.0, 0.7, 0.4, 0.1);
        let d = Vector::<3>::new(0.3, -1.0, 2.0);
        let cov = root * root.transpose() + d * d.transpose();
        add_to_root(&mut root, d);
        assert!((root * root.transpose() - cov).amax() < 1e-14);
        assert_eq!(root.upper_triangle(), Matrix::<3, 3>::from_diagonal(&root.diagonal()));
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
    fn what_is_too_small_to_divide_by_is_zero_and_what_is_too_large_to_square_is_not() {
        let tiny = Matrix::<2, 2>::new(1e-310, 0.0, 0.0, 1.0);
        assert_eq!(lower_root(&tiny), Ok(Matrix::from_diagonal(&Vector::<2>::new(0.0, 1.0))));
        let mut root = Matrix::<2, 2>::new(1e200, 0.0, 1e200, 1.0);
        add_to_root(&mut root, Vector::<2>::new(1.0, 1.0));
        assert!(!(root * root.transpose()).sum().is_finite());
    }

    #[test]
    fn a_factor_divides_squares_and_has_the_determinant() {
        let a = Matrix::<3, 3>::new(2.0, -0.3, 0.7, 0.1, 1.5, -0.4, 0.9, 0.2, 0.6);
        let s = a * a.transpose();
        let factor = Factor::new(&s).unwrap();
        let x = Matrix::<4, 3>::from_fn(|i, j| (i as f64 + 1.0) / (j as f64 + 2.0) - 0.5);
        assert!((factor.divide(&x) * s - x).amax() < 1e-14);
        let e = Vector::<3>::new(0.3, -1.0, 2.0);
        assert!((factor.square(&e) - e.dot(&s.try_inverse().unwrap().tr_mul(&e))).abs() < 1e-12);
        assert!((factor.determinant() - s.determinant()).abs() < 1e-13);
        assert_eq!(factor.ln_determinant(), libm::log(factor.determinant()));
        let tiny = Factor::new(&(s * 1e-150)).unwrap();
        assert_eq!(tiny.determinant(), 0.0);
        assert!((tiny.ln_determinant() - factor.ln_determinant() + 450.0 * std::f64::consts::LN_10).abs() < 1e-9);
    }

    #[test]
    fn a_semidefinite_factor_divides_what_is_in_the_range() {
        let a = Matrix::<4, 2>::new(2.0, -0.3, 0.7, 0.1, 1.5, -0.4, 0.0, 0.0);
        let s = a * a.transpose();
        let x = Matrix::<3, 2>::new(0.3, 1.0, -0.7, 0.2, 0.5, 0.6) * a.transpose();
        let quotient = Factor::semidefinite(&s).divide(&x);
        assert!((quotient * s - x).amax() < 1e-14, "{quotient}");
        assert_eq!(quotient.column(3), Vector::<3>::zeros());
    }

    #[test]
    fn what_is_not_positive_definite_has_no_factor() {
        for s in [[1.0, 1.0, 1.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 1.0], [1.0, 2.0, 1.0], [f64::NAN, 0.0, 1.0]] {
            assert!(Factor::new(&Matrix::<2, 2>::new(s[0], s[1], s[1], s[2])).is_none(), "{s:?}");
        }
        assert!(Factor::new(&Matrix::<1, 1>::new(1e-320)).is_none(), "a pivot without a finite inverse");
        assert!(Factor::new(&Matrix::<1, 1>::new(f64::INFINITY)).is_none(), "an infinite pivot");
    }
}
