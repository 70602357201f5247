//! A chain of masses connected by springs and dampers.

use super::Equation;
use crate::mathematics::engine::number::Real;

/// `ẍᵢ = f - sᵢ + sᵢ₊₁` with `sᵢ = κᵢ (xᵢ - xᵢ₋₁) + c (vᵢ - vᵢ₋₁)` and state `[x₁ … x_m, v₁ … v_m, κ₁ … κ_m, c]`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShearChain {
    /// m, the number of masses.
    pub masses: usize,
}

impl Equation for ShearChain {
    const IS_SMALL: bool = false;

    #[inline(always)]
    fn size(self) -> usize {
        3 * self.masses + 1
    }

    #[inline(always)]
    fn motion(self) -> usize {
        2 * self.masses
    }

    #[inline(always)]
    fn rate<T: Real>(self, state: &[T], force: T, rate: &mut [T]) {
        let m = self.masses;
        let damping = state[3 * m];
        for i in 0..m {
            let (x, v) = (state[i], state[m + i]);
            let (drift, drift_rate) = if i == 0 { (x, v) } else { (x - state[i - 1], v - state[m + i - 1]) };
            let storey = state[2 * m + i] * drift + damping * drift_rate;
            rate[i] = v;
            rate[m + i] = force - storey;
            if i > 0 {
                rate[m + i - 1] = rate[m + i - 1] + storey;
            }
        }
    }
}
