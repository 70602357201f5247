//! The equations of plants, each one function: the rates of the moving components. Jacobians follow from it by duals.

use std::any::Any;
use std::fmt;
use std::sync::Arc;

use kalmanscope_filters::engine::dual::Dual;
use kalmanscope_filters::engine::dynamics::{EquationWork, RateFunction, Slopes};
use kalmanscope_filters::engine::level::{Baseline, Level};
use kalmanscope_filters::engine::number::Number;
use kalmanscope_filters::{Dynamics, MotionEquation, Real};

use super::{Plant, motion};
use crate::equation::typed::Typed;

/// A plant as the engine has it.
#[derive(Clone, Debug, PartialEq)]
pub enum EnginePlant {
    Sdof(Sdof),
    Duffing(Duffing),
    BoucWen(BoucWen<false>),
    BoucWenOne(BoucWen<true>),
    ShearChain(ShearChain),
    Typed(Arc<Typed>),
    /// A plant of a program's own, which knows plain numbers only.
    Own(Own),
}

/// The match is expanded where the equation is used: a step has one match, outside its loops.
macro_rules! with_equation {
    ($plant:expr, $equation:ident => $do:expr, $own:ident => $other:expr) => {
        match $plant {
            &EnginePlant::Sdof($equation) => $do,
            &EnginePlant::Duffing($equation) => $do,
            &EnginePlant::BoucWen($equation) => $do,
            &EnginePlant::BoucWenOne($equation) => $do,
            &EnginePlant::ShearChain($equation) => $do,
            EnginePlant::Typed(typed) => {
                let $equation = &**typed;
                $do
            }
            EnginePlant::Own($own) => $other,
        }
    };
}

impl Dynamics for EnginePlant {
    #[inline(always)]
    fn sizes(&self) -> [usize; 2] {
        with_equation!(self, equation => RateFunction::<f64>::sizes(equation), own => RateFunction::<f64>::sizes(own))
    }

    #[inline(always)]
    fn is_oscillator(&self) -> bool {
        match self {
            Self::Sdof(_) | Self::Duffing(_) => true,
            Self::Typed(typed) => typed.motion == 2,
            _ => false,
        }
    }

    fn coupling(&self) -> Option<[usize; 2]> {
        match self {
            Self::ShearChain(chain) => Some([chain.masses, 1]),
            Self::Typed(typed) if typed.masses > 1 && typed.motion == 2 * typed.masses => {
                Some([typed.masses, typed.reach()])
            }
            _ => None,
        }
    }

    #[inline(always)]
    fn with_equation<T: Number>(&self, work: impl EquationWork<T>) {
        with_equation!(self, equation => work.with(equation), own => work.with(own));
    }

    fn note<T: Real>(&self, state: &[T], force: T, rate: &mut [T]) -> bool {
        with_equation!(self, equation => RateFunction::rate(equation, state, force, rate), _own => return false);
        true
    }

    #[inline(always)]
    fn linearise<T: Number, L: Level>(&self, level: L, state: &[T], force: T, out: Slopes<'_, T>) {
        match self {
            Self::Sdof(equation) => Dynamics::linearise(equation, level, state, force, out),
            Self::Duffing(equation) => Dynamics::linearise(equation, level, state, force, out),
            Self::BoucWen(equation) => Dynamics::linearise(equation, level, state, force, out),
            Self::BoucWenOne(equation) => Dynamics::linearise(equation, level, state, force, out),
            Self::ShearChain(chain) => chain.linearise(state, force, out),
            Self::Typed(typed) => typed.linearise(state, force, out),
            Self::Own(own) => own.linearise(state, force, out),
        }
    }
}

impl EnginePlant {
    /// `∂gᵢ/∂yⱼ` of the components that move, row by row. At kinks, as that of |v|, the derivatives are those for positive numbers.
    pub(crate) fn jacobian(&self, state: &[f64], out: &mut [f64]) {
        let [own, motion] = self.sizes();
        let (mut rate, mut columns) = (vec![0.0; motion], vec![0.0; motion * own]);
        let slopes = Slopes { rate: &mut rate, columns: &mut columns, rows: motion };
        self.linearise(Baseline, state, 0.0, slopes);
        for (i, row) in out.chunks_exact_mut(own).enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                *entry = columns[j * motion + i];
            }
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sdof;

impl MotionEquation for Sdof {
    const SIZES: [usize; 2] = [4, 2];
    const IS_OSCILLATOR: bool = true;

