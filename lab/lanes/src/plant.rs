//! The plants whose filters go in lanes, one a file.

#[cfg(not(target_arch = "wasm32"))]
mod duffing;
mod sdof;

use kalmanscope_core::kernel::abreast::Oscillator;
#[cfg(not(target_arch = "wasm32"))]
use kalmanscope_core::kernel::plant::duffing::Duffing;
use kalmanscope_core::kernel::plant::sdof::Sdof;

use crate::lane::Lane;

/// The kernel's oscillator `[x, v, parameters]` in lanes: the same operations in the same order.
pub(crate) trait Plant<const N: usize>: Oscillator<N> + Copy {
    /// The acceleration \[m/s²\] in a state under this force over mass \[m/s²\].
    fn acceleration<T: Lane>(state: &[T; N], force: T) -> T;

    /// The derivatives of the acceleration by each component of the state.
    fn slopes<T: Lane>(state: &[T; N]) -> [T; N];

    /// Displacement and velocity after a Runge-Kutta step over `dt` \[s\] with constant parameters.
    #[inline(always)]
    fn runge_kutta<T: Lane>(state: &[T; N], force: T, dt: f64) -> [T; 2] {
        let (half, two) = (force.of(0.5 * dt), force.of(2.0));
        let k1 = motion_rate::<Self, T, N>(state, force);
        let k2 = motion_rate::<Self, T, N>(&moved(state, k1, half), force);
        let k3 = motion_rate::<Self, T, N>(&moved(state, k2, half), force);
        let k4 = motion_rate::<Self, T, N>(&moved(state, k3, force.of(dt)), force);
        let mut sum = k1;
        for i in 0..2 {
            sum[i] = k1[i] + (k2[i] + k3[i]) * two + k4[i];
        }
        let after = moved(state, sum, force.of(dt / 6.0));
        [after[0], after[1]]
    }
}

/// The rates of displacement and velocity. No closure, since one that is not inlined has no vector instructions.
#[inline(always)]
fn motion_rate<P: Plant<N>, T: Lane, const N: usize>(state: &[T; N], force: T) -> [T; 2] {
    [state[1], P::acceleration(state, force)]
}

/// The state whose first `M` components have moved at these rates for a time `dt`.
#[inline(always)]
pub(crate) fn moved<T: Lane, const M: usize, const N: usize>(state: &[T; N], rate: [T; M], dt: T) -> [T; N] {
    let mut moved = *state;
    for i in 0..M {
        moved[i] = state[i] + rate[i] * dt;
    }
    moved
}

/// Something to be done for each plant: of N components, with E entries in the lower triangle of their covariance.
pub(crate) trait Visitor {
    type Error;

    fn visit<P: Plant<N>, const N: usize, const E: usize>(&mut self) -> Result<(), Self::Error>;
}

/// Lets the visitor work with each plant. The page has but one, to stay small.
pub(crate) fn visit<V: Visitor>(visitor: &mut V) -> Result<(), V::Error> {
    visitor.visit::<Sdof, 4, 10>()?;
    #[cfg(not(target_arch = "wasm32"))]
    visitor.visit::<Duffing, 5, 15>()?;
    Ok(())
}
