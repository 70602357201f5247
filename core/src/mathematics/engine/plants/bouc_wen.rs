//! Oscillators with a hysteretic spring.

use super::Equation;
use crate::mathematics::engine::number::Real;

/// `ẍ + 2ζωₙẋ + ωₙ²(α x + (1 - α) z) = f`, `ż = ẋ - β |ẋ| |z| z - γ ẋ z²` with state `[x, v, z, ωₙ, ζ, α, β, γ]`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BoucWen;

impl Equation for BoucWen {
    #[inline(always)]
    fn size(self) -> usize {
        8
    }

    #[inline(always)]
    fn motion(self) -> usize {
        3
    }

    #[inline(always)]
    fn rate<T: Real>(self, state: &[T], force: T, rate: &mut [T]) {
        let &[x, v, z, wn, zeta, alpha, beta, gamma, ..] = state else { return };
        rate[0] = v;
        rate[1] = force - zeta * 2.0 * wn * v - wn * wn * (z + alpha * (x - z));
        rate[2] = v - (beta * (v.abs() * z.abs()) + gamma * (v * z)) * z;
    }
}

/// The same with `ż = ẋ - β₁ |ẋ| z - γ₁ ẋ |z|` and state `[x, v, z, ωₙ, ζ, α, β₁, γ₁]`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BoucWenOne;

impl Equation for BoucWenOne {
    #[inline(always)]
    fn size(self) -> usize {
        8
    }

    #[inline(always)]
    fn motion(self) -> usize {
        3
    }

    #[inline(always)]
    fn rate<T: Real>(self, state: &[T], force: T, rate: &mut [T]) {
        let &[x, v, z, wn, zeta, alpha, beta, gamma, ..] = state else { return };
        rate[0] = v;
        rate[1] = force - zeta * 2.0 * wn * v - wn * wn * (z + alpha * (x - z));
        rate[2] = v - beta * v.abs() * z - gamma * v * z.abs();
    }
}
