//! The number of one run, and numbers side by side as arrays: straight lines of code that become vector instructions.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use super::number::{Function, Mask, Number, Real, one_point, operators};

/// The numbers of L runs.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct Lanes<const L: usize>(pub [f64; L]);

/// Truth values of L runs: all bits of a lane are ones, or none, as the comparisons of vector units have it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct Bits<const L: usize>([u64; L]);

impl<const L: usize> Lanes<L> {
    #[inline(always)]
    fn map(mut self, f: impl Fn(f64) -> f64) -> Self {
        for lane in 0..L {
            self.0[lane] = f(self.0[lane]);
        }
        self
    }

    #[inline(always)]
    fn with(mut self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        for lane in 0..L {
            self.0[lane] = f(self.0[lane], other.0[lane]);
        }
        self
    }

    #[inline(always)]
    fn compare(self, other: Self, f: impl Fn(f64, f64) -> bool) -> Bits<L> {
        let mut bits = [0; L];
        for lane in 0..L {
            bits[lane] = if f(self.0[lane], other.0[lane]) { !0 } else { 0 };
        }
        Bits(bits)
    }
}

impl<const L: usize> Bits<L> {
    #[inline(always)]
    fn with(mut self, other: Self, f: impl Fn(u64, u64) -> u64) -> Self {
        for lane in 0..L {
            self.0[lane] = f(self.0[lane], other.0[lane]);
        }
        self
    }
}

operators! {
    [const L: usize] Lanes<L>;
    Add<Self> add = |a, b| a.with(b, |a, b| a + b);
    Sub<Self> sub = |a, b| a.with(b, |a, b| a - b);
    Mul<Self> mul = |a, b| a.with(b, |a, b| a * b);
    Div<Self> div = |a, b| a.with(b, |a, b| a / b);
    Add<f64> add = |a, b| a.map(|a| a + b);
    Mul<f64> mul = |a, b| a.map(|a| a * b);
    Neg neg = |a| a.map(|a| -a);
}

operators! {
    [const L: usize] Bits<L>;
    BitAnd<Self> bitand = |a, b| a.with(b, |a, b| a & b);
    BitOr<Self> bitor = |a, b| a.with(b, |a, b| a | b);
    Not not = |a| a.with(a, |a, _| !a);
}

impl<const L: usize> Mask for Bits<L> {
    #[inline(always)]
    fn of(value: bool) -> Self {
        Self([if value { !0 } else { 0 }; L])
    }

    #[inline(always)]
    fn all(self) -> bool {
        let mut all = !0;
        for lane in 0..L {
            all &= self.0[lane];
        }
        all == !0
    }

    #[inline(always)]
    fn lane(self, lane: usize) -> bool {
        self.0[lane] != 0
    }
}

impl<const L: usize> Real for Lanes<L> {
    #[inline(always)]
    fn of(constant: f64) -> Self {
        Self([constant; L])
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.map(f64::abs)
    }

    #[inline(always)]
    fn call(self, function: Function) -> Self {
        match function {
            Function::Abs => self.abs(),
            Function::Sqrt => self.map(f64::sqrt),
            _ => self.map(|x| function.of(x)),
        }
    }
}

impl<const L: usize> Number for Lanes<L> {
    type Mask = Bits<L>;

    const LANES: usize = L;
    one_point!();

    #[inline(always)]
    fn from_lanes(of: impl Fn(usize) -> f64) -> Self {
        let mut numbers = [0.0; L];
        for lane in 0..L {
            numbers[lane] = of(lane);
        }
        Self(numbers)
    }

    #[inline(always)]
    fn lane(self, lane: usize) -> f64 {
        self.0[lane]
    }

