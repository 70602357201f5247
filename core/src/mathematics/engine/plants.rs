//! Plants, each one function: the rates of the moving components. Jacobians follow from it by [duals](super::dual).

pub(crate) mod bouc_wen;
pub(crate) mod duffing;
pub(crate) mod own;
pub(crate) mod sdof;
pub(crate) mod shear_chain;
pub(crate) mod typed;

use super::dual::Dual;
use super::level::{Baseline, Level};
use super::number::{Number, Real};
use crate::PlantKind;

/// The equation of a plant with the state `y = [motion, parameters]`.
pub(crate) trait Equation: Copy {
    /// Whether the compiler knows the number of components, which then is at most [`FEW`].
    const IS_SMALL: bool = true;

    /// The number of components.
    fn size(self) -> usize;

    /// The number of components that move, which come first.
    fn motion(self) -> usize;

    /// The rates of the components that move, each in its unit per second, from a state and the force over mass \[m/s²\], which
    /// enters additively.
    fn rate<T: Real>(self, state: &[T], force: T, rate: &mut [T]);
}

/// The rates of a plant for numbers of some kind.
pub(crate) trait Rates<T>: Copy {
    /// The number of components.
    fn components(self) -> usize;

    /// The number of components that move, which come first.
    fn moving(self) -> usize;

    /// [`Equation::IS_SMALL`]
    fn is_small(self) -> bool;

    /// [`Equation::rate`]
    fn rates(self, state: &[T], force: T, rate: &mut [T]);
}

impl<E: Equation, T: Number> Rates<T> for E {
    #[inline(always)]
    fn components(self) -> usize {
        self.size()
    }

    #[inline(always)]
    fn moving(self) -> usize {
        self.motion()
    }

    #[inline(always)]
    fn is_small(self) -> bool {
        Self::IS_SMALL
    }

    #[inline(always)]
    fn rates(self, state: &[T], force: T, rate: &mut [T]) {
        self.rate(state, force, rate);
    }
}

/// A plant that the engine has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plant {
    /// The linear oscillator.
    Sdof,
    /// The oscillator with a cubic spring.
    Duffing,
    /// The oscillator with a hysteretic spring, exponent 2.
    BoucWen,
    /// The same with exponent 1.
    BoucWenOne,
    /// A chain of masses.
    ShearChain(usize),
    /// An equation that a user types.
    Typed(&'static typed::Typed),
    /// A plant of a program's own, which knows plain numbers only.
    Own(own::Own),
}

/// Does something with the equation of a plant, and something else with a plant of a program's own, which has none.
macro_rules! with_equation {
    ($plant:expr, $equation:ident => $do:expr) => {
        $crate::mathematics::engine::plants::with_equation!($plant, $equation => $do, $equation => $do)
    };
    ($plant:expr, $equation:ident => $do:expr, $own:pat => $other:expr) => {
        match $plant {
            $crate::mathematics::engine::plants::Plant::Sdof => {
                let $equation = $crate::mathematics::engine::plants::sdof::Sdof;
                $do
            }
            $crate::mathematics::engine::plants::Plant::Duffing => {
                let $equation = $crate::mathematics::engine::plants::duffing::Duffing;
                $do
            }
            $crate::mathematics::engine::plants::Plant::BoucWen => {
                let $equation = $crate::mathematics::engine::plants::bouc_wen::BoucWen;
                $do
            }
            $crate::mathematics::engine::plants::Plant::BoucWenOne => {
                let $equation = $crate::mathematics::engine::plants::bouc_wen::BoucWenOne;
                $do
            }
            $crate::mathematics::engine::plants::Plant::ShearChain(masses) => {
                let $equation = $crate::mathematics::engine::plants::shear_chain::ShearChain { masses };
                $do
            }
            $crate::mathematics::engine::plants::Plant::Typed(typed) => {
                let $equation = typed;
                $do
            }
            $crate::mathematics::engine::plants::Plant::Own($own) => $other,
        }
    };
}

pub(super) use with_equation;

impl Plant {
    /// The engine's form of a plant.
    pub fn of(kind: PlantKind) -> Self {
        const OTHERS: [(PlantKind, Plant); 4] = [
            (PlantKind::SDOF, Plant::Sdof),
            (PlantKind::DUFFING, Plant::Duffing),
            (PlantKind::BOUC_WEN, Plant::BoucWen),
            (PlantKind::BOUC_WEN_1, Plant::BoucWenOne),
        ];
        if let Some(equation) = kind.own_equation() {
            return Self::Typed(equation.typed());
        }
        if let Some((_, plant)) = OTHERS.into_iter().find(|(other, _)| *other == kind) {
            return plant;
        }
        if kind.is_chain() { Self::ShearChain(kind.masses()) } else { Self::Own(own::Own(kind)) }
    }

    /// The number of components.
    pub fn size(self) -> usize {
        with_equation!(self, equation => Rates::<f64>::components(equation))
    }

    /// The number of components that move.
    #[inline(always)]
    pub fn motion(self) -> usize {
        with_equation!(self, equation => Rates::<f64>::moving(equation))
    }

    /// Whether the motion is `[x, v]` with `ẋ = v`: its linear step has a closed form.
    #[inline(always)]
    pub fn is_oscillator(self) -> bool {
        match self {
            Self::Sdof | Self::Duffing => true,
            Self::Typed(typed) => typed.motion == 2,
            _ => false,
        }
    }

