//! Householder reflections of arrays, the roots of covariances.

use super::Matrix;

/// A reflection of the row `[pivot, rest]` of an array to `[length, 0]`; the rows after it need the same reflection.
///
/// Source: Golub and Van Loan (2013), *Matrix Computations*, section 5.1.2.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reflection<const W: usize> {
    pivot: f64,
    length: f64,
    inverse_length: f64,
    inverse_sum: f64,
    rest: [f64; W],
}

impl<const W: usize> Reflection<W> {
    /// The reflection of a row with a pivot that is not negative. `None` if the row is zero, or too small to square.
    #[inline]
    pub(crate) fn new(pivot: f64, rest: [f64; W]) -> Option<Self> {
        let square = pivot * pivot + dot(&rest, &rest);
        if square < f64::MIN_POSITIVE {
            return None;
        }
        let length = square.sqrt();
        Some(Self { pivot, length, inverse_length: 1.0 / length, inverse_sum: 1.0 / (pivot + length), rest })
    }

    /// The length; infinite where the row is too large to square.
    #[inline]
    pub(crate) fn length(&self) -> f64 {
        self.length
    }

    /// Reflects another row.
    #[inline]
    pub(crate) fn apply(&self, first: &mut f64, rest: &mut [f64; W]) {
        let Self { pivot, inverse_length, inverse_sum, rest: own, .. } = self;
        let along = (pivot * *first + dot(own, rest)) * inverse_length;
        let share = (along + *first) * inverse_sum;
        for k in 0..W {
            rest[k] -= own[k] * share;
        }
        *first = along;
    }
}

/// The product of two rows, in sums that do not wait for each other.
#[inline]
fn dot<const W: usize>(a: &[f64; W], b: &[f64; W]) -> f64 {
    let mut sums = [0.0; 4];
    let mut k = 0;
    while k + 4 <= W {
        for lane in 0..4 {
            sums[lane] += a[k + lane] * b[k + lane];
        }
        k += 4;
    }
    let mut last = 0.0;
    while k < W {
        last += a[k] * b[k];
        k += 1;
    }
    (sums[0] + sums[2]) + (sums[1] + sums[3]) + last
}

/// Replaces the lower triangular root `L` by that of `L Lᵀ + Dᵀ D`. Only the first `components` columns of D may be
/// other than zero, the rows of L after them must be diagonal, and no entry on L's diagonal may be negative. A
/// component without variance keeps none.
#[inline]
pub(crate) fn add_to_root<const N: usize, const W: usize>(
    root: &mut Matrix<N, N>,
    deviations: &mut Matrix<W, N>,
    components: usize,
) {
    for j in 0..components {
        let Some(reflection) = Reflection::new(root[(j, j)], deviations.data.0[j]) else { continue };
        root[(j, j)] = reflection.length();
        if reflection.length() == f64::INFINITY {
            // The quotients would be zero, and the overflow of the row would go unnoticed.
            return;
        }
        for i in j + 1..components {
            reflection.apply(&mut root.data.0[j][i], &mut deviations.data.0[i]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mathematics::kernel::gaussian::{Vector, lower_root, square};

    #[test]
    fn a_root_can_be_added_to() {
        let before = Matrix::<3, 3>::new(2.0, 0.0, 0.0, -0.3, 0.0, 0.0, 0.7, 0.4, 0.1);
        let mut deviations = Matrix::<5, 3>::from_fn(|i, j| libm::sin((7 * i + 3 * j) as f64));
        let cov = square(&before) + deviations.transpose() * deviations;
        let mut root = before;
        add_to_root(&mut root, &mut deviations, 3);
        assert!((square(&root) - cov).amax() < 1e-14);
        assert_eq!(root.upper_triangle(), Matrix::<3, 3>::from_diagonal(&root.diagonal()));
        assert!((root - lower_root(&cov).unwrap()).amax() < 1e-13);
    }

    #[test]
    fn a_component_without_variance_keeps_none() {
        let mut root = Matrix::<3, 3>::zeros();
        let mut deviations = Matrix::<2, 3>::new(1.0, 0.0, 0.3, -0.7, 0.0, 1e-170);
        add_to_root(&mut root, &mut deviations, 3);
        assert_eq!(square(&root).column(1), Vector::<3>::zeros());
        assert!((square(&root)[(2, 2)] - 0.09).abs() < 1e-15);
    }

    #[test]
    fn a_row_that_is_too_large_to_square_does_not_vanish() {
        for number in [1e200, f64::INFINITY, f64::NAN] {
            let mut root = Matrix::<2, 2>::identity();
            let mut deviations = Matrix::<1, 2>::new(number, 1.0);
            add_to_root(&mut root, &mut deviations, 2);
            assert!(!square(&root).sum().is_finite(), "{number}");
        }
    }
}
