//! Collects operations: stores common parts once, computes constants, derives, and writes models down as operations.

use std::cell::RefCell;
use std::collections::HashMap;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::dual;
use super::dynamics::Dynamics;
use super::list::{List, Node, Operation};
use super::model::{Reading, StateModel, read};
use super::number::{Function, Real, operators};

/// Limits the operations of a list, and so the time and the memory that an equation can take.
const LENGTH: usize = 4000;

pub const LARGEST_PRODUCT: f64 = 8.0;

#[derive(Clone, Debug, Default)]
pub struct Builder {
    operations: Vec<Operation>,
    needs: Vec<u64>,
    known: HashMap<Operation, Node>,
    derivatives: HashMap<(Node, u32), Node>,
    without: HashMap<(Node, u64), Node>,
}

impl Builder {
    /// Whether more was asked for than a list can hold; the numbers are then no longer right.
    pub fn is_too_long(&self) -> bool {
        self.operations.len() > LENGTH
    }

    pub fn operations(&self) -> &[Operation] {
        &self.operations
    }

    fn push(&mut self, operation: Operation) -> Node {
        if let Some(&node) = self.known.get(&operation) {
            return node;
        }
        if self.is_too_long() {
            return Node::at(0);
        }
        let node = Node::at(self.operations.len());
        let needs = match operation {
            Operation::Input(input) => 1 << input,
            _ => operation.operands().into_iter().flatten().fold(0, |needs, operand| needs | self.needs(operand)),
        };
        self.operations.push(operation);
        self.needs.push(needs);
        self.known.insert(operation, node);
        node
    }

    /// The inputs on which a number depends, one bit each.
    pub fn needs(&self, node: Node) -> u64 {
        self.needs[node.place()]
    }

