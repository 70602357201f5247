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
    predict_by::<T, Held<T>, 2>(belief, noise, &Held { force, dt })
}

/// [`predict`] where the parameters decay.
#[inline(always)]
pub(crate) fn predict_decaying<T: Lane>(belief: &mut Belief<T>, force: T, dt: f64, noise: &Noise<T>) -> T::Mask {
    predict_by::<T, Decaying<T>, N>(belief, noise, &Decaying { force, dt, eta: noise.eta })
}

/// The step of one state. A trait and not a closure, since a closure that is not inlined has no vector instructions.
trait Step<T> {
    fn step(&self, state: [T; N]) -> [T; N];
}

/// With parameters that stay as they are.
struct Held<T> {
    force: T,
    dt: f64,
}

impl<T: Lane> Step<T> for Held<T> {
    #[inline(always)]
    fn step(&self, [x, v, wn, zeta]: [T; N]) -> [T; N] {
        let (a, b) = (-wn * wn, x.of(-2.0) * zeta * wn);
        let acceleration = self.force + b * v + a * x;
        let [x, v] = Impulse::runge_kutta(a, b, self.dt).advance(a, b, [x, v], acceleration);
        [x, v, wn, zeta]
    }
}

/// With parameters that decay at the rate η.
struct Decaying<T> {
    force: T,
    dt: f64,
    eta: T,
}

impl<T: Lane> Step<T> for Decaying<T> {
    /// Apart, so that the program has the four stages once and not nine times.
    #[inline(always)]
    fn step(&self, state: [T; N]) -> [T; N] {
        T::apart(
            self.force.token(),
            #[inline(always)]
            || self.runge_kutta(state),
        )
    }
}

impl<T: Lane> Decaying<T> {
    #[inline(always)]
    fn runge_kutta(&self, state: [T; N]) -> [T; N] {
        let of = self.force;
        let half = of.of(0.5 * self.dt);
        let k1 = self.rate(state);
        let k2 = self.rate(moved(state, k1, half));
        let k3 = self.rate(moved(state, k2, half));
        let k4 = self.rate(moved(state, k3, of.of(self.dt)));
        let mut sum = k1;
        for i in 0..N {
            sum[i] = k1[i] + (k2[i] + k3[i]) * of.of(2.0) + k4[i];
        }
        moved(state, sum, of.of(self.dt / 6.0))
    }

    #[inline(always)]
    fn rate(&self, [x, v, wn, zeta]: [T; N]) -> [T; N] {
        let acceleration = self.force - x.of(2.0) * zeta * wn * v - wn * wn * x;
        [v, acceleration, -self.eta * wn, -self.eta * zeta]
    }
}

#[inline(always)]
fn moved<T: Lane>(mut state: [T; N], rate: [T; N], dt: T) -> [T; N] {
    for i in 0..N {
        state[i] = state[i] + rate[i] * dt;
    }
    state
}

/// By the step of one state, of which the first `MOVING` components change.
#[inline(always)]
fn predict_by<T: Lane, S: Step<T>, const MOVING: usize>(
    belief: &mut Belief<T>,
    noise: &Noise<T>,
    motion: &S,
) -> T::Mask {
    let m = belief.mean;
    let zero = m[0].of(0.0);
    let distance = m[0].of(SPREAD.sqrt());
    let inverse = 1.0 / SPREAD.sqrt();
    let (half, inverse) = (m[0].of(0.5 * inverse), m[0].of(inverse));
    let (lower, holds) = lower_root(&belief.cov);
    let mut root = [[zero; N]; N];
    let centre = motion.step(m);
    let mut curved = [[zero; N]; 2];
    for point in 0..N {
        let (mut high, mut low) = (m, m);
        for j in 0..N {
            root[j][point] = if j >= point { lower[AT[j][point]] } else { zero };
            let far = root[j][point] * distance;
            high[j] = m[j] + far;
            low[j] = m[j] - far;
        }
        let (high, low) = (motion.step(high), motion.step(low));
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
