//! The rates of an equation as lists of operations, for the engine.

use kalmanscope_filters::Real;
use kalmanscope_filters::engine::dynamics::{RateFunction, Slopes};
use kalmanscope_filters::engine::list::List;

/// The plant of an equation that a user types: the rates and their derivatives, as lists of operations.
#[derive(Debug, PartialEq)]
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

    #[inline(always)]
    pub(crate) fn linearise<T: Real>(&self, state: &[T], force: T, Slopes { rate, columns, rows }: Slopes<'_, T>) {
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

impl<T: Real> RateFunction<T> for &Typed {
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
