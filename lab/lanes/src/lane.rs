//! A number in each of several lanes: the only operations that a step may use.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// The number of lanes: eight fill the widest registers. A browser's compiler has none for them, and keeps the numbers of two
/// lanes out of memory.
pub const LANES: usize = if cfg!(target_arch = "wasm32") { 2 } else { 8 };

/// A truth value in each lane.
pub(crate) trait Mask: Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    /// Whether it is true in all lanes.
    fn all(self) -> bool;
}

/// A number in each lane. Operations of IEEE 754 that round once, and comparisons: no operation with bits that depend
/// on the processor, and so no fused multiply-add.
pub(crate) trait Lane:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    type Mask: Mask;
    /// The proof that the processor has the instructions, if they need one.
    type Token: Copy;

    fn token(self) -> Self::Token;
    fn splat(token: Self::Token, number: f64) -> Self;
    fn from_array(token: Self::Token, numbers: [f64; LANES]) -> Self;
    fn to_array(self) -> [f64; LANES];
    fn sqrt(self) -> Self;
    fn abs(self) -> Self;
    fn lt(self, other: Self) -> Self::Mask;
    fn le(self, other: Self) -> Self::Mask;
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// Calls a function that is not inlined but compiled for the same instructions. It keeps code that runs seldom, or
    /// from several places, from being copied into each caller.
    fn apart<R>(token: Self::Token, work: impl FnOnce() -> R) -> R;

    /// The same number in every lane.
    #[inline(always)]
    fn of(self, number: f64) -> Self {
        Self::splat(self.token(), number)
    }

    /// The larger one of two numbers.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select(self.lt(other), other, self)
    }

    /// Whether it is finite.
    #[inline(always)]
    fn is_finite(self) -> Self::Mask {
        self.abs().le(self.of(f64::MAX))
    }

    /// Whether a positive number is neither subnormal nor infinite.
    #[inline(always)]
    fn is_normal(self) -> Self::Mask {
        self.of(f64::MIN_POSITIVE).le(self) & self.le(self.of(f64::MAX))
    }

    /// True in every lane.
    #[inline(always)]
    fn always(token: Self::Token) -> Self::Mask {
        let zero = Self::splat(token, 0.0);
        zero.le(zero)
    }
}
