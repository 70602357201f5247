//! Options of a filter. Each wraps a filter, which it sees as a [`Recursion`], and knows of no other option.

mod adapting;
mod considering;
mod jumping;
mod weighing;

pub use adapting::{Adaptation, Adapting};
pub use considering::Considering;
pub(crate) use jumping::Jump;
pub use jumping::{Jumping, Restarting};
pub use weighing::Weighing;

use std::ops::{Deref, DerefMut};

use super::dynamics::Dynamics;
use super::filter::GaussianFilter;
use super::level::{Level, apart};
use super::model::Input;
use super::number::Number;
use super::update::UpdateResult;

/// A step between samples, or a part of one.
#[derive(Clone, Copy, Debug)]
pub struct Span<'a, T> {
    pub share: f64,
    /// The recorded input at its beginning and at its end.
    pub inputs: [Input<'a, T>; 2],
    /// The times of both, from the first sample on \[s\].
    pub times: [f64; 2],
}

/// The readings of a sample.
#[derive(Clone, Copy, Debug)]
pub struct Readings<'a, T> {
    /// The recorded input meanwhile.
    pub(crate) input: Input<'a, T>,
    /// A number for each sensor; NaN where it is missing.
    pub(crate) measured: &'a [T],
    /// The diagonal of R; that of the filter's noise if left out.
    pub(crate) variances: Option<&'a [T]>,
}

/// A filter in whatever options: predict, update, and the belief.
pub trait Recursion<T: Number, P: Dynamics> {
    fn predict(&mut self, span: Span<'_, T>);

    fn update(&mut self, readings: Readings<'_, T>) -> UpdateResult<T>;

    /// The filter within all options, with its belief, its noise and its last update.
    fn filter(&mut self) -> &mut GaussianFilter<T, P>;
}

/// An option: a filter around another.
pub trait Wrapper<T: Number, P: Dynamics>: Send {
    fn predict(&mut self, inner: &mut dyn Recursion<T, P>, span: Span<'_, T>) {
        inner.predict(span);
    }

    fn update(&mut self, inner: &mut dyn Recursion<T, P>, readings: Readings<'_, T>) -> UpdateResult<T> {
        inner.update(readings)
    }

    fn report<'a>(&'a self, _: &mut Learnt<'a, T>) {}

    /// The numbers that it keeps from sample to sample, of which [`Self::restore`] makes a filter that can begin again.
    fn memory(&self) -> &[T] {
        &[]
    }

    fn restore(&mut self, _: &[T]) {}
}

/// The results of the options for the last sample.
#[derive(Clone, Copy, Debug)]
pub struct Learnt<'a, T> {
    /// The weight of each sensor's reading, of a filter that weighs them.
    pub weights: Option<&'a [T]>,
    /// The variance of each R, of a filter that learns its noise.
    pub uncertainty: Option<&'a [T]>,
    pub has_widened: bool,
}

/// A filter in its options, from the inside out.
pub struct Wrapped<T: Number, P> {
    filter: GaussianFilter<T, P>,
    wrappers: Vec<Box<dyn Wrapper<T, P>>>,
}

impl<T: Number, P> Deref for Wrapped<T, P> {
    type Target = GaussianFilter<T, P>;

    fn deref(&self) -> &GaussianFilter<T, P> {
        &self.filter
    }
}

impl<T: Number, P> DerefMut for Wrapped<T, P> {
    fn deref_mut(&mut self) -> &mut GaussianFilter<T, P> {
        &mut self.filter
    }
}

impl<T: Number, P: Dynamics> Wrapped<T, P> {
    pub fn new(
        filter: GaussianFilter<T, P>,
        wrappers: impl IntoIterator<Item = Option<Box<dyn Wrapper<T, P>>>>,
    ) -> Self {
        Self { filter, wrappers: wrappers.into_iter().flatten().collect() }
    }

    pub fn has_options(&self) -> bool {
        !self.wrappers.is_empty()
    }

    #[inline(always)]
    pub fn predict<L: Level>(&mut self, level: L, span: Span<'_, T>) {
        if self.has_options() {
            return self.in_options(level, move |filter| filter.predict(span));
        }
        self.filter.predict(level, span.share, span.inputs);
    }

    #[inline(always)]
    pub fn update<L: Level>(&mut self, level: L, input: Input<'_, T>, measured: &[T]) -> UpdateResult<T> {
        if self.has_options() {
            return self.in_options(level, move |filter| filter.update(Readings { input, measured, variances: None }));
        }
        self.filter.update(level, input, measured, None)
    }

    #[inline(never)]
    fn in_options<L: Level, R>(&mut self, level: L, work: impl FnOnce(&mut dyn Recursion<T, P>) -> R) -> R {
        let Self { filter, wrappers } = self;
        work(&mut Inside { wrappers, plain: &mut AtLevel(level, filter) })
    }

    pub fn learnt(&self) -> Learnt<'_, T> {
        let mut learnt = Learnt { weights: None, uncertainty: None, has_widened: false };
        self.wrappers.iter().for_each(|wrapper| wrapper.report(&mut learnt));
        learnt
    }

    pub fn memory(&self) -> Vec<T> {
        self.wrappers.iter().flat_map(|wrapper| wrapper.memory()).copied().collect()
    }

    pub fn restore(&mut self, mut memory: &[T]) {
        for wrapper in &mut self.wrappers {
            let (own, others) = memory.split_at(wrapper.memory().len());
            wrapper.restore(own);
            memory = others;
        }
    }
}

struct AtLevel<'a, L, T: Number, P>(L, &'a mut GaussianFilter<T, P>);

impl<L: Level, T: Number, P: Dynamics> Recursion<T, P> for AtLevel<'_, L, T, P> {
    fn predict(&mut self, Span { share, inputs, .. }: Span<'_, T>) {
        let Self(level, filter) = self;
        apart!(level, filter.predict(*level, share, inputs));
    }

    fn update(&mut self, Readings { input, measured, variances }: Readings<'_, T>) -> UpdateResult<T> {
        let Self(level, filter) = self;
        apart!(level, filter.update(*level, input, measured, variances))
    }

    fn filter(&mut self) -> &mut GaussianFilter<T, P> {
        self.1
    }
}

struct Inside<'a, T, P> {
    wrappers: &'a mut [Box<dyn Wrapper<T, P>>],
    plain: &'a mut dyn Recursion<T, P>,
}

impl<T: Number, P: Dynamics> Recursion<T, P> for Inside<'_, T, P> {
    fn predict(&mut self, span: Span<'_, T>) {
        let Self { wrappers, plain } = self;
        match wrappers.split_last_mut() {
            Some((outer, wrappers)) => outer.predict(&mut Inside { wrappers, plain: &mut **plain }, span),
            None => plain.predict(span),
        }
    }

    fn update(&mut self, readings: Readings<'_, T>) -> UpdateResult<T> {
        let Self { wrappers, plain } = self;
        match wrappers.split_last_mut() {
            Some((outer, wrappers)) => outer.update(&mut Inside { wrappers, plain: &mut **plain }, readings),
            None => plain.update(readings),
        }
    }

    fn filter(&mut self) -> &mut GaussianFilter<T, P> {
        self.plain.filter()
    }
}
