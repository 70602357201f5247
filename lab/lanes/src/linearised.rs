//! The prediction of KF and EKF: [`Linearised`](kalmanscope_core::kernel::Linearised) in lanes.

use crate::belief::{AT, Belief, N, Noise};
use crate::impulse::{DecayingImpulse, Impulse};
use crate::lane::Lane;

/// Carries the beliefs over one step; returns the lanes for which that holds.
#[inline(always)]
pub(crate) fn predict<T: Lane>(belief: &mut Belief<T>, force: T, dt: f64, noise: &Noise<T>) -> T::Mask {
    let [x, v, wn, zeta] = belief.mean;
    let (a, b) = (-wn * wn, x.of(-2.0) * zeta * wn);
    let acceleration = force + b * v + a * x;
    let response = Impulse::new(a, b, dt);
    let [moved, sped] = response.advance(a, b, [x, v], acceleration);
    let transition = Transition::new(a, b, by_parameters(&belief.mean), response, [response.q, response.h]);
    let one = x.of(1.0);
    transition.apply(&mut belief.cov, one);
    belief.mean = [moved, sped, wn, zeta];
    belief.spread(noise);
    T::always(x.token())
}

/// [`predict`] where the parameters decay.
#[inline(always)]
pub(crate) fn predict_decaying<T: Lane>(belief: &mut Belief<T>, force: T, dt: f64, noise: &Noise<T>) -> T::Mask {
    let [x, v, wn, zeta] = belief.mean;
    let (a, b) = (-wn * wn, x.of(-2.0) * zeta * wn);
    let rate = force - x.of(2.0) * zeta * wn * v - wn * wn * x;
    let by = by_parameters(&belief.mean);
    let DecayingImpulse { impulse, r, holds } = DecayingImpulse::new(a, b, noise.eta, dt);
    let speed = impulse.h - noise.eta * r;
    let share = by[0] * wn + by[1] * zeta;
    let [moved, sped] = impulse.advance(a, b, [x, v], rate - share);
    Transition::new(a, b, by, impulse, [r, speed]).apply(&mut belief.cov, noise.decay);
    belief.mean = [moved + r * share, sped + speed * share, wn * noise.decay, zeta * noise.decay];
    belief.spread(noise);
    holds
}

/// The derivatives of the acceleration by natural frequency and damping ratio.
#[inline(always)]
pub(crate) fn by_parameters<T: Lane>(&[x, v, wn, zeta]: &[T; N]) -> [T; 2] {
    [x.of(-2.0) * (wn * x + zeta * v), x.of(-2.0) * wn * v]
}

/// The first two rows of Φ; the rest is diagonal.
struct Transition<T>([[T; N]; 2]);

impl<T: Lane> Transition<T> {
    #[inline(always)]
    fn new(a: T, b: T, by: [T; 2], Impulse { h, q }: Impulse<T>, [displaced, sped]: [T; 2]) -> Self {
        let one = a.of(1.0);
        Self([
            [one + a * q, h, displaced * by[0], displaced * by[1]],
            [a * h, one + a * q + b * h, sped * by[0], sped * by[1]],
        ])
    }

    /// `Φ P Φᵀ`, where the parameters decay to this share.
    #[inline(always)]
    fn apply(&self, cov: &mut [T; 10], decay: T) {
        let Self(rows) = self;
        let old = *cov;
        let mut half = [[decay; N]; 2];
        for j in 0..N {
            for i in 0..2 {
                let mut sum = rows[i][0] * old[AT[0][j]];
                for k in 1..N {
                    sum = sum + rows[i][k] * old[AT[k][j]];
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
                cov[AT[i][j]] = sum;
            }
            for i in 2..N {
                cov[AT[i][j]] = half[j][i] * decay;
            }
        }
        for j in 2..N {
            for i in j..N {
                cov[AT[i][j]] = old[AT[i][j]] * (decay * decay);
            }
        }
    }
}
