//! Numbers of two runs side by side as a vector of a browser, whose compiler makes no vectors of arrays.

use std::arch::wasm32::{
    f64x2, f64x2_abs, f64x2_add, f64x2_div, f64x2_extract_lane, f64x2_le, f64x2_lt, f64x2_mul, f64x2_neg,
    f64x2_replace_lane, f64x2_splat, f64x2_sqrt, f64x2_sub, i64x2_all_true, i64x2_extract_lane, i64x2_splat, v128,
    v128_and, v128_bitselect, v128_not, v128_or,
};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use super::number::{Function, Mask, Number, Real, one_point, operators};

/// The numbers of two runs.
#[derive(Clone, Copy, Debug)]
pub struct LanePair(v128);

/// Truth values of two runs: all bits of a lane are ones, or none.
#[derive(Clone, Copy, Debug)]
pub struct LaneBits(v128);

operators! {
    [] LanePair;
    Add<Self> add = |a, b| Self(f64x2_add(a.0, b.0));
    Sub<Self> sub = |a, b| Self(f64x2_sub(a.0, b.0));
    Mul<Self> mul = |a, b| Self(f64x2_mul(a.0, b.0));
    Div<Self> div = |a, b| Self(f64x2_div(a.0, b.0));
    Add<f64> add = |a, b| Self(f64x2_add(a.0, f64x2_splat(b)));
    Mul<f64> mul = |a, b| Self(f64x2_mul(a.0, f64x2_splat(b)));
    Neg neg = |a| Self(f64x2_neg(a.0));
}

operators! {
    [] LaneBits;
    BitAnd<Self> bitand = |a, b| Self(v128_and(a.0, b.0));
    BitOr<Self> bitor = |a, b| Self(v128_or(a.0, b.0));
    Not not = |a| Self(v128_not(a.0));
}

impl Mask for LaneBits {
    #[inline(always)]
    fn of(value: bool) -> Self {
        Self(i64x2_splat(-i64::from(value)))
    }

    #[inline(always)]
    fn all(self) -> bool {
        i64x2_all_true(self.0)
    }

    #[inline(always)]
    fn lane(self, lane: usize) -> bool {
        (if lane == 0 { i64x2_extract_lane::<0>(self.0) } else { i64x2_extract_lane::<1>(self.0) }) != 0
    }
}

impl Real for LanePair {
    #[inline(always)]
    fn of(constant: f64) -> Self {
        Self(f64x2_splat(constant))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(f64x2_abs(self.0))
    }

    #[inline(always)]
    fn call(self, function: Function) -> Self {
        match function {
            Function::Abs => self.abs(),
            Function::Sqrt => Self(f64x2_sqrt(self.0)),
            _ => Self::from_lanes(|lane| function.of(self.lane(lane))),
        }
    }
}

impl Number for LanePair {
    type Mask = LaneBits;

    const LANES: usize = 2;
    one_point!();

    #[inline(always)]
    fn from_lanes(of: impl Fn(usize) -> f64) -> Self {
        Self(f64x2(of(0), of(1)))
    }

    #[inline(always)]
    fn lane(self, lane: usize) -> f64 {
        if lane == 0 { f64x2_extract_lane::<0>(self.0) } else { f64x2_extract_lane::<1>(self.0) }
    }

    #[inline(always)]
    fn set_lane(&mut self, lane: usize, number: f64) {
        let [first, second] = [f64x2_replace_lane::<0>(self.0, number), f64x2_replace_lane::<1>(self.0, number)];
        self.0 = if lane == 0 { first } else { second };
    }

    #[inline(always)]
    fn lt(self, other: Self) -> LaneBits {
        LaneBits(f64x2_lt(self.0, other.0))
    }

    #[inline(always)]
    fn le(self, other: Self) -> LaneBits {
        LaneBits(f64x2_le(self.0, other.0))
    }

    #[inline(always)]
    fn select(mask: LaneBits, yes: Self, no: Self) -> Self {
        Self(v128_bitselect(yes.0, no.0, mask.0))
    }
}
