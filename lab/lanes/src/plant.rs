//! The plants with filters that run in lanes, one per file.

mod duffing;
mod sdof;

use std::marker::PhantomData;

use kalmanscope_core::internals::kernel::{Duffing, Oscillator, Sdof};

use crate::lane::Lane;
use crate::runge_kutta::{Rate, runge_kutta};

/// The kernel's oscillator `[x, v, parameters]` in lanes: the same operations in the same order.
pub(crate) trait Plant<const N: usize>: Oscillator<N> + Copy {
    /// The acceleration \[m/s²\] in a state under this force over mass \[m/s²\].
    fn acceleration<T: Lane>(state: &[T; N], force: T) -> T;

    /// The derivatives of the acceleration by each component of the state.
    fn slopes<T: Lane>(state: &[T; N]) -> [T; N];

    /// The state after a Runge-Kutta step over `dt` \[s\] with constant parameters.
    #[inline(always)]
    fn runge_kutta<T: Lane>(state: &[T; N], force: T, dt: f64) -> [T; N] {
        runge_kutta(&Motion { plant: PhantomData::<Self>, force }, state, dt)
    }
}

/// The rates of displacement and velocity under this force over mass \[m/s²\].
struct Motion<P, T> {
    plant: PhantomData<P>,
    force: T,
}

impl<P: Plant<N>, T: Lane, const N: usize> Rate<T, 2, N> for Motion<P, T> {
    #[inline(always)]
    fn rate(&self, state: &[T; N]) -> [T; 2] {
        [state[1], P::acceleration(state, self.force)]
    }
}

/// Something to be done for each plant: of N components, with E entries in the lower triangle of their covariance.
pub(crate) trait Visitor {
    fn visit<P: Plant<N>, const N: usize, const E: usize>(&mut self);
}

/// Calls the visitor with each plant.
pub(crate) fn visit(visitor: &mut impl Visitor) {
    visitor.visit::<Sdof, 4, 10>();
    visitor.visit::<Duffing, 5, 15>();
}
