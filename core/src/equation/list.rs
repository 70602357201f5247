//! A list of operations: what an equation computes.

use super::builder::{Node, Operation};
use super::function::Function;

/// Numbers that a list keeps at a time.
const REGISTERS: usize = 128;

/// Operations in order, whose results stand in registers that are used again.
#[derive(Clone, Debug)]
pub(super) struct List {
    inputs: usize,
    steps: Vec<Step>,
    /// The place that each output goes to, and its register.
    outputs: Vec<(usize, u8)>,
}

#[derive(Clone, Copy, Debug)]
struct Step {
    what: What,
    a: u8,
    b: u8,
    to: u8,
}

#[derive(Clone, Copy, Debug)]
enum What {
    Constant(f64),
    Add,
    Subtract,
    Multiply,
    Divide,
    Negative,
    Call(Function),
    Power(f64),
}

impl List {
    pub(super) fn new(operations: &[Operation], inputs: usize, outputs: &[(usize, Node)]) -> Option<Self> {
        let uses = |operation: Operation| match operation {
            Operation::Constant(_) | Operation::Input(_) => [None, None],
            Operation::Add(a, b) | Operation::Subtract(a, b) | Operation::Multiply(a, b) | Operation::Divide(a, b) => {
                [Some(a), Some(b)]
            }
            Operation::Negative(a) | Operation::Call(_, a) | Operation::Power(a, _) => [Some(a), None],
        };
        // From the last operation back: what is needed, and by which operation last.
        let mut last: Vec<Option<usize>> = vec![None; operations.len()];
        outputs.iter().for_each(|(_, node)| last[node.place()] = Some(usize::MAX));
        for (place, &operation) in operations.iter().enumerate().rev() {
            if last[place].is_some() {
                for node in uses(operation).into_iter().flatten() {
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
            let what = match operation {
                Operation::Constant(bits) => What::Constant(f64::from_bits(bits)),
                Operation::Input(_) | Operation::Add(..) => What::Add,
                Operation::Subtract(..) => What::Subtract,
                Operation::Multiply(..) => What::Multiply,
                Operation::Divide(..) => What::Divide,
                Operation::Negative(_) => What::Negative,
                Operation::Call(function, _) => What::Call(function),
                Operation::Power(_, exponent) => What::Power(f64::from_bits(exponent)),
            };
            let [a, b] = uses(operation);
            let register = |node: Option<Node>| node.map_or(0, |node| of[node.place()]);
            let (ra, rb) = (register(a), register(b));
            for node in a.into_iter().chain(b.filter(|_| a != b)) {
                if last[node.place()] == Some(place) && usize::from(of[node.place()]) >= inputs {
                    free.push(of[node.place()]);
                }
            }
            let to = free.pop()?;
            of[place] = to;
            steps.push(Step { what, a: ra, b: rb, to });
        }
        let outputs = outputs.iter().map(|(to, node)| (*to, of[node.place()])).collect();
        Some(Self { inputs, steps, outputs })
    }

    /// The number of operations.
    pub(super) fn len(&self) -> usize {
        self.steps.len()
    }

    /// Computes the outputs from the inputs, and writes them to their places.
    pub(super) fn run(&self, inputs: &[f64], last: f64, results: &mut [f64]) {
        let mut registers = [0.0; REGISTERS];
        let first = self.inputs - 1;
        registers[..first].copy_from_slice(&inputs[..first]);
        registers[first] = last;
        for Step { what, a, b, to } in &self.steps {
            let (a, b) = (registers[usize::from(*a) % REGISTERS], registers[usize::from(*b) % REGISTERS]);
            registers[usize::from(*to) % REGISTERS] = match what {
                What::Constant(value) => *value,
                What::Add => a + b,
                What::Subtract => a - b,
                What::Multiply => a * b,
                What::Divide => a / b,
                What::Negative => -a,
                What::Call(function) => function.of(a),
                What::Power(exponent) => libm::pow(a, *exponent),
            };
        }
        for (to, register) in &self.outputs {
            results[*to] = registers[usize::from(*register) % REGISTERS];
        }
    }
}
