//! Plants, each one function: the rates of the moving components. Jacobians follow from it by [duals](super::dual).

use std::sync::Arc;

use super::dual::Dual;
use super::level::{Baseline, Level};
use super::list::List;
use super::number::{Number, Real};
use crate::PlantKind;

/// The equation of a plant with the state `y = [motion, parameters]`.
pub(crate) trait RateFunction<T>: Copy {
    /// The compiler knows the number of components, at most [`FEW`].
    const IS_SMALL: bool = true;

    /// The number of components, and of those that move, which come first.
    fn sizes(self) -> [usize; 2];

    /// The rates of the components that move, each in its unit per second, under a force over mass \[m/s²\], which enters additively.
    fn rate(self, state: &[T], force: T, rate: &mut [T]);
}

/// A plant that the engine has.
#[derive(Clone, Debug, PartialEq)]
pub enum EnginePlant {
    Sdof(Sdof),
    /// The oscillator with a cubic spring.
    Duffing(Duffing),
    /// The oscillator with a hysteretic spring, exponent 2.
    BoucWen(BoucWen<false>),
    /// The same with exponent 1.
    BoucWenOne(BoucWen<true>),
    ShearChain(ShearChain),
    Typed(Arc<Typed>),
    /// A plant of a program's own, which knows plain numbers only.
    Own(Own),
}

/// The second expression is for a plant of the calling program, which has no equation.
macro_rules! with_equation {
    ($plant:expr, $equation:ident => $do:expr) => {
        $crate::engine::plants::with_equation!($plant, $equation => $do, $equation => $do)
    };
    ($plant:expr, $equation:ident => $do:expr, $own:pat => $other:expr) => {{
        use $crate::engine::plants::EnginePlant;
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
    }};
}

pub(super) use with_equation;

impl EnginePlant {
    /// The number of components.
    pub fn size(&self) -> usize {
        with_equation!(self, equation => RateFunction::<f64>::sizes(equation)[0])
    }

    /// The number of components that move.
    #[inline(always)]
    pub fn motion(&self) -> usize {
        with_equation!(self, equation => RateFunction::<f64>::sizes(equation)[1])
    }

    /// Whether the motion is `[x, v]` with `ẋ = v`: its linear step has a closed form.
    #[inline(always)]
    pub fn is_oscillator(&self) -> bool {
        match self {
            Self::Sdof(_) | Self::Duffing(_) => true,
            Self::Typed(typed) => typed.motion == 2,
            _ => false,
        }
    }

    /// Of a plant whose motion is `[x, v]` of several masses, with `ẋ = v`: their number, and the largest distance of two masses in
    /// their row that act on each other.
    pub fn coupling(&self) -> Option<[usize; 2]> {
        match self {
            Self::ShearChain(chain) => Some([chain.masses, 1]),
            Self::Typed(typed) if typed.masses > 1 && typed.motion == 2 * typed.masses => {
                Some([typed.masses, typed.reach()])
            }
            _ => None,
        }
    }

    #[inline(always)]
    pub(crate) fn linearise<T: Number, L: Level>(&self, level: L, state: &[T], force: T, out: Slopes<'_, T>) {
        match self {
            &Self::Sdof(equation) => linearise(level, equation, state, force, out),
            &Self::Duffing(equation) => linearise(level, equation, state, force, out),
            &Self::BoucWen(equation) => linearise(level, equation, state, force, out),
            &Self::BoucWenOne(equation) => linearise(level, equation, state, force, out),
            Self::ShearChain(chain) => chain.linearise(state, force, out),
            Self::Typed(typed) => typed.linearise(state, force, out),
            Self::Own(own) => own.linearise(state, force, out),
        }
    }

    pub(crate) fn rate(&self, state: &[f64], force: f64, rate: &mut [f64]) {
        with_equation!(self, equation => equation.rate(state, force, rate));
    }

