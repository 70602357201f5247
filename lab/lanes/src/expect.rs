//! The measurements that filters expect where some sensors read a rate.

use kalmanscope_core::internals::kernel::Output;

use crate::belief::{Belief, Triangle};
use crate::factor::lower_root;
use crate::lane::Lane;
use crate::observation::Active;
use crate::plant::Plant;
use crate::sigma_points::SPREAD;

/// The prediction of M measurements.
pub(crate) struct Expected<T, const N: usize, const M: usize> {
    pub(crate) mean: [T; M],
    /// S, noise included.
    pub(crate) cov: [[T; M]; M],
    /// Covariance of state and measurement: a row for each component of the state.
    pub(crate) cross: [[T; M]; N],
    pub(crate) view: View<T, N, M>,
}

/// The dependence of measurements on the state.
pub(crate) enum View<T, const N: usize, const M: usize> {
    /// Linearly: H.
    Linear([Row<T, N>; M]),
    /// Not linearly.
    Curved,
}

/// A row of H.
#[derive(Clone, Copy)]
pub(crate) enum Row<T, const N: usize> {
    /// One of the unit matrix.
    Unit(usize),
    /// A full one.
    Full([T; N]),
}

impl<T: Lane, const N: usize> Row<T, N> {
    /// Its product with a column.
    #[inline(always)]
    pub(crate) fn times(&self, column: &[T; N]) -> T {
        match self {
            Self::Unit(i) => column[*i],
            Self::Full(row) => {
                let mut sum = row[0] * column[0];
                for k in 1..N {
                    sum = sum + row[k] * column[k];
                }
                sum
            }
        }
    }
}

/// The reading of a sensor in a state under this force over mass \[m/s²\].
#[inline(always)]
fn read<P: Plant<N>, T: Lane, const N: usize>(output: Output, state: &[T; N], force: T) -> T {
    match output {
        Output::State(i) => state[i],
        Output::Rate(_) => P::acceleration(state, force),
    }
}

/// The prediction of the EKF.
#[inline(always)]
pub(crate) fn linearised<P: Plant<N>, T: Lane, const N: usize, const E: usize, const M: usize>(
    belief: &Belief<T, N, E>,
    active: &[Active<T>; M],
    force: T,
) -> (Expected<T, N, M>, T::Mask) {
    let zero = force.of(0.0);
    let rate = Row::Full(P::slopes(&belief.mean));
    let (mut jacobian, mut mean) = ([rate; M], [zero; M]);
    let (mut cross, mut cov) = ([[zero; M]; N], [[zero; M]; M]);
    for m in 0..M {
        if let Output::State(i) = active[m].output {
            jacobian[m] = Row::Unit(i);
        }
        mean[m] = read::<P, T, N>(active[m].output, &belief.mean, force);
        let mut column = [zero; N];
        for i in 0..N {
            for j in 0..N {
                column[j] = belief.cov(i, j);
            }
            cross[i][m] = jacobian[m].times(&column);
        }
    }
    for m in 0..M {
        let mut column = [zero; N];
        for i in 0..N {
            column[i] = cross[i][m];
        }
        for i in 0..M {
            cov[i][m] = jacobian[i].times(&column);
        }
        cov[m][m] = cov[m][m] + active[m].variance;
    }
    (Expected { mean, cov, cross, view: View::Linear(jacobian) }, T::always(force.token()))
}

/// The prediction of the UKF, by sigma points that are drawn again; and the lanes for which it holds.
#[inline(always)]
pub(crate) fn by_sigma_points<P: Plant<N>, T: Lane, const N: usize, const E: usize, const M: usize>(
    belief: &Belief<T, N, E>,
    active: &[Active<T>; M],
    force: T,
) -> (Expected<T, N, M>, T::Mask) {
    let zero = force.of(0.0);
    let weight = force.of(1.0 / (2.0 * SPREAD));
    let distance = force.of(SPREAD.sqrt());
    let (root, holds) = lower_root::<T, N, E>(&belief.cov);
    let mut centre = [zero; M];
    for m in 0..M {
        centre[m] = read::<P, T, N>(active[m].output, &belief.mean, force);
    }
    let mut sum = [zero; M];
    let mut cov = [[zero; M]; M];
    let mut cross = [[zero; M]; N];
    for point in 0..N {
        let (mut far, mut above, mut below) = ([zero; N], belief.mean, belief.mean);
        for j in point..N {
            far[j] = root[Triangle::<N>::AT[j][point]] * distance;
        }
        for j in 0..N {
            above[j] = belief.mean[j] + far[j];
            below[j] = belief.mean[j] - far[j];
        }
        let (mut high, mut low) = ([zero; M], [zero; M]);
        for m in 0..M {
            high[m] = read::<P, T, N>(active[m].output, &above, force) - centre[m];
            low[m] = read::<P, T, N>(active[m].output, &below, force) - centre[m];
        }
        for m in 0..M {
            sum[m] = sum[m] + (high[m] + low[m]);
            for i in 0..M {
                cov[i][m] = cov[i][m] + high[i] * high[m];
                cov[i][m] = cov[i][m] + low[i] * low[m];
            }
            for i in point..N {
                cross[i][m] = cross[i][m] + far[i] * (high[m] - low[m]) * weight;
            }
        }
    }
    let (mut shift, mut mean) = (sum, centre);
    for m in 0..M {
        shift[m] = sum[m] * weight;
        mean[m] = centre[m] + shift[m];
    }
    for m in 0..M {
        for i in 0..M {
            cov[i][m] = cov[i][m] * weight + shift[i] * shift[m];
        }
        cov[m][m] = cov[m][m] + active[m].variance;
    }
    (Expected { mean, cov, cross, view: View::Curved }, holds)
}
