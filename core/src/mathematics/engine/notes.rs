//! A model written down: the operations that its rates and readings take.

use std::cell::RefCell;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::builder::Builder;
use super::list::Node;
use super::model::{Model, read};
use super::number::{Function, Real, operators};
use super::plants::{Equation as _, with_equation};
use crate::mathematics::model::Reading;

/// The rates of a model's moving components and the readings of some sensors, noted in one list. Its inputs are the n components
/// of the state and, after them, the recorded force over mass.
#[derive(Clone, Debug)]
pub struct Notes {
    /// n, the number of components of the state.
    pub size: usize,
    /// The operations.
    pub builder: Builder,
    /// `g(y, F)` of the components that move.
    pub rates: Vec<Node>,
    /// `h(y, f)` of each sensor.
    pub readings: Vec<Node>,
}

impl Notes {
    /// The notes of a model. There are none for logarithms, for a plant that takes plain numbers only, and for more operations than
    /// a list can hold.
    pub fn of(model: &Model, readings: &[Reading]) -> Option<Self> {
        if !model.logarithms.is_empty() {
            return None;
        }
        let builder = RefCell::new(Builder::default());
        let input = |place| Noted::Node(&builder, builder.borrow_mut().input(place));
        let state: Vec<Noted<'_>> = (0..model.size).map(input).collect();
        let force = input(model.size);
        let mut rate = vec![Noted::of(0.0); model.moving()];
        let acting = model.acting(&state, force);
        with_equation!(model.plant, equation => equation.rate(&state, acting, &mut rate), _ => return None);
        model.decay(&state, &mut rate);
        let read = |reading| read(model, reading, &state, &rate, force);
        let readings: Vec<Noted<'_>> = readings.iter().map(read).collect();
        let node = |noted: &Noted<'_>| noted.node(&builder);
        let (rates, readings): (Vec<Node>, Vec<Node>) =
            (rate.iter().map(node).collect(), readings.iter().map(node).collect());
        let builder = builder.into_inner();
        (!builder.is_too_long()).then_some(Self { size: model.size, builder, rates, readings })
    }
}

#[derive(Clone, Copy)]
enum Noted<'a> {
    Constant(f64),
    Node(&'a RefCell<Builder>, Node),
}

impl<'a> Noted<'a> {
    fn node(self, builder: &RefCell<Builder>) -> Node {
        match self {
            Self::Constant(constant) => builder.borrow_mut().constant(constant),
            Self::Node(_, node) => node,
        }
    }

    fn with(
        self,
        other: Self,
        note: impl Fn(&mut Builder, Node, Node) -> Node,
        of_constants: impl Fn(f64, f64) -> f64,
    ) -> Self {
        let list: &'a RefCell<Builder> = match (self, other) {
            (Self::Constant(a), Self::Constant(b)) => return Self::Constant(of_constants(a, b)),
            (Self::Node(list, _), _) | (_, Self::Node(list, _)) => list,
        };
        let (a, b) = (self.node(list), other.node(list));
        Self::Node(list, note(&mut list.borrow_mut(), a, b))
    }
}

operators! {
    ['a] Noted<'a>;
    Add<Self> add = |a, b| a.with(b, Builder::add, |a, b| a + b);
    Sub<Self> sub = |a, b| a.with(b, Builder::subtract, |a, b| a - b);
    Mul<Self> mul = |a, b| a.with(b, Builder::multiply, |a, b| a * b);
    Div<Self> div = |a, b| a.with(b, Builder::divide, |a, b| a / b);
    Add<f64> add = |a, b| a + Self::Constant(b);
    Mul<f64> mul = |a, b| a * Self::Constant(b);
    Neg neg = |a| match a {
        Noted::Constant(a) => Noted::Constant(-a),
        Noted::Node(list, a) => Noted::Node(list, list.borrow_mut().negative(a)),
    };
}

impl Real for Noted<'_> {
    fn of(constant: f64) -> Self {
        Self::Constant(constant)
    }

    fn abs(self) -> Self {
        self.call(Function::Abs)
    }

    fn call(self, function: Function) -> Self {
        match self {
            Self::Constant(a) => Self::Constant(function.of(a)),
            Self::Node(list, a) => Self::Node(list, list.borrow_mut().call(function, a)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mathematics::channel::augment;
    use crate::{Channel, PlantKind, Quantity};

    #[test]
    fn notes_give_the_rates_and_readings_of_the_model() {
        for kind in PlantKind::ALL.into_iter().filter(|kind| kind.channels().len() <= 16) {
            let quantities: Vec<Quantity> = kind.quantities().collect();
            let augmentations = augment::OF_INPUT.into_iter().chain([Channel::UNKNOWN_FORCE, quantities[0].bias()]);
            let book = crate::Model::new(kind).augmented(augmentations).decaying(0.01);
            let readings: Vec<Reading> = quantities.iter().filter_map(|&quantity| book.reading(quantity)).collect();
            let model = Model::of(&book);
            let Notes { builder, rates, readings: noted, .. } = Notes::of(&model, &readings).expect("a built-in plant");
            let outputs: Vec<(usize, Node)> = rates.iter().chain(&noted).copied().enumerate().collect();
            let list = builder.list(model.size + 1, &outputs).expect("a short list");
            let state: Vec<f64> = (0..model.size).map(|i| libm::sin((7 * i + 3) as f64) * 2.0).collect();
            let (mut out, mut rate) = (vec![0.0; outputs.len()], vec![0.0; model.moving()]);
            list.run(&state, 0.7, |place, value| out[place] = value);
            let mut plain = vec![0.0; model.size];
            model.rate(crate::mathematics::engine::level::Baseline, &state, 0.7, &mut plain, &mut rate);
            let read = readings.iter().map(|reading| read(&model, reading, &state, &rate, 0.7));
            let known: Vec<f64> = rate.iter().copied().chain(read).collect();
            for (found, known) in out.iter().zip(&known) {
                assert!((found - known).abs() <= 1e-12 * known.abs().max(1.0), "{kind:?}: {found} and {known}");
            }
        }
    }
}