    pub fn value(&self, node: Node) -> Option<f64> {
        match self.operations[node.place()] {
            Operation::Constant(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    pub fn constant(&mut self, value: f64) -> Node {
        self.push(Operation::Constant(value.to_bits()))
    }

    /// An input by its number, which is below 64.
    pub fn input(&mut self, input: usize) -> Node {
        self.push(Operation::Input(input as u32))
    }

    pub fn add(&mut self, a: Node, b: Node) -> Node {
        match (self.value(a), self.value(b)) {
            (Some(a), Some(b)) => self.constant(a + b),
            (Some(0.0), _) => b,
            (_, Some(0.0)) => a,
            _ => self.push(Operation::Add(a, b)),
        }
    }

    pub fn subtract(&mut self, a: Node, b: Node) -> Node {
        match (self.value(a), self.value(b)) {
            (Some(a), Some(b)) => self.constant(a - b),
            (Some(0.0), _) => self.negative(b),
            (_, Some(0.0)) => a,
            _ => self.push(Operation::Subtract(a, b)),
        }
    }

    pub fn multiply(&mut self, a: Node, b: Node) -> Node {
        match (self.value(a), self.value(b)) {
            (Some(a), Some(b)) => self.constant(a * b),
            (Some(0.0), _) | (_, Some(0.0)) => self.constant(0.0),
            (Some(1.0), _) => b,
            (_, Some(1.0)) => a,
            _ => self.push(Operation::Multiply(a, b)),
        }
    }

    pub fn divide(&mut self, a: Node, b: Node) -> Node {
        match (self.value(a), self.value(b)) {
            (Some(a), Some(b)) => self.constant(a / b),
            (Some(0.0), _) => a,
            (_, Some(1.0)) => a,
            _ if a == b => self.constant(1.0),
            _ => self.push(Operation::Divide(a, b)),
        }
    }

    pub fn negative(&mut self, a: Node) -> Node {
        match (self.value(a), self.operations[a.place()]) {
            (Some(value), _) => self.constant(-value),
            (_, Operation::Negative(inner)) => inner,
            (_, Operation::Subtract(x, y)) => self.push(Operation::Subtract(y, x)),
            _ => self.push(Operation::Negative(a)),
        }
    }

    pub fn call(&mut self, function: Function, a: Node) -> Node {
        match self.value(a) {
            Some(value) => self.constant(function.of(value)),
            None => self.push(Operation::Call(function, a)),
        }
    }

    /// A power; small whole ones are products.
    pub fn power(&mut self, a: Node, exponent: f64) -> Node {
        let is_product = exponent.fract() == 0.0 && (1.0..=LARGEST_PRODUCT).contains(&exponent);
        match (self.value(a), exponent) {
            (Some(value), _) => self.constant(libm::pow(value, exponent)),
            (_, 0.0) => self.constant(1.0),
            _ if is_product => (1..exponent as usize).fold(a, |product, _| self.multiply(product, a)),
            _ if exponent < 0.0 => {
                let (one, inverse) = (self.constant(1.0), self.power(a, -exponent));
                self.divide(one, inverse)
            }
            _ => self.call(Function::Power(exponent.to_bits()), a),
        }
    }

    /// The derivative of a number by an input. That of a sign is zero, also where it jumps.
    pub fn derivative(&mut self, node: Node, by: usize) -> Node {
        if self.needs(node) & (1 << by) == 0 {
            return self.constant(0.0);
        }
        let key = (node, by as u32);
        if let Some(&known) = self.derivatives.get(&key) {
            return known;
        }
        let operation = self.operations[node.place()];
        let derivative = match operation {
            Operation::Constant(_) => self.constant(0.0),
            Operation::Input(_) => self.constant(1.0),
            Operation::Add(..) | Operation::Subtract(..) | Operation::Negative(_) => {
                self.rebuilt(operation, &|builder, a| builder.derivative(a, by))
            }
            Operation::Multiply(a, b) => {
                let (da, db) = (self.derivative(a, by), self.derivative(b, by));
                let (left, right) = (self.multiply(da, b), self.multiply(a, db));
                self.add(left, right)
            }
            Operation::Divide(a, b) => {
                let (da, db) = (self.derivative(a, by), self.derivative(b, by));
                let change = self.multiply(node, db);
                let above = self.subtract(da, change);
                self.divide(above, b)
            }
            Operation::Call(function, a) => {
                let (slope, a) = (self.slope(function, a, node), self.derivative(a, by));
                self.multiply(slope, a)
            }
        };
        self.derivatives.insert(key, derivative);
        derivative
    }

    fn slope(&mut self, function: Function, a: Node, node: Node) -> Node {
        let builder = RefCell::new(std::mem::take(self));
        let slope = dual::slope(function, Noted::Node(&builder, a), Noted::Node(&builder, node)).node(&builder);
        *self = builder.into_inner();
        slope
    }

    /// The number with zero in place of some inputs, one bit each.
    pub fn without(&mut self, node: Node, inputs: u64) -> Node {
        if self.needs(node) & inputs == 0 {
            return node;
        }
        if let Some(&known) = self.without.get(&(node, inputs)) {
            return known;
        }
        let without = match self.operations[node.place()] {
            Operation::Input(_) => self.constant(0.0),
            operation => self.rebuilt(operation, &|builder, a| builder.without(a, inputs)),
        };
        self.without.insert((node, inputs), without);
        without
    }

    fn rebuilt(&mut self, operation: Operation, of: &dyn Fn(&mut Self, Node) -> Node) -> Node {
        let [a, b] = operation.operands().map(|operand| operand.map(|node| of(self, node)));
        let Some(a) = a else { return self.push(operation) };
        let b = b.unwrap_or(a);
        match operation {
            Operation::Constant(_) | Operation::Input(_) => self.push(operation),
            Operation::Add(..) => self.add(a, b),
            Operation::Subtract(..) => self.subtract(a, b),
            Operation::Multiply(..) => self.multiply(a, b),
            Operation::Divide(..) => self.divide(a, b),
            Operation::Negative(_) => self.negative(a),
            Operation::Call(function, _) => self.call(function, a),
        }
    }

    pub fn list(&self, inputs: usize, outputs: &[(usize, Node)]) -> Option<List> {
        List::new(&self.operations, inputs, outputs)
    }
}

/// The rates of a model's moving components and the readings of some sensors. Inputs are the n components, then the force over mass.
#[derive(Clone, Debug)]
pub struct Notes {
    pub size: usize,
    pub builder: Builder,
    /// `g(y, F)` of the components that move.
    pub rates: Vec<Node>,
    /// `h(y, f)` of each sensor.
    pub readings: Vec<Node>,
}

impl Notes {
    /// `None` for logarithms, a plant that takes plain numbers only, and more operations than a list can hold.
    pub fn of(model: &StateModel<impl Dynamics>, readings: &[Reading]) -> Option<Self> {
        if !model.logarithms.is_empty() {
            return None;
        }
        let builder = RefCell::new(Builder::default());
        let input = |place| Noted::Node(&builder, builder.borrow_mut().input(place));
        let state: Vec<Noted<'_>> = (0..model.size).map(input).collect();
        let force = input(model.size);
        let mut rate = vec![Noted::of(0.0); model.moving()];
        let acting = model.acting(&state, force);
        if !model.plant.note(&state, acting, &mut rate) {
            return None;
        }
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
            Self::Node(list, a) => {
                let mut builder = list.borrow_mut();
                let node = match function {
                    // Small whole powers are products.
                    Function::Power(exponent) => builder.power(a, f64::from_bits(exponent)),
                    _ => builder.call(function, a),
                };
                Self::Node(list, node)
            }
        }
    }
}
