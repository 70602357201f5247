//! Lanes as explicit vectors, for instructions that only some processors of the target have.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use fearless_simd::prelude::*;
use fearless_simd::{f64x8, mask64x8};

use crate::lane::{LANES, Lane, Mask};

/// Numbers.
#[derive(Clone, Copy)]
pub(crate) struct Vector<S: Simd>(f64x8<S>);

/// Truth values.
#[derive(Clone, Copy)]
pub(crate) struct VectorMask<S: Simd>(mask64x8<S>);

/// Operators of the vectors.
macro_rules! operator {
    ($type:ident: $($trait:ident $name:ident $operator:tt),*) => {
        $(impl<S: Simd> $trait for $type<S> {
            type Output = Self;

            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                Self(self.0 $operator other.0)
            }
        })*
    };
}
operator!(Vector: Add add +, Sub sub -, Mul mul *, Div div /);
operator!(VectorMask: BitAnd bitand &, BitOr bitor |);

impl<S: Simd> Neg for Vector<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl<S: Simd> Not for VectorMask<S> {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}

impl<S: Simd> Mask for VectorMask<S> {
    #[inline(always)]
    fn all(self) -> bool {
        self.0.all_true()
    }
}

impl<S: Simd> Lane for Vector<S> {
    type Mask = VectorMask<S>;
    type Token = S;

    #[inline(always)]
    fn token(self) -> S {
        self.0.simd
    }

    #[inline(always)]
    fn splat(token: S, number: f64) -> Self {
        Self(f64x8::splat(token, number))
    }

    #[inline(always)]
    fn from_array(token: S, numbers: [f64; LANES]) -> Self {
        Self(f64x8::from_slice(token, &numbers))
    }

    #[inline(always)]
    fn to_array(self) -> [f64; LANES] {
        let mut numbers = [0.0; LANES];
        self.0.store_slice(&mut numbers);
        numbers
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs())
    }

    #[inline(always)]
    fn lt(self, other: Self) -> VectorMask<S> {
        VectorMask(self.0.simd_lt(other.0))
    }

    #[inline(always)]
    fn le(self, other: Self) -> VectorMask<S> {
        VectorMask(self.0.simd_le(other.0))
    }

    #[inline(always)]
    fn select(mask: VectorMask<S>, yes: Self, no: Self) -> Self {
        Self(mask.0.select(yes.0, no.0))
    }

    /// This instruction, here, takes its second number where one is not a number, as the comparison does.
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(other.0.max(self.0))
    }

    #[inline(never)]
    fn apart<R>(token: S, work: impl FnOnce() -> R) -> R {
        token.vectorize(work)
    }
}
