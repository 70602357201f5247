//! The numbers that a plant and a filter are written for.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use super::function::Function;

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
    /// A constant.
    fn of(constant: f64) -> Self;

    /// The absolute value.
    fn abs(self) -> Self;

    /// The value of a function.
    fn call(self, function: Function) -> Self;
}

/// A truth value for each lane.
pub trait Mask: Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    /// The same in every lane.
    fn of(value: bool) -> Self;

    /// Whether it is true in all lanes.
    fn all(self) -> bool;

    /// Whether it is true in a lane.
    fn lane(self, lane: usize) -> bool;
}

/// A number of a filter: that of one run, or those of several runs side by side, each in its lane. Where runs differ, both
/// ways are computed and each lane [selects](Self::select) its own.
pub trait Number: Real {
    /// The truth values of comparisons.
    type Mask: Mask;

    /// Numbers of several points of the same run, which move at once.
    type Pack: Number + std::fmt::Debug;

    /// The number of lanes.
    const LANES: usize;

    /// The number of points in a pack.
    const POINTS: usize;

    /// The numbers of the points of a pack.
    fn pack(of: impl Fn(usize) -> Self) -> Self::Pack;

    /// The number of a point of a pack.
    fn of_pack(pack: Self::Pack, point: usize) -> Self;

    /// The number of each lane.
    fn from_lanes(of: impl Fn(usize) -> f64) -> Self;

    /// The number of a lane.
    fn lane(self, lane: usize) -> f64;

    /// Changes the number of a lane.
    fn set_lane(&mut self, lane: usize, number: f64);

    /// The square root.
    fn sqrt(self) -> Self;

    /// -1 below zero, else 1.
    fn sign(self) -> Self;

    /// Whether it is less than another.
    fn lt(self, other: Self) -> Self::Mask;

    /// Whether it is less than another or equal.
    fn le(self, other: Self) -> Self::Mask;

    /// One number where the mask is true, another where it is false.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// The larger one of two numbers; the first where one is not a number.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select(self.lt(other), other, self)
    }

    /// Whether it is a number at all.
    #[inline(always)]
    fn is_number(self) -> Self::Mask {
        self.le(self)
    }

    /// Whether it is finite.
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
