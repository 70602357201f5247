//! Matrices of any size: nalgebra's, and the factorisations that filters also need.

use nalgebra::{DMatrix, DVector};

use crate::engine::columns::{self, Rooted};
use crate::engine::level::Baseline;

use crate::filter_error::{FilterError, of_root};

/// A column of numbers.
pub type Vector = DVector<f64>;
/// A rectangle of numbers.
pub type Matrix = DMatrix<f64>;

/// The lower triangle of a square matrix, mirrored: this makes a matrix symmetric to the last bit again after rounding.
#[must_use]
pub fn symmetric(mut matrix: Matrix) -> Matrix {
    matrix.fill_upper_triangle_with_lower_triangle();
    matrix
}

/// The lower triangular `L` with `L Lᵀ = S`, n × n, zero above the diagonal. A variance of zero to rounding gives a column of zeros: a
/// component known for certain stays so. Fails where a pivot is negative beyond rounding, or no finite number.
pub fn lower_root(s: &Matrix) -> Result<Matrix, FilterError> {
    let (root, Rooted { holds, is_finite }) = partial_root(s);
    if holds { Ok(root) } else { Err(of_root(is_finite, FilterError::IndefiniteCovariance)) }
}

/// A pivot without a root gives a column of zeros.
fn partial_root(s: &Matrix) -> (Matrix, Rooted<bool>) {
    let n = s.nrows();
    let mut root = Matrix::zeros(n, n);
    let rooted = columns::lower_root(Baseline, s.as_slice(), root.as_mut_slice(), n);
    (root, rooted)
}

/// A matrix S, m × m, by its [factor](columns::factor).
#[derive(Clone, Debug)]
pub struct Ldl {
    /// L below the diagonal and D⁻¹ on it, zero in a direction that is left out; the rest is of no meaning.
    factor: Matrix,
    /// det S; zero or infinite where it leaves the range of numbers.
    pub determinant: f64,
}

impl Ldl {
    /// The factor of a symmetric matrix, or `None` if it is not positive definite.
    pub fn new(s: &Matrix) -> Option<Self> {
        let mut factor = s.clone();
        let (determinant, is_definite) = columns::factor(factor.as_mut_slice(), s.nrows());
        is_definite.then_some(Self { factor, determinant })
    }

    /// The factor of a matrix that may be only semidefinite: a direction of no variance is left out of quotients.
    pub fn semidefinite(s: &Matrix) -> Self {
        let (mut factor, _) = partial_root(s);
        let mut determinant = 1.0;
        for j in 0..s.nrows() {
            let root = factor[(j, j)];
            determinant *= root * root;
            if root > 0.0 {
                factor.column_mut(j).unscale_mut(root);
                factor[(j, j)] = 1.0 / (root * root);
            }
        }
        Self { factor, determinant }
    }

    /// `X S⁻¹` for X of r × m.
    pub fn divide(&self, x: &Matrix) -> Matrix {
        let mut result = x.clone();
        columns::divide(self.factor.as_slice(), x.ncols(), result.as_mut_slice(), x.nrows());
        result
    }

    /// `eᵀ S⁻¹ e`
    pub fn square(&self, e: &Vector) -> f64 {
        columns::square(self.factor.as_slice(), e.len(), e.clone().as_mut_slice())
    }

    /// ln det S, which is a number even where the determinant is none.
    pub fn ln_determinant(&self) -> f64 {
        if self.determinant.is_normal() {
            libm::log(self.determinant)
        } else {
            let m = self.factor.nrows();
            -(0..m).map(|j| libm::log(self.factor[(j, j)])).sum::<f64>()
        }
    }
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
        assert_eq!(of([1.0, 2.0, 2.0, 1.0]), Err(FilterError::IndefiniteCovariance));
        assert_eq!(of([f64::NAN, 0.0, 0.0, 1.0]), Err(FilterError::NotFinite));
        assert_eq!(of([f64::INFINITY, 0.0, 0.0, 1.0]), Err(FilterError::NotFinite));
    }

    #[test]
    fn a_factor_divides_squares_and_has_the_determinant() {
        let a = Matrix::from_row_slice(3, 3, &[2.0, -0.3, 0.7, 0.1, 1.5, -0.4, 0.9, 0.2, 0.6]);
        let s = &a * a.transpose();
        let factor = Ldl::new(&s).unwrap();
        let x = Matrix::from_fn(4, 3, |i, j| (i as f64 + 1.0) / (j as f64 + 2.0) - 0.5);
        assert!((factor.divide(&x) * &s - x).amax() < 1e-14);
        let e = Vector::from_column_slice(&[0.3, -1.0, 2.0]);
        assert!((factor.square(&e) - e.dot(&s.clone().try_inverse().unwrap().tr_mul(&e))).abs() < 1e-12);
        assert!((factor.determinant - s.determinant()).abs() < 1e-13);
        let tiny = Ldl::new(&(s * 1e-150)).unwrap();
        assert_eq!(tiny.determinant, 0.0);
        assert!((tiny.ln_determinant() - factor.ln_determinant() + 450.0 * std::f64::consts::LN_10).abs() < 1e-9);
    }

    #[test]
    fn a_semidefinite_factor_divides_within_its_range() {
        let a = Matrix::from_row_slice(4, 2, &[2.0, -0.3, 0.7, 0.1, 1.5, -0.4, 0.0, 0.0]);
        let s = &a * a.transpose();
        let x = Matrix::from_row_slice(3, 2, &[0.3, 1.0, -0.7, 0.2, 0.5, 0.6]) * a.transpose();
        let quotient = Ldl::semidefinite(&s).divide(&x);
        assert!((&quotient * s - x).amax() < 1e-14, "{quotient}");
        assert_eq!(quotient.column(3), Vector::zeros(3));
    }

    #[test]
    fn a_matrix_that_is_not_positive_definite_has_no_factor() {
        for s in [[1.0, 1.0, 1.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 1.0], [1.0, 2.0, 1.0], [f64::NAN, 0.0, 1.0]] {
            assert!(Ldl::new(&Matrix::from_row_slice(2, 2, &[s[0], s[1], s[1], s[2]])).is_none(), "{s:?}");
        }
        assert!(Ldl::new(&Matrix::repeat(1, 1, 1e-320)).is_none(), "a pivot without a finite inverse");
        assert!(Ldl::new(&Matrix::repeat(1, 1, f64::INFINITY)).is_none(), "an infinite pivot");
    }
}
