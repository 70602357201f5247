//! Roots and factors of covariances: those of [`gaussian`](kalmanscope_core::internals::kernel::gaussian) in lanes, for matrices
//! without a special case.

use crate::belief::Triangle;
use crate::lane::Lane;

/// Two columns' pivots and their inverses, the second by the determinant of both, and the lanes for which that holds.
#[inline(always)]
fn two_pivots<T: Lane>(c00: T, c10: T, c11: T) -> ([T; 2], [T; 2], T::Mask) {
    let inverse = c00.of(1.0) / c00;
    let determinant = c00 * c11 - c10 * c10;
    ([c00, determinant * inverse], [inverse, c00 / determinant], determinant.is_normal())
}

/// The lower triangular root of a covariance, and the lanes for which it holds.
#[inline(always)]
pub(crate) fn lower_root<T: Lane, const N: usize, const E: usize>(cov: &[T; E]) -> ([T; E], T::Mask) {
    let at = &Triangle::<N>::AT;
    let mut columns = *cov;
    let mut root = *cov;
    let mut holds = T::always(cov[0].token());
    let (mut pivots, mut inverses) = ([cov[0]; 2], [cov[0]; 2]);
    for j in 0..N {
        if j % 2 == 0 && j + 1 == N {
            let last = columns[at[j][j]];
            (pivots[0], inverses[0]) = (last, last.of(1.0) / last);
        } else if j % 2 == 0 {
            let in_range;
            (pivots, inverses, in_range) =
                two_pivots(columns[at[j][j]], columns[at[j + 1][j]], columns[at[j + 1][j + 1]]);
            holds = holds & in_range;
        }
        let (pivot, inverse) = (pivots[j % 2], inverses[j % 2]);
        let rounding = pivot.of(4.0 * N as f64 * f64::EPSILON) * cov[at[j][j]];
        holds = holds & rounding.lt(pivot) & pivot.is_normal();
        for k in j + 1..N {
            let share = columns[at[k][j]] * inverse;
            for i in k..N {
                columns[at[i][k]] = columns[at[i][k]] - columns[at[i][j]] * share;
            }
        }
        let scale = inverse * pivot.sqrt();
        for i in j..N {
            root[at[i][j]] = columns[at[i][j]] * scale;
        }
    }
    (root, holds)
}

/// `S = L D Lᵀ` of the covariance of M innovations.
pub(crate) struct Factor<T: Lane, const M: usize> {
    lower: [[T; M]; M],
    inverse_pivots: [T; M],
    pub(crate) determinant: T,
    /// The lanes for which it holds.
    pub(crate) holds: T::Mask,
}

impl<T: Lane, const M: usize> Factor<T, M> {
    /// Factors S, from its lower triangle.
    #[inline(always)]
    pub(crate) fn new(s: &[[T; M]; M]) -> Self {
        let token = s[0][0].token();
        let mut columns = *s;
        let mut lower = *s;
        let mut inverse_pivots = [s[0][0]; M];
        let mut determinant = s[0][0];
        let mut holds = T::always(token);
        let mut second = None;
        for j in 0..M {
            let (pivot, inverse) = match second.take() {
                Some(known) => known,
                None if j + 1 == M => (columns[j][j], columns[j][j].of(1.0) / columns[j][j]),
                None => {
                    let (pivots, inverses, in_range) =
                        two_pivots(columns[j][j], columns[j + 1][j], columns[j + 1][j + 1]);
                    holds = holds & in_range;
                    second = Some((pivots[1], inverses[1]));
                    (pivots[0], inverses[0])
                }
            };
            holds = holds & pivot.of(0.0).lt(pivot) & inverse.is_normal();
            for k in j + 1..M {
                lower[k][j] = columns[k][j] * inverse;
                for i in k..M {
                    columns[i][k] = columns[i][k] - columns[i][j] * lower[k][j];
                }
            }
            inverse_pivots[j] = inverse;
            determinant = if j == 0 { pivot } else { determinant * pivot };
        }
        Self { lower, inverse_pivots, determinant, holds }
    }

    /// `X S⁻¹` of one row of X.
    #[inline(always)]
    pub(crate) fn divide(&self, mut row: [T; M]) -> [T; M] {
        let Self { lower, inverse_pivots, .. } = self;
        for j in 0..M {
            for k in 0..j {
                row[j] = row[j] - row[k] * lower[j][k];
            }
        }
        for j in (0..M).rev() {
            row[j] = row[j] * inverse_pivots[j];
            for k in j + 1..M {
                row[j] = row[j] - row[k] * lower[k][j];
            }
        }
        row
    }

    /// `eᵀ S⁻¹ e`
    #[inline(always)]
    pub(crate) fn square(&self, e: &[T; M]) -> T {
        let Self { lower, inverse_pivots, .. } = self;
        let mut white = *e;
        let mut sum = e[0].of(0.0);
        for j in 0..M {
            for k in 0..j {
                white[j] = white[j] - lower[j][k] * white[k];
            }
            sum = sum + white[j] * white[j] * inverse_pivots[j];
        }
        sum
    }
}
