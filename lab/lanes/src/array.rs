//! Lanes as plain arrays, which the compiler turns into the vector instructions that every processor of the target has.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use crate::lane::{LANES, Lane, Mask};

/// Numbers.
#[derive(Clone, Copy)]
#[cfg_attr(not(target_arch = "wasm32"), repr(align(64)))]
pub(crate) struct Array([f64; LANES]);

/// Truth values: all bits of a lane are ones, or none, as the comparisons of vector units have it.
#[derive(Clone, Copy)]
#[cfg_attr(not(target_arch = "wasm32"), repr(align(64)))]
pub(crate) struct Bits([u64; LANES]);

impl Array {
    #[inline(always)]
    fn with(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let mut result = self;
        for lane in 0..LANES {
            result.0[lane] = f(self.0[lane], other.0[lane]);
        }
        result
    }

    #[inline(always)]
    fn compare(self, other: Self, f: impl Fn(f64, f64) -> bool) -> Bits {
        let mut result = [0; LANES];
        for lane in 0..LANES {
            result[lane] = if f(self.0[lane], other.0[lane]) { !0 } else { 0 };
        }
        Bits(result)
    }
}

impl Bits {
    #[inline(always)]
    fn with(self, other: Self, f: impl Fn(u64, u64) -> u64) -> Self {
        let mut result = self;
        for lane in 0..LANES {
            result.0[lane] = f(self.0[lane], other.0[lane]);
        }
        result
    }
}

/// Operators lane by lane.
macro_rules! operator {
    ($type:ident: $($trait:ident $name:ident $operator:tt),*) => {
        $(impl $trait for $type {
            type Output = Self;

            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                self.with(other, |a, b| a $operator b)
            }
        })*
    };
}
operator!(Array: Add add +, Sub sub -, Mul mul *, Div div /);
operator!(Bits: BitAnd bitand &, BitOr bitor |);

impl Neg for Array {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        self.with(self, |a, _| -a)
    }
}

impl Not for Bits {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        self.with(self, |a, _| !a)
    }
}

impl Mask for Bits {
    #[inline(always)]
    fn all(self) -> bool {
        self.0.iter().fold(!0, |all, lane| all & lane) == !0
    }
}

impl Lane for Array {
    type Mask = Bits;
    type Token = ();

    #[inline(always)]
    fn token(self) {}

    #[inline(always)]
    fn splat((): (), number: f64) -> Self {
        Self([number; LANES])
    }

    #[inline(always)]
    fn from_array((): (), numbers: [f64; LANES]) -> Self {
        Self(numbers)
    }

    #[inline(always)]
    fn to_array(self) -> [f64; LANES] {
        self.0
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        self.with(self, |a, _| a.sqrt())
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.with(self, |a, _| a.abs())
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Bits {
        self.compare(other, |a, b| a < b)
    }

    #[inline(always)]
    fn le(self, other: Self) -> Bits {
        self.compare(other, |a, b| a <= b)
    }

    #[inline(always)]
    fn select(mask: Bits, yes: Self, no: Self) -> Self {
        let mut result = no;
        for lane in 0..LANES {
            result.0[lane] = if mask.0[lane] != 0 { yes.0[lane] } else { no.0[lane] };
        }
        result
    }

    #[inline(never)]
    fn apart<R>((): (), work: impl FnOnce() -> R) -> R {
        work()
    }
}
