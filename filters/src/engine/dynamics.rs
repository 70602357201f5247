//! The rates of a plant's state, and their derivatives by [duals](super::dual).

use std::fmt::Debug;

use super::dual::Dual;
use super::level::Level;
use super::number::{Number, Real};

/// An equation of motion `ẏ = g(y, f)` of the state `y = [motion, parameters]`: all that a system of your own needs to be a plant.
pub trait MotionEquation: Copy + Debug + PartialEq + Send + Sync + 'static {
    /// The number of components, and of those that move, which come first.
    const SIZES: [usize; 2];

    /// Whether the motion is `[x, v]` with `ẋ = v`: its linear step has a closed form.
    const IS_OSCILLATOR: bool = false;

    /// The rates of the components that move, each in its unit per second, under a force over mass \[m/s²\], which enters additively.
    fn rate<T: Real>(self, state: &[T], force: T, rate: &mut [T]);
}

/// An equation over one kind of number: a [`MotionEquation`], or one whose sizes are known only while it runs.
pub trait RateFunction<T>: Copy {
    /// The compiler knows the number of components, at most [`FEW`].
    const IS_SMALL: bool = false;

    fn sizes(self) -> [usize; 2];

    fn rate(self, state: &[T], force: T, rate: &mut [T]);
}

impl<T: Real, E: MotionEquation> RateFunction<T> for E {
    const IS_SMALL: bool = E::SIZES[0] <= FEW;

    #[inline(always)]
    fn sizes(self) -> [usize; 2] {
        E::SIZES
    }

    #[inline(always)]
    fn rate(self, state: &[T], force: T, rate: &mut [T]) {
        MotionEquation::rate(self, state, force, rate);
    }
}

/// Work with the equation of a plant, compiled for each equation that a plant may have.
pub trait EquationWork<T> {
    fn with(self, equation: impl RateFunction<T>);
}

/// A plant as the engine sees it: one [`MotionEquation`], or a choice of several.
pub trait Dynamics: Clone + Debug + PartialEq + Send + Sync + 'static {
    /// The number of components, and of those that move, which come first.
    fn sizes(&self) -> [usize; 2];

    /// Whether the motion is `[x, v]` with `ẋ = v`: its linear step has a closed form.
    fn is_oscillator(&self) -> bool;

    /// Of masses in a row with the motion `[x, v]` and `ẋ = v`: their number, and the largest distance of two that act on each other.
    fn coupling(&self) -> Option<[usize; 2]> {
        None
    }

    /// Does some work with the equation. A match on the equation stands outside the work's loops this way.
    fn with_equation<T: Number>(&self, work: impl EquationWork<T>);

    /// The rates in numbers of any kind; false for a plant that takes plain numbers only.
    fn note<T: Real>(&self, state: &[T], force: T, rate: &mut [T]) -> bool;

    /// The rates and their derivatives.
    fn linearise<T: Number, L: Level>(&self, level: L, state: &[T], force: T, out: Slopes<'_, T>);

    /// The rates of the components that move in plain numbers.
    fn motion_rate(&self, state: &[f64], force: f64, rate: &mut [f64]) {
        self.with_equation(PlainRate { state, force, rate });
    }

    /// The derivatives of the rates by the force, which do not depend on the state.
    fn by_force(&self) -> Vec<f64> {
        let [size, motion] = self.sizes();
        let state = vec![1.0; size];
        let [mut with, mut without] = [vec![0.0; motion], vec![0.0; motion]];
        self.motion_rate(&state, 1.0, &mut with);
        self.motion_rate(&state, 0.0, &mut without);
        with.iter().zip(without).map(|(with, without)| with - without).collect()
    }
}

impl<E: MotionEquation> Dynamics for E {
    #[inline(always)]
    fn sizes(&self) -> [usize; 2] {
        E::SIZES
    }

    #[inline(always)]
    fn is_oscillator(&self) -> bool {
        E::IS_OSCILLATOR
    }

    #[inline(always)]
    fn with_equation<T: Number>(&self, work: impl EquationWork<T>) {
        work.with(*self);
    }

    fn note<T: Real>(&self, state: &[T], force: T, rate: &mut [T]) -> bool {
        MotionEquation::rate(*self, state, force, rate);
        true
    }

    #[inline(always)]
    fn linearise<T: Number, L: Level>(&self, level: L, state: &[T], force: T, out: Slopes<'_, T>) {
        linearise(level, *self, state, force, out);
    }
}

struct PlainRate<'a> {
    state: &'a [f64],
    force: f64,
    rate: &'a mut [f64],
}

impl EquationWork<f64> for PlainRate<'_> {
    fn with(self, equation: impl RateFunction<f64>) {
        equation.rate(self.state, self.force, self.rate);
    }
}

const AT_ONCE: usize = 4;

/// Limits the components of a small plant: twice the derivatives that are taken at once.
pub(super) const FEW: usize = 8;

/// The compiler leaves out plants of other sizes than the filter's.
#[inline(always)]
pub(super) fn fits<T, L: Level>(level: L, equation: impl RateFunction<T>) -> bool {
    let [own, motion] = equation.sizes();
    own <= level.size(own) && motion <= level.moving(motion)
}

/// The rates, and their derivatives by the plant's components, column by column, `rows` numbers a column.
pub struct Slopes<'a, T> {
    pub rate: &'a mut [T],
    pub columns: &'a mut [T],
    /// The numbers from one column to the next.
    pub rows: usize,
}

#[inline(always)]
fn linearise<T: Number, L: Level, E: MotionEquation>(
    level: L,
    equation: E,
    state: &[T],
    force: T,
    mut out: Slopes<'_, T>,
) {
    if !fits::<T, L>(level, equation) {
        return;
    }
    if E::SIZES[0] > FEW {
        let mut duals = vec![Dual::constant(T::of(0.0)); E::SIZES[0] + E::SIZES[1]];
        for first in (0..E::SIZES[0]).step_by(AT_ONCE) {
            differentiate(equation, state, force, first, &mut out, &mut duals);
        }
        return;
    }
    // A local array, which the compiler can keep in registers.
    let mut duals = [Dual::constant(T::of(0.0)); 2 * FEW];
    differentiate(equation, state, force, 0, &mut out, &mut duals);
    if E::SIZES[0] > AT_ONCE {
        differentiate(equation, state, force, AT_ONCE, &mut out, &mut duals);
    }
}

#[inline(always)]
fn differentiate<T: Number, E: MotionEquation>(
    equation: E,
    state: &[T],
    force: T,
    first: usize,
    out: &mut Slopes<'_, T>,
    duals: &mut [Dual<T, AT_ONCE>],
) {
    let ([own, motion], Slopes { rate, columns, rows }) = (E::SIZES, out);
    let (duals, rates) = duals.split_at_mut(own);
    let rates = &mut rates[..motion];
    for i in 0..own {
        duals[i] = Dual::variable(state[i], i.wrapping_sub(first));
    }
    MotionEquation::rate(equation, duals, Dual::constant(force), rates);
    for k in 0..AT_ONCE.min(own - first) {
        for i in 0..motion {
            columns[(first + k) * *rows + i] = rates[i].derivative(k);
        }
    }
    for i in 0..motion {
        rate[i] = rates[i].value;
    }
}
