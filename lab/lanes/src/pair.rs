//! Lanes as the vectors of a browser: two numbers each.

use std::arch::wasm32::{
    f64x2, f64x2_abs, f64x2_add, f64x2_div, f64x2_extract_lane, f64x2_le, f64x2_lt, f64x2_mul, f64x2_neg, f64x2_splat,
    f64x2_sqrt, f64x2_sub, i64x2_all_true, v128, v128_and, v128_bitselect, v128_not, v128_or,
};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use crate::lane::{LANES, Lane, Mask};

/// Numbers.
#[derive(Clone, Copy)]
pub(crate) struct Pair(v128);

/// Truth values: all bits of a lane are ones, or none.
#[derive(Clone, Copy)]
pub(crate) struct PairMask(v128);

/// Operators of the vectors.
macro_rules! operator {
    ($type:ident: $($trait:ident $name:ident $function:ident),*) => {
        $(impl $trait for $type {
            type Output = Self;

            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                Self($function(self.0, other.0))
            }
        })*
    };
}
operator!(Pair: Add add f64x2_add, Sub sub f64x2_sub, Mul mul f64x2_mul, Div div f64x2_div);
operator!(PairMask: BitAnd bitand v128_and, BitOr bitor v128_or);

impl Neg for Pair {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self(f64x2_neg(self.0))
    }
}

impl Not for PairMask {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        Self(v128_not(self.0))
    }
}

impl Mask for PairMask {
    #[inline(always)]
    fn all(self) -> bool {
        i64x2_all_true(self.0)
    }
}

impl Lane for Pair {
    type Mask = PairMask;
    type Token = ();

    #[inline(always)]
    fn token(self) {}

    #[inline(always)]
    fn splat((): (), number: f64) -> Self {
        Self(f64x2_splat(number))
    }

    #[inline(always)]
    fn from_array((): (), [first, second]: [f64; LANES]) -> Self {
        Self(f64x2(first, second))
    }

    #[inline(always)]
    fn to_array(self) -> [f64; LANES] {
        [f64x2_extract_lane::<0>(self.0), f64x2_extract_lane::<1>(self.0)]
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(f64x2_sqrt(self.0))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(f64x2_abs(self.0))
    }

    #[inline(always)]
    fn lt(self, other: Self) -> PairMask {
        PairMask(f64x2_lt(self.0, other.0))
    }

    #[inline(always)]
    fn le(self, other: Self) -> PairMask {
        PairMask(f64x2_le(self.0, other.0))
    }

    #[inline(always)]
    fn select(mask: PairMask, yes: Self, no: Self) -> Self {
        Self(v128_bitselect(yes.0, no.0, mask.0))
    }

    #[inline(never)]
    #[target_feature(enable = "simd128")]
    fn apart<R>((): (), work: impl FnOnce() -> R) -> R {
        work()
    }
}