    /// The Jacobian, row by row.
    pub(crate) fn jacobian(&self, state: &[f64], out: &mut [f64]) {
        let (own, motion) = (self.size(), self.motion());
        let (mut rate, mut columns) = (vec![0.0; motion], vec![0.0; motion * own]);
        let slopes = Slopes { rate: &mut rate, columns: &mut columns, rows: motion };
        self.linearise(Baseline, state, 0.0, slopes);
        for (i, row) in out.chunks_exact_mut(own).enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                *entry = columns[j * motion + i];
            }
        }
    }

    /// The derivatives of the rates by the force, which do not depend on the state.
    pub fn by_force(&self) -> Vec<f64> {
        let state = vec![1.0; self.size()];
        let [mut with, mut without] = [vec![0.0; self.motion()], vec![0.0; self.motion()]];
        with_equation!(self, equation => {
            equation.rate(&state, 1.0, &mut with);
            equation.rate(&state, 0.0, &mut without);
        });
        with.iter().zip(without).map(|(with, without)| with - without).collect()
    }
}

pub(crate) const AT_ONCE: usize = 4;

/// Limits the components of a small plant: twice the derivatives that are taken at once.
pub(crate) const FEW: usize = 8;

/// The compiler leaves out plants of other sizes than the filter's.
#[inline(always)]
pub(super) fn fits<T, L: Level>(level: L, equation: impl RateFunction<T>) -> bool {
    let [own, motion] = equation.sizes();
    own <= level.size(own) && motion <= level.moving(motion)
}

/// The rates, and their derivatives by the plant's components, column by column, `rows` numbers a column.
pub(crate) struct Slopes<'a, T> {
    pub(crate) rate: &'a mut [T],
    pub(crate) columns: &'a mut [T],
    pub(crate) rows: usize,
}

#[inline(always)]
fn linearise<T: Number, L: Level>(
    level: L,
    equation: impl RateFunction<Dual<T, AT_ONCE>>,
    state: &[T],
    force: T,
    mut out: Slopes<'_, T>,
) {
    if !fits(level, equation) {
        return;
    }
    // A local array, which the compiler can keep in registers.
    let mut duals = [Dual::constant(T::of(0.0)); 2 * FEW];
    differentiate(equation, state, force, 0, &mut out, &mut duals);
    if equation.sizes()[0] > AT_ONCE {
        differentiate(equation, state, force, AT_ONCE, &mut out, &mut duals);
    }
}

#[inline(always)]
fn differentiate<T: Number>(
    equation: impl RateFunction<Dual<T, AT_ONCE>>,
    state: &[T],
    force: T,
    first: usize,
    out: &mut Slopes<'_, T>,
    duals: &mut [Dual<T, AT_ONCE>],
) {
    let ([own, motion], Slopes { rate, columns, rows }) = (equation.sizes(), out);
    let (duals, rates) = duals.split_at_mut(own);
    let rates = &mut rates[..motion];
    for i in 0..own {
        duals[i] = Dual::variable(state[i], i.wrapping_sub(first));
    }
    equation.rate(duals, Dual::constant(force), rates);
    for k in 0..AT_ONCE.min(own - first) {
        for i in 0..motion {
            columns[(first + k) * *rows + i] = rates[i].derivative(k);
        }
    }
    for i in 0..motion {
        rate[i] = rates[i].value;
    }
}

/// `ẍ + 2ζωₙẋ + ωₙ²x = f` with state `[x, v, ωₙ, ζ]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sdof;

impl<T: Real> RateFunction<T> for Sdof {
    #[inline(always)]
    fn sizes(self) -> [usize; 2] {
        [4, 2]
    }

    #[inline(always)]
    fn rate(self, state: &[T], force: T, rate: &mut [T]) {
        let &[x, v, wn, zeta, ..] = state else { return };
        rate[0] = v;
        rate[1] = force - zeta * 2.0 * wn * v - wn * wn * x;
    }
}

/// `ẍ + 2ζωₙẋ + ωₙ²x + μx³ = f` with state `[x, v, ωₙ, ζ, μ]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Duffing;

