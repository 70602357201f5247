//! An equation as a list of operations.

use super::number::{Function, Real};

/// The place of a number in a list.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Node(u32);

impl Node {
    pub fn at(place: usize) -> Self {
        Self(place as u32)
    }

    pub fn place(self) -> usize {
        self.0 as usize
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Operation {
    /// The bits of a constant.
    Constant(u64),
    Input(u32),
    Add(Node, Node),
    Subtract(Node, Node),
    Multiply(Node, Node),
    Divide(Node, Node),
    Negative(Node),
    Call(Function, Node),
}

impl Operation {
    pub fn operands(self) -> [Option<Node>; 2] {
        match self {
            Self::Constant(_) | Self::Input(_) => [None; 2],
            Self::Negative(a) | Self::Call(_, a) => [Some(a), None],
            Self::Add(a, b) | Self::Subtract(a, b) | Self::Multiply(a, b) | Self::Divide(a, b) => [Some(a), Some(b)],
        }
    }
}

const REGISTERS: usize = 128;

/// Operations in order. Their results stand in registers, which are used again.
#[derive(Clone, Debug, PartialEq)]
pub struct List {
    inputs: usize,
    registers: usize,
    steps: Vec<ListStep>,
    outputs: Vec<(usize, u8)>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct ListStep {
    what: What,
    a: u8,
    b: u8,
    to: u8,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum What {
    Constant(f64),
    Add,
    Subtract,
    Multiply,
    Divide,
    Negative,
    Call(Function),
    /// a + c, with a constant c.
    Offset(f64),
    Scale(f64),
}

impl What {
    /// A constant that is added or multiplied needs no register.
    fn of(operation: Operation, operations: &[Operation]) -> (Self, [Option<Node>; 2]) {
        let constant = |node: Node| match operations[node.place()] {
            Operation::Constant(bits) => Some(f64::from_bits(bits)),
            _ => None,
        };
        match operation {
            Operation::Constant(bits) => (Self::Constant(f64::from_bits(bits)), [None, None]),
            Operation::Input(_) => (Self::Add, [None, None]),
            Operation::Add(a, b) => match (constant(a), constant(b)) {
                (_, Some(c)) => (Self::Offset(c), [Some(a), None]),
                (Some(c), None) => (Self::Offset(c), [Some(b), None]),
                (None, None) => (Self::Add, [Some(a), Some(b)]),
            },
            Operation::Subtract(a, b) => match constant(b) {
                Some(c) => (Self::Offset(-c), [Some(a), None]),
                None => (Self::Subtract, [Some(a), Some(b)]),
            },
            Operation::Multiply(a, b) => match (constant(a), constant(b)) {
                (_, Some(c)) => (Self::Scale(c), [Some(a), None]),
                (Some(c), None) => (Self::Scale(c), [Some(b), None]),
                (None, None) => (Self::Multiply, [Some(a), Some(b)]),
            },
            Operation::Divide(a, b) => (Self::Divide, [Some(a), Some(b)]),
            Operation::Negative(a) => (Self::Negative, [Some(a), None]),
            Operation::Call(function, a) => (Self::Call(function), [Some(a), None]),
        }
    }
}

impl List {
    /// The list that computes some outputs, each with its place. `None` if they need more registers than there are.
    pub fn new(operations: &[Operation], inputs: usize, outputs: &[(usize, Node)]) -> Option<Self> {
        let mut last: Vec<Option<usize>> = vec![None; operations.len()];
        outputs.iter().for_each(|(_, node)| last[node.place()] = Some(usize::MAX));
        for (place, &operation) in operations.iter().enumerate().rev() {
            if last[place].is_some() {
                for node in What::of(operation, operations).1.into_iter().flatten() {
                    let entry = &mut last[node.place()];
                    *entry = entry.or(Some(place));
                }
            }
        }
        let mut free: Vec<u8> = (inputs..REGISTERS).rev().filter_map(|register| u8::try_from(register).ok()).collect();
        let mut of = vec![0_u8; operations.len()];
        let mut steps = Vec::new();
        for (place, &operation) in operations.iter().enumerate().filter(|(place, _)| last[*place].is_some()) {
            if let Operation::Input(input) = operation {
                of[place] = u8::try_from(input).ok()?;
                continue;
            }
            let (what, [a, b]) = What::of(operation, operations);
            let register = |node: Option<Node>| node.map_or(0, |node| of[node.place()]);
            let (ra, rb) = (register(a), register(b));
            for node in a.into_iter().chain(b.filter(|_| a != b)) {
                if last[node.place()] == Some(place) && usize::from(of[node.place()]) >= inputs {
                    free.push(of[node.place()]);
                }
            }
            let to = free.pop()?;
            of[place] = to;
            steps.push(ListStep { what, a: ra, b: rb, to });
        }
        let outputs = outputs.iter().map(|(to, node)| (*to, of[node.place()])).collect();
        let used = |step: &ListStep| usize::from(step.to) + 1;
        let registers = steps.iter().map(used).fold(inputs, usize::max);
        Some(Self { inputs, registers, steps, outputs })
    }

    pub fn operations(&self) -> usize {
        self.steps.len()
    }

    pub fn places(&self) -> impl Iterator<Item = usize> {
        self.outputs.iter().map(|(place, _)| *place)
    }

    /// Computes the outputs from the inputs and the last input, `last`, and hands each over with its place.
    #[inline(always)]
    pub fn run<T: Real>(&self, inputs: &[T], last: T, take: impl FnMut(usize, T)) {
        // Each call clears its memory: it has only as much as it needs.
        match self.registers {
            0..=8 => self.run_in::<T, 8>(inputs, last, take),
            9..=16 => self.run_in::<T, 16>(inputs, last, take),
            17..=48 => self.run_in::<T, 48>(inputs, last, take),
            _ => self.run_in::<T, REGISTERS>(inputs, last, take),
        }
    }

    #[inline(always)]
    fn run_in<T: Real, const N: usize>(&self, inputs: &[T], last: T, mut take: impl FnMut(usize, T)) {
        let mut registers = [last; N];
        let first = self.inputs - 1;
        registers[..first].copy_from_slice(&inputs[..first]);
        registers[first] = last;
        for ListStep { what, a, b, to } in &self.steps {
            let (a, b) = (registers[usize::from(*a) % N], registers[usize::from(*b) % N]);
            registers[usize::from(*to) % N] = match what {
                What::Constant(value) => T::of(*value),
                What::Add => a + b,
                What::Subtract => a - b,
                What::Multiply => a * b,
                What::Divide => a / b,
                What::Negative => -a,
                What::Call(function) => a.call(*function),
                What::Offset(c) => a + *c,
                What::Scale(c) => a * *c,
            };
        }
        for (to, register) in &self.outputs {
            take(*to, registers[usize::from(*register) % N]);
        }
    }
}
