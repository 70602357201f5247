//! Division by a covariance.

use super::{Matrix, Vector, next_pivot, with_inverse};

/// `S = L D Lᵀ` with a unit lower triangular L and a positive diagonal D: a Cholesky factor without square roots.
///
/// Source: Golub and Van Loan (2013), *Matrix Computations*, section 4.1.2.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Factor<const M: usize> {
    lower: Matrix<M, M>,
    inverse_pivots: Vector<M>,
    determinant: f64,
}

impl<const M: usize> Factor<M> {
    /// The factor of the symmetric matrix `s`, or `None` if it is not positive definite.
    #[inline]
    pub(crate) fn new(s: &Matrix<M, M>) -> Option<Self> {
        Self::padded(s, M)
    }

    /// As [`Self::new`], if all but the first `count` rows and columns of `s` are those of an identity. The determinant
    /// is the product of the first `count` pivots: the others are one up to rounding.
    #[inline]
    pub(crate) fn padded(s: &Matrix<M, M>, count: usize) -> Option<Self> {
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
            if j < count {
                factor.determinant *= pivot;
            }
        }
        Some(factor)
    }

    /// `X S⁻¹`, R × M.
    #[inline]
    pub(crate) fn divide<const R: usize>(&self, x: &Matrix<R, M>) -> Matrix<R, M> {
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
    pub(crate) fn square(&self, e: &Vector<M>) -> f64 {
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

    /// ln det S, which is finite even if the determinant overflows or underflows.
    pub(crate) fn ln_determinant(&self) -> f64 {
        if self.determinant.is_normal() {
            libm::log(self.determinant)
        } else {
            -self.inverse_pivots.iter().map(|&inverse| libm::log(inverse)).sum::<f64>()
        }
    }

    /// det S
    pub(crate) fn determinant(&self) -> f64 {
        self.determinant
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn what_is_not_positive_definite_has_no_factor() {
        for s in [[1.0, 1.0, 1.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 1.0], [1.0, 2.0, 1.0], [f64::NAN, 0.0, 1.0]] {
            assert!(Factor::new(&Matrix::<2, 2>::new(s[0], s[1], s[1], s[2])).is_none(), "{s:?}");
        }
        assert!(Factor::new(&Matrix::<1, 1>::new(1e-320)).is_none(), "a pivot without a finite inverse");
        assert!(Factor::new(&Matrix::<1, 1>::new(f64::INFINITY)).is_none(), "an infinite pivot");
    }
}
