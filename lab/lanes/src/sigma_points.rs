//! The prediction of the UKF: [`SigmaPoints`](kalmanscope_core::kernel::SigmaPoints) in lanes.

use crate::belief::{AT, Belief, N, Noise};
use crate::factor::lower_root;
use crate::impulse::Impulse;
use crate::lane::Lane;

/// c², the square of the points' distance in standard deviations.
pub(crate) const SPREAD: f64 = 3.0;

/// Carries the beliefs over one step; returns the lanes for which that holds.
#[inline(always)]
pub(crate) fn predict<T: Lane>(belief: &mut Belief<T>, force: T, dt: f64, noise: &Noise<T>) -> T::Mask {
    predict_by::<T, 2>(belief, noise, |[x, v, wn, zeta]| {
        let (a, b) = (-wn * wn, x.of(-2.0) * zeta * wn);
        let acceleration = force + b * v + a * x;
        let [x, v] = Impulse::runge_kutta(a, b, dt).advance(a, b, [x, v], acceleration);
        [x, v, wn, zeta]
    })
}

/// [`predict`] where the parameters decay.
#[inline(always)]
pub(crate) fn predict_decaying<T: Lane>(belief: &mut Belief<T>, force: T, dt: f64, noise: &Noise<T>) -> T::Mask {
    let (half, whole, sixth) = (force.of(0.5 * dt), force.of(dt), force.of(dt / 6.0));
    let rate = |[x, v, wn, zeta]: [T; N]| {
        let acceleration = force - x.of(2.0) * zeta * wn * v - wn * wn * x;
        [v, acceleration, -noise.eta * wn, -noise.eta * zeta]
    };
    let moved = |state: [T; N], rate: [T; N], dt: T| std::array::from_fn(|i| state[i] + rate[i] * dt);
    // Apart, so that the program has the four stages once and not nine times.
    let step = |state: [T; N]| {
        let k1 = rate(state);
        let k2 = rate(moved(state, k1, half));
        let k3 = rate(moved(state, k2, half));
        let k4 = rate(moved(state, k3, whole));
        let two = force.of(2.0);
        std::array::from_fn(|i| state[i] + (k1[i] + (k2[i] + k3[i]) * two + k4[i]) * sixth)
    };
    predict_by::<T, N>(belief, noise, |state| {
        T::apart(
            force.token(),
            #[inline(always)]
            || step(state),
        )
    })
}

/// By the step of one state, of which the first `MOVING` components change.
#[inline(always)]
fn predict_by<T: Lane, const MOVING: usize>(
    belief: &mut Belief<T>,
    noise: &Noise<T>,
    step: impl Fn([T; N]) -> [T; N],
) -> T::Mask {
    let m = belief.mean;
    let zero = m[0].of(0.0);
    let distance = m[0].of(SPREAD.sqrt());
    let inverse = 1.0 / SPREAD.sqrt();
    let (half, inverse) = (m[0].of(0.5 * inverse), m[0].of(inverse));
    let (lower, holds) = lower_root(&belief.cov);
    let mut root = [[zero; N]; N];
    let centre = step(m);
    let mut curved = [[zero; N]; 2];
    for point in 0..N {
        let (mut high, mut low) = (m, m);
        for j in 0..N {
            root[j][point] = if j >= point { lower[AT[j][point]] } else { zero };
            let far = root[j][point] * distance;
            high[j] = m[j] + far;
            low[j] = m[j] - far;
        }
        let (high, low) = (step(high), step(low));
        for j in 0..2 {
            curved[j][point] = (high[j] + low[j] - zero.of(2.0) * centre[j]) * half;
        }
        for j in 0..MOVING {
            root[j][point] = (high[j] - low[j]) * half;
        }
    }
    let mut mean = centre;
    let mut shift = [zero; 2];
    for j in 0..2 {
        let [c0, c1, c2, c3] = curved[j];
        shift[j] = (zero + c0 + c1 + c2 + c3) * inverse;
        mean[j] = centre[j] + shift[j];
    }
    for j in 0..MOVING {
        for i in j..N {
            let mut sum = zero;
            for k in 0..N {
                // Above the diagonal of what does not move there are zeros.
                if i < MOVING || k <= i {
                    sum = sum + root[i][k] * root[j][k];
                }
            }
            if i < 2 {
                let ([a0, a1, a2, a3], [b0, b1, b2, b3]) = (curved[i], curved[j]);
                let even = zero + a0 * b0 + a2 * b2;
                let odd = zero + a1 * b1 + a3 * b3;
                sum = sum + (even + odd + shift[i] * shift[j]);
            }
            belief.cov[AT[i][j]] = sum;
        }
    }
    belief.mean = mean;
    belief.spread(noise);
    holds
}
