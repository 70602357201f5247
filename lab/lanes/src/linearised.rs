//! The prediction of KF and EKF: [`Linearised`](kalmanscope_core::internals::kernel::Linearised) in lanes.

use crate::belief::{Belief, Noise, Triangle};
use crate::impulse::{DecayingImpulse, Impulse};
use crate::lane::Lane;
use crate::plant::Plant;

/// Carries the beliefs over one step; returns the lanes for which that holds.
#[inline(always)]
pub(crate) fn predict<P: Plant<N>, T: Lane, const N: usize, const E: usize>(
    belief: &mut Belief<T, N, E>,
    force: T,
    dt: f64,
    noise: &Noise<T, N>,
) -> T::Mask {
    let slopes = P::slopes(&belief.mean);
    let (a, b) = (slopes[0], slopes[1]);
    let acceleration = P::acceleration(&belief.mean, force);
    let response = Impulse::new(a, b, dt);
    let [moved, sped] = response.advance(a, b, [belief.mean[0], belief.mean[1]], acceleration);
    let transition = Transition::new(slopes, response, [response.q, response.h]);
    transition.apply(&mut belief.cov, force.of(1.0));
    (belief.mean[0], belief.mean[1]) = (moved, sped);
    belief.spread(noise);
    T::always(force.token())
}

/// [`predict`] where the parameters decay.
#[inline(always)]
pub(crate) fn predict_decaying<P: Plant<N>, T: Lane, const N: usize, const E: usize>(
    belief: &mut Belief<T, N, E>,
    force: T,
    dt: f64,
    noise: &Noise<T, N>,
) -> T::Mask {
    let slopes = P::slopes(&belief.mean);
    let (a, b) = (slopes[0], slopes[1]);
    let rate = P::acceleration(&belief.mean, force);
    let DecayingImpulse { impulse, r, holds } = DecayingImpulse::new(a, b, noise.eta, dt);
    let speed = impulse.h - noise.eta * r;
    let mut share = slopes[2] * belief.mean[2];
    for j in 3..N {
        share = share + slopes[j] * belief.mean[j];
    }
    let [moved, sped] = impulse.advance(a, b, [belief.mean[0], belief.mean[1]], rate - share);
    Transition::new(slopes, impulse, [r, speed]).apply(&mut belief.cov, noise.decay);
    (belief.mean[0], belief.mean[1]) = (moved + r * share, sped + speed * share);
    for j in 2..N {
        belief.mean[j] = belief.mean[j] * noise.decay;
    }
    belief.spread(noise);
    holds
}

/// The first two rows of Φ; the rest is diagonal.
struct Transition<T, const N: usize>([[T; N]; 2]);

impl<T: Lane, const N: usize> Transition<T, N> {
    #[inline(always)]
    fn new(slopes: [T; N], Impulse { h, q }: Impulse<T>, [displaced, sped]: [T; 2]) -> Self {
        let (a, b) = (slopes[0], slopes[1]);
        let one = a.of(1.0);
        let mut rows = [slopes; 2];
        (rows[0][0], rows[0][1]) = (one + a * q, h);
        (rows[1][0], rows[1][1]) = (a * h, one + a * q + b * h);
        for j in 2..N {
            (rows[0][j], rows[1][j]) = (displaced * slopes[j], sped * slopes[j]);
        }
        Self(rows)
    }

    /// `Φ P Φᵀ`, where the parameters decay to this share.
    #[inline(always)]
    fn apply<const E: usize>(&self, cov: &mut [T; E], decay: T) {
        let Self(rows) = self;
        let old = *cov;
        let mut half = [[decay; N]; 2];
        for j in 0..N {
            for i in 0..2 {
                let mut sum = rows[i][0] * old[Triangle::<N>::AT[0][j]];
                for k in 1..N {
                    sum = sum + rows[i][k] * old[Triangle::<N>::AT[k][j]];
                }
                half[i][j] = sum;
            }
        }
        for j in 0..2 {
            for i in j..2 {
                let mut sum = half[i][0] * rows[j][0];
                for k in 1..N {
                    sum = sum + half[i][k] * rows[j][k];
                }
                cov[Triangle::<N>::AT[i][j]] = sum;
            }
            for i in 2..N {
                cov[Triangle::<N>::AT[i][j]] = half[j][i] * decay;
            }
        }
        for j in 2..N {
            for i in j..N {
                cov[Triangle::<N>::AT[i][j]] = old[Triangle::<N>::AT[i][j]] * (decay * decay);
            }
        }
    }
}
