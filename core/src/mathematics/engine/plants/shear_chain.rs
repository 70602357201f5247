//! A chain of masses connected by springs and dampers.

use super::Equation;
use crate::mathematics::engine::dual::Dual;
use crate::mathematics::engine::number::{Number, Real};

/// `ẍᵢ = f - sᵢ + sᵢ₊₁`, with the forces over mass sᵢ of the storeys and state `[x₁ … x_m, v₁ … v_m, κ₁ … κ_m, c]`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShearChain {
    /// m, the number of masses.
    pub masses: usize,
}

/// `s = κ δ + c δ'` with the drift δ between a mass and the one below it, from x, v, κ, c, x and v of the one below.
#[inline(always)]
fn storey<T: Real>([x, v, stiffness, damping, below, rate_below]: [T; 6]) -> T {
    stiffness * (x - below) + damping * (v - rate_below)
}

impl ShearChain {
    /// The places of the numbers of a storey. The last two are those of the mass below, if there is one.
    #[inline(always)]
    fn places(self, i: usize) -> [usize; 6] {
        let m = self.masses;
        [i, m + i, 2 * m + i, 3 * m, i.wrapping_sub(1), m + i - 1]
    }

    /// The numbers of a storey. Below the first one is the ground, which stands still.
    #[inline(always)]
    fn numbers<T: Real>(state: &[T], i: usize, places: [usize; 6]) -> [T; 6] {
        let mut numbers = [T::of(0.0); 6];
        for k in 0..if i > 0 { 6 } else { 4 } {
            numbers[k] = state[places[k]];
        }
        numbers
    }

    /// The rates, and their derivatives by the components, column by column, with `rows` numbers a column.
    #[inline(always)]
    pub(super) fn linearise<T: Number>(self, state: &[T], force: T, rate: &mut [T], columns: &mut [T], rows: usize) {
        let m = self.masses;
        for column in columns[..(3 * m + 1) * rows].chunks_exact_mut(rows) {
            column[..2 * m].fill(T::of(0.0));
        }
        for i in 0..m {
            let places = self.places(i);
            let numbers = Self::numbers(state, i, places);
            let mut duals = [Dual::<T, 6>::constant(force); 6];
            for k in 0..6 {
                duals[k] = Dual::variable(numbers[k], k);
            }
            let storey = storey(duals);
            rate[i] = state[m + i];
            rate[m + i] = force - storey.value;
            columns[(m + i) * rows + i] = T::of(1.0);
            for k in 0..if i > 0 { 6 } else { 4 } {
                let column = &mut columns[places[k] * rows..][..2 * m];
                column[m + i] = column[m + i] - storey.derivative(k);
                if i > 0 {
                    column[m + i - 1] = column[m + i - 1] + storey.derivative(k);
                }
            }
            if i > 0 {
                rate[m + i - 1] = rate[m + i - 1] + storey.value;
            }
        }
    }
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
        for i in 0..m {
            let storey = storey(Self::numbers(state, i, self.places(i)));
            rate[i] = state[m + i];
            rate[m + i] = force - storey;
            if i > 0 {
                rate[m + i - 1] = rate[m + i - 1] + storey;
            }
        }
    }
}
