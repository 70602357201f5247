//! The prediction of the UKF: [`SigmaPoints`](kalmanscope_core::internals::kernel::SigmaPoints) in lanes.

use std::marker::PhantomData;

use crate::belief::{Belief, Noise, Triangle};
use crate::factor::lower_root;
use crate::lane::Lane;
use crate::plant::Plant;
use crate::runge_kutta::{Rate, runge_kutta};

/// c², the square of the points' distance in standard deviations.
pub(crate) const SPREAD: f64 = 3.0;

/// Carries the beliefs over one step; returns the lanes for which that holds.
#[inline(always)]
pub(crate) fn predict<P: Plant<N>, T: Lane, const N: usize, const E: usize>(
    belief: &mut Belief<T, N, E>,
    force: T,
    dt: f64,
    noise: &Noise<T, N>,
) -> T::Mask {
    predict_by::<T, Held<P, T>, 2, N, E>(belief, noise, &Held { plant: PhantomData, force, dt })
}

/// [`predict`] where the parameters decay.
#[inline(always)]
pub(crate) fn predict_decaying<P: Plant<N>, T: Lane, const N: usize, const E: usize>(
    belief: &mut Belief<T, N, E>,
    force: T,
    dt: f64,
    noise: &Noise<T, N>,
) -> T::Mask {
    predict_by::<T, Decaying<P, T>, N, N, E>(belief, noise, &Decaying { plant: PhantomData, force, dt, eta: noise.eta })
}

/// The step of one state.
trait Step<T, const N: usize> {
    fn step(&self, state: [T; N]) -> [T; N];
}

/// With constant parameters.
struct Held<P, T> {
    plant: PhantomData<P>,
    force: T,
    dt: f64,
}

impl<P: Plant<N>, T: Lane, const N: usize> Step<T, N> for Held<P, T> {
    #[inline(always)]
    fn step(&self, state: [T; N]) -> [T; N] {
        P::runge_kutta(&state, self.force, self.dt)
    }
}

/// With parameters that decay at the rate η.
struct Decaying<P, T> {
    plant: PhantomData<P>,
    force: T,
    dt: f64,
    eta: T,
}

impl<P: Plant<N>, T: Lane, const N: usize> Step<T, N> for Decaying<P, T> {
    /// In its own function, so that the four stages are compiled once and not for each point.
    #[inline(always)]
    fn step(&self, state: [T; N]) -> [T; N] {
        T::apart(
            self.force.token(),
            #[inline(always)]
            || runge_kutta(self, &state, self.dt),
        )
    }
}

impl<P: Plant<N>, T: Lane, const N: usize> Rate<T, N, N> for Decaying<P, T> {
    #[inline(always)]
    fn rate(&self, state: &[T; N]) -> [T; N] {
        let mut rate = *state;
        (rate[0], rate[1]) = (state[1], P::acceleration(state, self.force));
        for j in 2..N {
            rate[j] = -self.eta * state[j];
        }
        rate
    }
}

/// Predicts by `step`, the step of one state. It changes the first `MOVING` components.
#[inline(always)]
fn predict_by<T: Lane, S: Step<T, N>, const MOVING: usize, const N: usize, const E: usize>(
    belief: &mut Belief<T, N, E>,
    noise: &Noise<T, N>,
    motion: &S,
) -> T::Mask {
    let m = belief.mean;
    let zero = m[0].of(0.0);
    let distance = m[0].of(SPREAD.sqrt());
    let inverse = 1.0 / SPREAD.sqrt();
    let (half, inverse) = (m[0].of(0.5 * inverse), m[0].of(inverse));
    let (lower, holds) = lower_root::<T, N, E>(&belief.cov);
    let mut root = [[zero; N]; N];
    let centre = motion.step(m);
    let mut curved = [[zero; N]; 2];
    for point in 0..N {
        let (mut high, mut low) = (m, m);
        for j in 0..N {
            root[j][point] = if j >= point { lower[Triangle::<N>::AT[j][point]] } else { zero };
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
        let mut sum = zero;
        for point in 0..N {
            sum = sum + curved[j][point];
        }
        shift[j] = sum * inverse;
        mean[j] = centre[j] + shift[j];
    }
    for j in 0..MOVING {
        for i in j..N {
            let mut sum = zero;
            for k in 0..N {
                // For components that do not move there are zeros above the diagonal.
                if i < MOVING || k <= i {
                    sum = sum + root[i][k] * root[j][k];
                }
            }
            if i < 2 {
                let mut sums = [zero; 2];
                for k in 0..N {
                    sums[k % 2] = sums[k % 2] + curved[i][k] * curved[j][k];
                }
                sum = sum + (sums[0] + sums[1] + shift[i] * shift[j]);
            }
            belief.cov[Triangle::<N>::AT[i][j]] = sum;
        }
    }
    belief.mean = mean;
    belief.spread(noise);
    holds
}
