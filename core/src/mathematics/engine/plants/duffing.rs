//! The oscillator with a cubic spring.

use super::Equation;
use crate::mathematics::engine::number::Real;

/// `ẍ + 2ζωₙẋ + ωₙ²x + μx³ = f` with state `[x, v, ωₙ, ζ, μ]`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Duffing;

impl Equation for Duffing {
    #[inline(always)]
    fn size(self) -> usize {
        5
    }

    #[inline(always)]
    fn motion(self) -> usize {
        2
    }

    #[inline(always)]
    fn rate<T: Real>(self, state: &[T], force: T, rate: &mut [T]) {
        let &[x, v, wn, zeta, mu, ..] = state else { return };
        rate[0] = v;
        rate[1] = force - zeta * 2.0 * wn * v - wn * wn * x - mu * x * x * x;
    }
}