    #[inline(always)]
    fn rate<T: Real>(self, state: &[T], force: T, rate: &mut [T]) {
        let &[x, v, wn, zeta, ..] = state else { return };
        rate[0] = v;
        rate[1] = force - zeta * 2.0 * wn * v - wn * wn * x;
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Duffing;

impl MotionEquation for Duffing {
    const SIZES: [usize; 2] = [5, 2];
    const IS_OSCILLATOR: bool = true;

    #[inline(always)]
    fn rate<T: Real>(self, state: &[T], force: T, rate: &mut [T]) {
        let &[x, v, wn, zeta, mu, ..] = state else { return };
        rate[0] = v;
        rate[1] = force - zeta * 2.0 * wn * v - wn * wn * x - mu * x * x * x;
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoucWen<const IS_ONE: bool>;

impl<const IS_ONE: bool> MotionEquation for BoucWen<IS_ONE> {
    const SIZES: [usize; 2] = [8, 3];

    #[inline(always)]
    fn rate<T: Real>(self, state: &[T], force: T, rate: &mut [T]) {
        let &[x, v, z, wn, zeta, alpha, beta, gamma, ..] = state else { return };
        rate[0] = v;
        rate[1] = force - zeta * 2.0 * wn * v - wn * wn * (z + alpha * (x - z));
        rate[2] = if IS_ONE {
            v - beta * v.abs() * z - gamma * v * z.abs()
        } else {
            v - (beta * (v.abs() * z.abs()) + gamma * (v * z)) * z
        };
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShearChain {
    pub masses: usize,
}

/// `s = κ δ + c δ'` with the drift δ between a mass and the one below it.
#[inline(always)]
fn storey<T: Real>([x, v, stiffness, damping, below, rate_below]: [T; 6]) -> T {
    stiffness * (x - below) + damping * (v - rate_below)
}

impl ShearChain {
    #[inline(always)]
    fn places(self, i: usize) -> [usize; 6] {
        let m = self.masses;
        [i, m + i, 2 * m + i, 3 * m, i.wrapping_sub(1), m + i - 1]
    }

    #[inline(always)]
    fn numbers<T: Real>(state: &[T], i: usize, places: [usize; 6]) -> [T; 6] {
        let mut numbers = [T::of(0.0); 6];
        for k in 0..if i > 0 { 6 } else { 4 } {
            numbers[k] = state[places[k]];
        }
        numbers
    }

    #[inline(always)]
    fn linearise<T: Number>(self, state: &[T], force: T, Slopes { rate, columns, rows }: Slopes<'_, T>) {
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

impl<T: Real> RateFunction<T> for ShearChain {
    #[inline(always)]
    fn sizes(self) -> [usize; 2] {
        [3 * self.masses + 1, 2 * self.masses]
    }

    #[inline(always)]
    fn rate(self, state: &[T], force: T, rate: &mut [T]) {
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

/// A plant that is called lane by lane, with its Jacobian by hand.
#[derive(Clone, Copy)]
pub struct Own(pub &'static dyn Plant);

impl fmt::Debug for Own {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0.info().key)
    }
}

impl PartialEq for Own {
    fn eq(&self, other: &Self) -> bool {
        let [own, other]: [(&str, &dyn Any); 2] = [self.0, other.0].map(|plant| (plant.info().key, plant as _));
        own.0 == other.0 && own.1.type_id() == other.1.type_id()
    }
}

impl Own {
    fn linearise<T: Number>(&self, state: &[T], force: T, Slopes { rate, columns, rows }: Slopes<'_, T>) {
        self.rate(state, force, rate);
        let [own, motion] = RateFunction::<T>::sizes(self);
        let (mut numbers, mut jacobian) = (vec![0.0; own], vec![0.0; motion * own]);
        for lane in 0..T::LANES {
            take_lane(state, lane, &mut numbers);
            jacobian.fill(0.0);
            self.0.motion_jacobian(&numbers, &mut jacobian);
            for i in 0..motion {
                for j in 0..own {
                    columns[j * rows + i].set_lane(lane, jacobian[i * own + j]);
                }
            }
        }
    }
}

impl<T: Number> RateFunction<T> for &Own {
    fn sizes(self) -> [usize; 2] {
        let channels = self.0.info().channels;
        [channels.len(), motion(channels)]
    }

    fn rate(self, state: &[T], force: T, rate: &mut [T]) {
        let [own, motion] = RateFunction::<T>::sizes(self);
        let (mut numbers, mut rates) = (vec![0.0; own], vec![0.0; motion]);
        for lane in 0..T::LANES {
            take_lane(state, lane, &mut numbers);
            self.0.motion_rate(&numbers, force.lane(lane), &mut rates);
            for (rate, own) in rate.iter_mut().zip(&rates) {
                rate.set_lane(lane, *own);
            }
        }
    }
}

fn take_lane<T: Number>(state: &[T], lane: usize, numbers: &mut [f64]) {
    for (number, own) in numbers.iter_mut().zip(state) {
        *number = own.lane(lane);
    }
}
