//! The plant of an equation that a user types: lists of operations.

use super::Equation;
use crate::mathematics::engine::list::List;
use crate::mathematics::engine::number::Real;

/// The rates of an equation, and their derivatives, as lists of operations.
#[derive(Debug)]
pub struct Typed {
    /// The number of components.
    pub size: usize,
    /// The number of components that move, which come first.
    pub motion: usize,
    /// The number of displacements, which come first; the rates of these are the next components.
    pub masses: usize,
    /// The rates of the moving components, from the components and the force.
    pub rates: List,
    /// The derivatives of the rates that are not zero, to places column by column.
    pub jacobian: List,
}

impl PartialEq for Typed {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}

impl Eq for Typed {}

impl Typed {
    /// The largest distance of two masses that act on each other.
    pub fn reach(&self) -> usize {
        let Self { motion, masses, jacobian, .. } = self;
        let of = |place: usize| {
            let (row, column) = (place % motion, place / motion);
            (row >= *masses && column < *motion).then(|| (row % masses).abs_diff(column % masses))
        };
        jacobian.places().filter_map(of).max().unwrap_or(0)
    }

    /// The rates, and their derivatives by the components, column by column, with `rows` numbers a column.
    #[inline(always)]
    pub fn linearise<T: Real>(&'static self, state: &[T], force: T, rate: &mut [T], columns: &mut [T], rows: usize) {
        self.rate(state, force, rate);
        for column in columns[..self.size * rows].chunks_exact_mut(rows) {
            column[..self.motion].fill(T::of(0.0));
        }
        self.jacobian.run(
            state,
            force,
            #[inline(always)]
            |place, value| columns[place / self.motion * rows + place % self.motion] = value,
        );
    }
}

impl<T: Real> Equation<T> for &'static Typed {
    const IS_SMALL: bool = false;

    #[inline(always)]
    fn sizes(self) -> [usize; 2] {
        [self.size, self.motion]
    }

    #[inline(always)]
    fn rate(self, state: &[T], force: T, rate: &mut [T]) {
        self.rates.run(
            state,
            force,
            #[inline(always)]
            |place, value| rate[place] = value,
        );
    }
}
