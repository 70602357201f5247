//! Numbers that carry derivatives: the Jacobian of a plant from its equation.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::number::{Function, Number, Real, operators, unrolled};

/// A number and its K derivatives; `on` marks those that may differ from zero, so that inlined operations leave out the others.
#[derive(Clone, Copy, Debug)]
pub struct Dual<T, const K: usize> {
    pub value: T,
    part: [T; K],
    on: [bool; K],
}

impl<T: Number, const K: usize> Dual<T, K> {
    #[inline(always)]
    pub fn constant(value: T) -> Self {
        Self { value, part: [value; K], on: [false; K] }
    }

    #[inline(always)]
    pub fn variable(value: T, k: usize) -> Self {
        let mut dual = Self::constant(value);
        if k < K {
            (dual.part[k], dual.on[k]) = (T::of(1.0), true);
        }
        dual
    }

    #[inline(always)]
    pub fn derivative(&self, k: usize) -> T {
        if self.on[k] { self.part[k] } else { T::of(0.0) }
    }

    // No closures: one that is not inlined has lost its vector instructions.
    #[inline(always)]
    fn each(mut self, value: T, factor: Option<T>) -> Self {
        unrolled::<K>(
            #[inline(always)]
            |k| {
                if self.on[k] {
                    self.part[k] = times(self.part[k], factor);
                }
            },
        );
        self.value = value;
        self
    }

    #[inline(always)]
    fn join(mut self, other: Self, value: T, [first, second]: [Option<T>; 2]) -> Self {
        unrolled::<K>(
            #[inline(always)]
            |k| {
                self.part[k] = match (self.on[k], other.on[k]) {
                    (true, true) => times(self.part[k], first) + times(other.part[k], second),
                    (true, false) => times(self.part[k], first),
                    (false, true) => times(other.part[k], second),
                    (false, false) => self.part[k],
                };
                self.on[k] |= other.on[k];
            },
        );
        self.value = value;
        self
    }
}

#[inline(always)]
fn times<T: Number>(part: T, factor: Option<T>) -> T {
    if let Some(factor) = factor { part * factor } else { part }
}

operators! {
    [T: Number, const K: usize] Dual<T, K>;
    Add<Self> add = |a, b| a.join(b, a.value + b.value, [None; 2]);
    Sub<Self> sub = |a, b| a + -b;
    Mul<Self> mul = |a, b| a.join(b, a.value * b.value, [Some(b.value), Some(a.value)]);
    Add<f64> add = |a, b| a.each(a.value + b, None);
    Mul<f64> mul = |a, b| a.each(a.value * b, Some(T::of(b)));
    Neg neg = |a| a.each(-a.value, Some(T::of(-1.0)));
}

impl<T: Number, const K: usize> Div for Dual<T, K> {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let (quotient, y) = (self.value / other.value, other.value);
        let mut joined = self.join(other, quotient, [None, Some(-quotient)]);
        unrolled::<K>(
            #[inline(always)]
            |k| {
                if joined.on[k] {
                    joined.part[k] = joined.part[k] / y;
                }
            },
        );
        joined
    }
}

impl<T: Number, const K: usize> Real for Dual<T, K> {
    #[inline(always)]
    fn of(constant: f64) -> Self {
        Self::constant(T::of(constant))
    }

    /// At zero the derivative is that from above.
    #[inline(always)]
    fn abs(self) -> Self {
        let sign = self.value.sign();
        self.each(self.value.abs(), Some(sign))
    }

    #[inline(always)]
    fn call(self, function: Function) -> Self {
        let value = self.value.call(function);
        let slope = slope(function, self.value, value);
        self.each(value, Some(slope))
    }
}

/// The derivative of a function at x, where it has this value.
pub(super) fn slope<T: Real>(function: Function, x: T, value: T) -> T {
    let one = T::of(1.0);
    match function {
        Function::Sin => x.call(Function::Cos),
        Function::Cos => -x.call(Function::Sin),
        Function::Tan => value * value + 1.0,
        Function::Exp => value,
        Function::Log => one / x,
        Function::Sqrt => T::of(0.5) / value,
        Function::Abs => x.call(Function::Sign),
        Function::Sign => T::of(0.0),
        Function::Tanh => one - value * value,
        Function::Power(exponent) => {
            let exponent = f64::from_bits(exponent);
            x.call(Function::Power((exponent - 1.0).to_bits())) * exponent
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_those_of_the_rules() {
        let (x, y) = (Dual::<f64, 2>::variable(-1.5, 0), Dual::<f64, 2>::variable(0.7, 1));
        let of = |dual: Dual<f64, 2>| [dual.value, dual.derivative(0), dual.derivative(1)];
        let (a, b) = (-1.5, 0.7);
        assert_eq!(of(x * y), [a * b, b, a]);
        assert_eq!(of(x + y * 2.0), [a + b * 2.0, 1.0, 2.0]);
        assert_eq!(of(x - y), [a - b, 1.0, -1.0]);
        assert_eq!(of(x.abs() + 1.0), [2.5, -1.0, 0.0]);
        let [value, by_x, by_y] = of(x / y);
        assert_eq!(value, a / b);
        assert!((by_x - 1.0 / b).abs() < 1e-15 && (by_y + a / (b * b)).abs() < 1e-15);
        assert_eq!(of(Dual::of(2.0) / y)[1..], [0.0, -(2.0 / b) / b]);
        assert_eq!(of(-(x * x)), [-a * a, -2.0 * a, 0.0]);
    }

    #[test]
    fn derivatives_of_functions_are_their_differences() {
        let powers = [1.5, -2.0].map(|exponent: f64| Function::Power(exponent.to_bits()));
        for function in Function::NAMED.into_iter().map(|(function, _)| function).chain(powers) {
            for x in [0.3, 1.7] {
                let dual = Dual::<f64, 1>::variable(x, 0).call(function);
                let difference = (function.of(x + 1e-6) - function.of(x - 1e-6)) / 2e-6;
                assert_eq!(dual.value, function.of(x));
                assert!(
                    (dual.derivative(0) - difference).abs() < 1e-7 * (1.0 + difference.abs()),
                    "{function:?} at {x}"
                );
            }
        }
    }
}