impl<T: Real> RateFunction<T> for Duffing {
    #[inline(always)]
    fn sizes(self) -> [usize; 2] {
        [5, 2]
    }

    #[inline(always)]
    fn rate(self, state: &[T], force: T, rate: &mut [T]) {
        let &[x, v, wn, zeta, mu, ..] = state else { return };
        rate[0] = v;
        rate[1] = force - zeta * 2.0 * wn * v - wn * wn * x - mu * x * x * x;
    }
}

/// `ẍ + 2ζωₙẋ + ωₙ²(α x + (1 - α) z) = f`, `ż = ẋ - β |ẋ| |z| z - γ ẋ z²` with state `[x, v, z, ωₙ, ζ, α, β, γ]`; with the exponent
/// one `ż = ẋ - β₁ |ẋ| z - γ₁ ẋ |z|`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoucWen<const IS_ONE: bool>;

impl<T: Real, const IS_ONE: bool> RateFunction<T> for BoucWen<IS_ONE> {
    #[inline(always)]
    fn sizes(self) -> [usize; 2] {
        [8, 3]
    }

    #[inline(always)]
    fn rate(self, state: &[T], force: T, rate: &mut [T]) {
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

/// `ẍᵢ = f - sᵢ + sᵢ₊₁`, with the forces over mass sᵢ of the storeys and state `[x₁ … x_m, v₁ … v_m, κ₁ … κ_m, c]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShearChain {
    /// m, the number of masses.
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
    const IS_SMALL: bool = false;

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
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Own(pub PlantKind);

impl Own {
    fn linearise<T: Number>(&self, state: &[T], force: T, Slopes { rate, columns, rows }: Slopes<'_, T>) {
        self.rate(state, force, rate);
        let Self(kind) = self;
        let (own, motion) = (kind.channels().len(), kind.motion());
        let (mut numbers, mut jacobian) = (vec![0.0; own], vec![0.0; motion * own]);
        for lane in 0..T::LANES {
            take_lane(state, lane, &mut numbers);
            jacobian.fill(0.0);
            kind.plant().motion_jacobian(&numbers, &mut jacobian);
            for i in 0..motion {
                for j in 0..own {
                    columns[j * rows + i].set_lane(lane, jacobian[i * own + j]);
                }
            }
        }
    }
}

impl<T: Number> RateFunction<T> for &Own {
    const IS_SMALL: bool = false;

    fn sizes(self) -> [usize; 2] {
        [self.0.channels().len(), self.0.motion()]
    }

    fn rate(self, state: &[T], force: T, rate: &mut [T]) {
        let Own(kind) = self;
        let (mut numbers, mut rates) = (vec![0.0; kind.channels().len()], vec![0.0; kind.motion()]);
        for lane in 0..T::LANES {
            take_lane(state, lane, &mut numbers);
            kind.plant().motion_rate(&numbers, force.lane(lane), &mut rates);
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
    fn linearise<T: Real>(&self, state: &[T], force: T, Slopes { rate, columns, rows }: Slopes<'_, T>) {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plants_of_the_registry_have_their_sizes_in_the_engine() {
        assert!(matches!(EnginePlant::of(&PlantKind::SHEAR_10), EnginePlant::ShearChain(ShearChain { masses: 10 })));
        for kind in PlantKind::ALL {
            let plant = EnginePlant::of(&kind);
            let (n, motion) = (kind.channels().len(), kind.motion());
            assert_eq!((plant.size(), plant.motion()), (n, motion), "{kind:?}");
            let velocities = kind.channels()[..motion].iter().map(|channel| channel.rate().is_none());
            let by_force: Vec<f64> = velocities.map(|is_velocity| f64::from(u8::from(is_velocity))).collect();
            let by_force = by_force.iter().enumerate().map(|(i, by)| if motion == 3 && i == 2 { 0.0 } else { *by });
            assert_eq!(plant.by_force(), by_force.collect::<Vec<_>>(), "{kind:?}");
        }
    }
}
