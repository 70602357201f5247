//! The classical Runge-Kutta step.

use crate::lane::Lane;

/// The rates of a state's first M components. A trait and not a closure, since a closure that is not inlined has no vector
/// instructions.
pub(crate) trait Rate<T, const M: usize, const N: usize> {
    fn rate(&self, state: &[T; N]) -> [T; M];
}

/// The state after a step over `dt` \[s\].
#[inline(always)]
pub(crate) fn runge_kutta<T: Lane, const M: usize, const N: usize>(
    rate: &impl Rate<T, M, N>,
    state: &[T; N],
    dt: f64,
) -> [T; N] {
    let of = state[0];
    let half = of.of(0.5 * dt);
    let k1 = rate.rate(state);
    let k2 = rate.rate(&moved(state, k1, half));
    let k3 = rate.rate(&moved(state, k2, half));
    let k4 = rate.rate(&moved(state, k3, of.of(dt)));
    let mut sum = k1;
    for i in 0..M {
        sum[i] = k1[i] + (k2[i] + k3[i]) * of.of(2.0) + k4[i];
    }
    moved(state, sum, of.of(dt / 6.0))
}

/// The state after a time `dt` \[s\] at these rates.
#[inline(always)]
fn moved<T: Lane, const M: usize, const N: usize>(state: &[T; N], rate: [T; M], dt: T) -> [T; N] {
    let mut moved = *state;
    for i in 0..M {
        moved[i] = state[i] + rate[i] * dt;
    }
    moved
}
