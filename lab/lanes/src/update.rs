//! The update of beliefs by measurements: the kernel's in lanes, for measurements without a special case.

use kalmanscope_core::kernel::abreast::LogSum;

use crate::belief::{AT, Belief, N};
use crate::expect::{Expected, View};
use crate::factor::Factor;
use crate::lane::Lane;
use crate::observation::Active;

/// The result of an update.
#[derive(Clone, Copy)]
pub(crate) struct Correction<T: Lane> {
    pub(crate) nis: T,
    /// det S
    pub(crate) determinant: T,
    /// The lanes for which it holds.
    pub(crate) holds: T::Mask,
}

/// Conditions the beliefs on sensors that read these components.
#[inline(always)]
pub(crate) fn by_components<T: Lane, const M: usize>(
    belief: &mut Belief<T>,
    components: [usize; M],
    active: &[Active<T>; M],
) -> Correction<T> {
    let at = |i: usize, j: usize| belief.cov(i, j);
    let innovation: [T; M] = std::array::from_fn(|m| active[m].value - belief.mean[components[m]]);
    let seen: [[T; M]; M] = std::array::from_fn(|i| std::array::from_fn(|j| at(components[i], components[j])));
    let mut s = seen;
    for m in 0..M {
        s[m][m] = s[m][m] + active[m].variance;
    }
    let factor = Factor::new(&s);
    let cross: [[T; M]; N] = std::array::from_fn(|i| std::array::from_fn(|m| at(components[m], i)));
    let gain = cross.map(|row| factor.divide(row));

    // The columns of `P - K (P Hᵀ)ᵀ` that H picks.
    let excess: [[T; M]; N] = std::array::from_fn(|i| {
        std::array::from_fn(|m| {
            let mut entry = cross[i][m];
            for k in 0..M {
                entry = entry - gain[i][k] * seen[m][k];
            }
            entry - gain[i][m] * active[m].variance
        })
    });
    for j in 0..N {
        for i in j..N {
            let mut entry = belief.cov(i, j);
            for m in 0..M {
                entry = entry - gain[i][m] * cross[j][m];
            }
            for m in 0..M {
                entry = entry - excess[i][m] * gain[j][m];
            }
            belief.cov[AT[i][j]] = entry;
        }
    }
    finish(belief, &gain, &innovation, &factor)
}

/// Conditions the beliefs on sensors of which some read a rate.
#[inline(always)]
pub(crate) fn by_expected<T: Lane, const M: usize>(
    belief: &mut Belief<T>,
    expected: &Expected<T, M>,
    active: &[Active<T>; M],
) -> Correction<T> {
    let Expected { mean, cov: s, cross, view } = expected;
    let innovation: [T; M] = std::array::from_fn(|m| active[m].value - mean[m]);
    let factor = Factor::new(s);
    let gain = cross.map(|row| factor.divide(row));
    match view {
        View::Linear(jacobian) => {
            let kept: [[T; N]; N] = std::array::from_fn(|i| {
                std::array::from_fn(|j| {
                    let mut entry = belief.cov(i, j);
                    for m in 0..M {
                        entry = entry - gain[i][m] * cross[j][m];
                    }
                    entry
                })
            });
            for i in 0..N {
                let excess: [T; M] = std::array::from_fn(|m| {
                    let seen = jacobian[m].times(&kept[i]);
                    seen - gain[i][m] * active[m].variance
                });
                for j in 0..=i {
                    let mut entry = kept[i][j];
                    for m in 0..M {
                        entry = entry - excess[m] * gain[j][m];
                    }
                    belief.cov[AT[i][j]] = entry;
                }
            }
        }
        View::Curved => {
            for i in 0..N {
                let product: [T; M] = std::array::from_fn(|m| {
                    let mut sum = gain[i][0] * s[0][m];
                    for k in 1..M {
                        sum = sum + gain[i][k] * s[k][m];
                    }
                    sum
                });
                for j in 0..=i {
                    let mut entry = belief.cov(i, j);
                    for m in 0..M {
                        entry = entry - product[m] * gain[j][m];
                    }
                    belief.cov[AT[i][j]] = entry;
                }
            }
        }
    }
    finish(belief, &gain, &innovation, &factor)
}

/// Moves the mean, and looks whether the result can stand.
#[inline(always)]
fn finish<T: Lane, const M: usize>(
    belief: &mut Belief<T>,
    gain: &[[T; M]; N],
    innovation: &[T; M],
    factor: &Factor<T, M>,
) -> Correction<T> {
    for i in 0..N {
        let mut moved = gain[i][0] * innovation[0];
        for m in 1..M {
            moved = moved + gain[i][m] * innovation[m];
        }
        belief.mean[i] = belief.mean[i] + moved;
    }
    let nis = factor.square(innovation);
    let determinant = factor.determinant;
    let (low, high) = (nis.of(*LogSum::RANGE.start()), nis.of(*LogSum::RANGE.end()));
    let in_range = low.le(determinant) & determinant.le(high);
    let holds = factor.holds & belief.is_valid() & nis.is_finite() & in_range;
    Correction { nis, determinant, holds }
}
