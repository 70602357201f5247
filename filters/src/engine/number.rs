//! The numbers that a plant and a filter are written for.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// Work for each place below N, at most 8, as straight code: a page's compiler unrolls no loops.
#[inline(always)]
pub(crate) fn unrolled<const N: usize>(mut work: impl FnMut(usize)) {
    const { assert!(N <= 8) }
    macro_rules! one_by_one {
        ($($place:literal)*) => { $(if const { $place < N } { work($place); })* };
    }
    one_by_one!(0 1 2 3 4 5 6 7);
}

/// A number of a plant's equation. Its operations round once, so that all processors give the same bits.
pub trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<f64, Output = Self>
    + Mul<f64, Output = Self>
{
    fn of(constant: f64) -> Self;

    fn abs(self) -> Self;

    fn call(self, function: Function) -> Self;
}

/// A truth value for each lane.
pub trait Mask: Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    fn of(value: bool) -> Self;

    fn all(self) -> bool;

    fn lane(self, lane: usize) -> bool;
}

/// The number of one run, or of several, each in its lane. Where runs differ, both ways are computed and each lane selects its own.
pub trait Number: Real + Send + 'static {
    type Mask: Mask;

    /// Numbers of several points of the same run, which move at once.
    type Pack: Number + std::fmt::Debug;

    const LANES: usize;

    const POINTS: usize;

    fn pack(of: impl Fn(usize) -> Self) -> Self::Pack;

    fn of_pack(pack: Self::Pack, point: usize) -> Self;

    fn from_lanes(of: impl Fn(usize) -> f64) -> Self;

    fn lane(self, lane: usize) -> f64;

    fn set_lane(&mut self, lane: usize, number: f64);

    #[inline(always)]
    fn sqrt(self) -> Self {
        self.call(Function::Sqrt)
    }

    /// -1 below zero, else 1.
    #[inline(always)]
    fn sign(self) -> Self {
        Self::select(self.lt(Self::of(0.0)), Self::of(-1.0), Self::of(1.0))
    }

    fn lt(self, other: Self) -> Self::Mask;

    fn le(self, other: Self) -> Self::Mask;

    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// The larger one of two numbers; the first where one is not a number.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select(self.lt(other), other, self)
    }

    #[inline(always)]
    fn is_number(self) -> Self::Mask {
        self.le(self)
    }

    #[inline(always)]
    fn is_finite(self) -> Self::Mask {
        self.abs().le(Self::of(f64::MAX))
    }

    /// Whether a positive number is neither subnormal nor infinite.
    #[inline(always)]
    fn is_normal(self) -> Self::Mask {
        Self::of(f64::MIN_POSITIVE).le(self) & self.le(Self::of(f64::MAX))
    }

    /// The largest number of all lanes, of those that are numbers.
    #[inline(always)]
    fn largest(self) -> f64 {
        let mut largest = f64::NEG_INFINITY;
        for lane in 0..Self::LANES {
            largest = if self.lane(lane) > largest { self.lane(lane) } else { largest };
        }
        largest
    }
}

macro_rules! one_point {
    () => {
        type Pack = Self;

        const POINTS: usize = 1;

        #[inline(always)]
        fn pack(of: impl Fn(usize) -> Self) -> Self {
            of(0)
        }

        #[inline(always)]
        fn of_pack(pack: Self, _: usize) -> Self {
            pack
        }
    };
}
macro_rules! operators {
    ([$($generics:tt)*] $type:ty;) => {};
    ([$($generics:tt)*] $type:ty; $trait:ident<$other:ty> $name:ident = |$a:ident, $b:ident| $work:expr; $($rest:tt)*) => {
        impl<$($generics)*> $trait<$other> for $type {
            type Output = Self;

            #[inline(always)]
            fn $name(self, $b: $other) -> Self {
                let $a = self;
                $work
            }
        }
        operators! { [$($generics)*] $type; $($rest)* }
    };
    ([$($generics:tt)*] $type:ty; $trait:ident $name:ident = |$a:ident| $work:expr; $($rest:tt)*) => {
        impl<$($generics)*> $trait for $type {
            type Output = Self;

            #[inline(always)]
            fn $name(self) -> Self {
                let $a = self;
                $work
            }
        }
        operators! { [$($generics)*] $type; $($rest)* }
    };
}

pub(super) use {one_point, operators};

/// A function of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Function {
    /// sin x
    Sin,
    /// cos x
    Cos,
    /// tan x
    Tan,
    /// eˣ
    Exp,
    /// The natural logarithm.
    Log,
    /// √x
    Sqrt,
    /// |x|
    Abs,
    /// -1, 0 or 1.
    Sign,
    /// tanh x
    Tanh,
    /// A power with the bits of its exponent.
    Power(u64),
}

impl Function {
    /// The functions that have names.
    pub const NAMED: [(Self, &'static str); 9] = [
        (Self::Sin, "sin"),
        (Self::Cos, "cos"),
        (Self::Tan, "tan"),
        (Self::Exp, "exp"),
        (Self::Log, "log"),
        (Self::Sqrt, "sqrt"),
        (Self::Abs, "abs"),
        (Self::Sign, "sign"),
        (Self::Tanh, "tanh"),
    ];

    /// The function with this name.
    pub fn from_key(key: &str) -> Option<Self> {
        let key = if key == "ln" { "log" } else { key };
        Self::NAMED.iter().find(|(_, name)| *name == key).map(|(function, _)| *function)
    }

    /// The value at x.
    pub fn of(self, x: f64) -> f64 {
        match self {
            Self::Sin => libm::sin(x),
            Self::Cos => libm::cos(x),
            Self::Tan => libm::tan(x),
            Self::Exp => libm::exp(x),
            Self::Log => libm::log(x),
            Self::Sqrt => x.sqrt(),
            Self::Abs => x.abs(),
            Self::Sign if x > 0.0 => 1.0,
            Self::Sign if x < 0.0 => -1.0,
            Self::Sign => 0.0,
            Self::Tanh => libm::tanh(x),
            Self::Power(exponent) => libm::pow(x, f64::from_bits(exponent)),
        }
    }
}