    #[inline(always)]
    fn set_lane(&mut self, lane: usize, number: f64) {
        self.0[lane] = number;
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Bits<L> {
        self.compare(other, |a, b| a < b)
    }

    #[inline(always)]
    fn le(self, other: Self) -> Bits<L> {
        self.compare(other, |a, b| a <= b)
    }

    #[inline(always)]
    fn select(mask: Bits<L>, yes: Self, no: Self) -> Self {
        let mut numbers = no;
        for lane in 0..L {
            numbers.0[lane] = if mask.0[lane] != 0 { yes.0[lane] } else { no.0[lane] };
        }
        numbers
    }
}

impl Real for f64 {
    #[inline(always)]
    fn of(constant: f64) -> Self {
        constant
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.abs()
    }

    #[inline(always)]
    fn call(self, function: Function) -> Self {
        function.of(self)
    }
}

impl Mask for bool {
    #[inline(always)]
    fn of(value: bool) -> Self {
        value
    }

    #[inline(always)]
    fn all(self) -> bool {
        self
    }

    #[inline(always)]
    fn lane(self, _: usize) -> bool {
        self
    }
}

impl Number for f64 {
    type Mask = bool;
    #[cfg(not(target_arch = "wasm32"))]
    type Pack = Lanes<4>;

    const LANES: usize = 1;
    #[cfg(not(target_arch = "wasm32"))]
    const POINTS: usize = 4;
    // A page has one of both, to be smaller.
    #[cfg(target_arch = "wasm32")]
    one_point!();

    #[cfg(not(target_arch = "wasm32"))]
    #[inline(always)]
    fn pack(of: impl Fn(usize) -> Self) -> Self::Pack {
        Lanes([of(0), of(1), of(2), of(3)])
    }

    #[cfg(not(target_arch = "wasm32"))]
    #[inline(always)]
    fn of_pack(pack: Self::Pack, point: usize) -> Self {
        pack.0[point]
    }

    #[inline(always)]
    fn from_lanes(of: impl Fn(usize) -> f64) -> Self {
        of(0)
    }

    #[inline(always)]
    fn lane(self, _: usize) -> f64 {
        self
    }

    #[inline(always)]
    fn set_lane(&mut self, _: usize, number: f64) {
        *self = number;
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }

    #[inline(always)]
    fn lt(self, other: Self) -> bool {
        self < other
    }

    #[inline(always)]
    fn le(self, other: Self) -> bool {
        self <= other
    }

    #[inline(always)]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Whether a lane has the bits of a single number; all NaNs count as equal.
    pub(in crate::engine) fn is_same<const L: usize>(lanes: Lanes<L>, lane: usize, single: f64) -> bool {
        lanes.lane(lane).to_bits() == single.to_bits() || (lanes.lane(lane).is_nan() && single.is_nan())
    }

    #[test]
    fn each_lane_has_the_operations_of_a_single_number() {
        let (a, b) = (Lanes([1.5, -2.0, f64::NAN, 0.0]), Lanes([0.1, 3.0, 1.0, -0.0]));
        for lane in 0..4 {
            let (x, y) = (a.lane(lane), b.lane(lane));
            let pairs = [
                (a + b, x + y),
                (a - b, x - y),
                (a * b, x * y),
                (a / b, x / y),
                (-a, -x),
                (a * 0.3, x * 0.3),
                (a + 0.3, x + 0.3),
                (a.abs().sqrt(), x.abs().sqrt()),
                (a.sign(), x.sign()),
                (a.max(b), Number::max(x, y)),
            ];
            for (lanes, single) in pairs {
                assert!(is_same(lanes, lane, single), "{lane}: {lanes:?} {single}");
            }
            assert_eq!((a.lt(b).lane(lane), a.le(b).lane(lane)), (x < y, x <= y));
            assert_eq!((a.is_finite().lane(lane), a.is_number().lane(lane)), (x.is_finite(), !x.is_nan()));
            assert_eq!(Lanes::select(a.lt(b), a, b).lane(lane).to_bits(), if x < y { x } else { y }.to_bits());
        }
        assert_eq!((a.largest(), f64::NAN.largest()), (1.5, f64::NEG_INFINITY));
        assert!(!a.is_number().all() && b.is_number().all() && (!a.is_number()).lane(2));
    }
}
