//! The update of beliefs by measurements: the kernel's in lanes, for measurements without a special case.

use kalmanscope_core::internals::LogSum;

use crate::belief::{Belief, Triangle};
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
pub(crate) fn by_components<T: Lane, const N: usize, const E: usize, const M: usize>(
    belief: &mut Belief<T, N, E>,
    components: [usize; M],
    active: &[Active<T>; M],
) -> Correction<T> {
    let zero = belief.mean[0].of(0.0);
    let (mut innovation, mut seen, mut cross) = ([zero; M], [[zero; M]; M], [[zero; M]; N]);
    for m in 0..M {
        innovation[m] = active[m].value - belief.mean[components[m]];
        for k in 0..M {
            seen[m][k] = belief.cov(components[m], components[k]);
        }
        for i in 0..N {
            cross[i][m] = belief.cov(components[m], i);
        }
    }
    let mut s = seen;
    for m in 0..M {
        s[m][m] = s[m][m] + active[m].variance;
    }
    let factor = Factor::new(&s);
    let (mut gain, mut excess) = (cross, cross);
    for i in 0..N {
        gain[i] = factor.divide(cross[i]);
        // The columns of `P - K (P Hᵀ)ᵀ` that H picks, less K R.
        for m in 0..M {
            for k in 0..M {
                excess[i][m] = excess[i][m] - gain[i][k] * seen[m][k];
            }
            excess[i][m] = excess[i][m] - gain[i][m] * active[m].variance;
        }
    }
    for j in 0..N {
        for i in j..N {
            let mut entry = belief.cov(i, j);
            for m in 0..M {
                entry = entry - gain[i][m] * cross[j][m];
            }
            for m in 0..M {
                entry = entry - excess[i][m] * gain[j][m];
            }
            belief.cov[Triangle::<N>::AT[i][j]] = entry;
        }
    }
    finish(belief, &gain, &innovation, &factor)
}

/// Conditions the beliefs on sensors of which some read a rate.
#[inline(always)]
pub(crate) fn by_expected<T: Lane, const N: usize, const E: usize, const M: usize>(
    belief: &mut Belief<T, N, E>,
    expected: &Expected<T, N, M>,
    active: &[Active<T>; M],
) -> Correction<T> {
    let Expected { mean, cov: s, cross, view } = expected;
    let zero = belief.mean[0].of(0.0);
    let factor = Factor::new(s);
    let (mut innovation, mut gain) = ([zero; M], *cross);
    for m in 0..M {
        innovation[m] = active[m].value - mean[m];
    }
    for i in 0..N {
        gain[i] = factor.divide(cross[i]);
    }
    let mut lower = belief.cov;
    // Each row of `P - K (P Hᵀ)ᵀ`, or of P, less the gains' terms.
    for i in 0..N {
        let (mut kept, mut taken) = ([zero; N], [zero; M]);
        for j in 0..N {
            kept[j] = belief.cov(i, j);
        }
        match view {
            View::Linear(jacobian) => {
                for j in 0..N {
                    for m in 0..M {
                        kept[j] = kept[j] - gain[i][m] * cross[j][m];
                    }
                }
                for m in 0..M {
                    taken[m] = jacobian[m].times(&kept) - gain[i][m] * active[m].variance;
                }
            }
            View::Curved => {
                for m in 0..M {
                    taken[m] = gain[i][0] * s[0][m];
                    for k in 1..M {
                        taken[m] = taken[m] + gain[i][k] * s[k][m];
                    }
                }
            }
        }
        for j in 0..=i {
            for m in 0..M {
                kept[j] = kept[j] - taken[m] * gain[j][m];
            }
            lower[Triangle::<N>::AT[i][j]] = kept[j];
        }
    }
    belief.cov = lower;
    finish(belief, &gain, &innovation, &factor)
}

/// Moves the mean, and checks whether the result is valid.
#[inline(always)]
fn finish<T: Lane, const N: usize, const E: usize, const M: usize>(
    belief: &mut Belief<T, N, E>,
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
