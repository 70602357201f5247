//! The linear oscillator.

use kalmanscope_core::internals::kernel::Sdof;

use super::Plant;
use crate::impulse::Impulse;
use crate::lane::Lane;

impl Plant<4> for Sdof {
    #[inline(always)]
    fn acceleration<T: Lane>(&[x, v, wn, zeta]: &[T; 4], force: T) -> T {
        let (a, b) = (-wn * wn, x.of(-2.0) * zeta * wn);
        force + b * v + a * x
    }

    #[inline(always)]
    fn slopes<T: Lane>(&[x, v, wn, zeta]: &[T; 4]) -> [T; 4] {
        [-wn * wn, x.of(-2.0) * zeta * wn, x.of(-2.0) * (wn * x + zeta * v), x.of(-2.0) * wn * v]
    }

    /// The motion is linear within a step, and Runge-Kutta is its Taylor polynomial.
    #[inline(always)]
    fn runge_kutta<T: Lane>(state: &[T; 4], force: T, dt: f64) -> [T; 4] {
        let &[x, v, wn, zeta] = state;
        let [a, b, ..] = Self::slopes(state);
        let [x, v] = Impulse::runge_kutta(a, b, dt).advance(a, b, [x, v], Self::acceleration(state, force));
        [x, v, wn, zeta]
    }
}
