//! The linear oscillator.

use super::Equation;
use crate::mathematics::engine::number::Real;

/// `ẍ + 2ζωₙẋ + ωₙ²x = f` with state `[x, v, ωₙ, ζ]`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sdof;

impl Equation for Sdof {
    #[inline(always)]
    fn size(self) -> usize {
        4
    }

    #[inline(always)]
    fn motion(self) -> usize {
        2
    }

    #[inline(always)]
    fn rate<T: Real>(self, state: &[T], force: T, rate: &mut [T]) {
        let &[x, v, wn, zeta, ..] = state else { return };
        rate[0] = v;
        rate[1] = force - zeta * 2.0 * wn * v - wn * wn * x;
    }
}