    /// Of a plant whose motion is `[x, v]` of several masses, with `ẋ = v`: their number, and the largest distance of two masses in
    /// their row that act on each other.
    pub fn coupling(self) -> Option<[usize; 2]> {
        match self {
            Self::ShearChain(masses) => Some([masses, 1]),
            Self::Typed(typed) if typed.masses > 1 && typed.motion == 2 * typed.masses => {
                Some([typed.masses, typed.reach()])
            }
            _ => None,
        }
    }

    /// The rates, and their derivatives by the plant's components, column by column, with `rows` numbers a column.
    // A page has this once, to be smaller.
    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    #[cfg_attr(target_arch = "wasm32", inline(never))]
    pub fn linearise<T: Number, L: Level>(
        self,
        level: L,
        state: &[T],
        force: T,
        rate: &mut [T],
        columns: &mut [T],
        rows: usize,
    ) {
        let out = Slopes { rate, columns, rows };
        match self {
            Self::Sdof => linearise(level, sdof::Sdof, state, force, out),
            Self::Duffing => linearise(level, duffing::Duffing, state, force, out),
            Self::BoucWen => linearise(level, bouc_wen::BoucWen, state, force, out),
            Self::BoucWenOne => linearise(level, bouc_wen::BoucWenOne, state, force, out),
            Self::ShearChain(masses) => {
                shear_chain::ShearChain { masses }.linearise(state, force, rate, columns, rows);
            }
            Self::Typed(typed) => typed.linearise(state, force, rate, columns, rows),
            Self::Own(own) => own.linearise(state, force, rate, columns, rows),
        }
    }

    /// The derivatives of the rates by the plant's components, row by row.
    pub(crate) fn jacobian(self, state: &[f64], out: &mut [f64]) {
        let (own, motion) = (self.size(), self.motion());
        let (mut rate, mut columns) = (vec![0.0; motion], vec![0.0; motion * own]);
        self.linearise(Baseline, state, 0.0, &mut rate, &mut columns, motion);
        for (i, row) in out.chunks_exact_mut(own).enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                *entry = columns[j * motion + i];
            }
        }
    }

    /// The derivatives of the rates by the force, which do not depend on the state.
    pub fn by_force(self) -> Vec<f64> {
        let state = vec![1.0; self.size()];
        let [mut with, mut without] = [vec![0.0; self.motion()], vec![0.0; self.motion()]];
        with_equation!(self, equation => {
            equation.rates(&state, 1.0, &mut with);
            equation.rates(&state, 0.0, &mut without);
        });
        with.iter().zip(without).map(|(with, without)| with - without).collect()
    }
}

/// The number of derivatives that are taken at once.
pub(crate) const AT_ONCE: usize = 4;

/// Limits the components of a small plant: twice the derivatives that are taken at once.
pub(crate) const FEW: usize = 8;

/// Whether filters of these sizes can have a plant: the compiler leaves out the others.
#[inline(always)]
pub(super) fn fits<T, L: Level>(level: L, equation: impl Rates<T>) -> bool {
    let (own, motion) = (equation.components(), equation.moving());
    own <= level.size(own) && motion <= level.moving(motion)
}

/// The rates and their derivatives, to be filled: `rows` numbers a column.
struct Slopes<'a, T> {
    rate: &'a mut [T],
    columns: &'a mut [T],
    rows: usize,
}

/// Takes them for a small plant.
#[inline(always)]
fn linearise<E: Equation, T: Number, L: Level>(level: L, equation: E, state: &[T], force: T, mut out: Slopes<'_, T>) {
    let own = equation.size();
    if !fits::<T, L>(level, equation) {
        return;
    }
    // A local array, which the compiler can keep in registers.
    let mut duals = [Dual::constant(T::of(0.0)); 2 * FEW];
    differentiate(equation, state, force, 0, &mut out, &mut duals);
    if own > AT_ONCE {
        differentiate(equation, state, force, AT_ONCE, &mut out, &mut duals);
    }
}

/// Takes the derivatives by some components, from the first of them on.
#[inline(always)]
fn differentiate<E: Equation, T: Number>(
    equation: E,
    state: &[T],
    force: T,
    first: usize,
    out: &mut Slopes<'_, T>,
    duals: &mut [Dual<T, AT_ONCE>],
) {
    let (own, motion, Slopes { rate, columns, rows }) = (equation.size(), equation.motion(), out);
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plants_of_the_registry_have_their_sizes_in_the_engine() {
        assert!(matches!(Plant::of(PlantKind::SHEAR_10), Plant::ShearChain(10)));
        for kind in PlantKind::ALL {
            let plant = Plant::of(kind);
            let (n, motion) = (kind.channels().len(), kind.motion());
            assert_eq!((plant.size(), plant.motion()), (n, motion), "{kind:?}");
            let velocities = kind.channels()[..motion].iter().map(|channel| channel.rate().is_none());
            let by_force: Vec<f64> = velocities.map(|is_velocity| f64::from(u8::from(is_velocity))).collect();
            let by_force = by_force.iter().enumerate().map(|(i, by)| if motion == 3 && i == 2 { 0.0 } else { *by });
            assert_eq!(plant.by_force(), by_force.collect::<Vec<_>>(), "{kind:?}");
        }
    }
}
