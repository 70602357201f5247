//! The number of one run.

use super::function::Function;
#[cfg(not(target_arch = "wasm32"))]
use super::lanes::Lanes;
use super::number::{Mask, Number, Real};

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
    // A page has one way only, to be smaller.
    #[cfg(target_arch = "wasm32")]
    type Pack = Self;

    const LANES: usize = 1;
    #[cfg(not(target_arch = "wasm32"))]
    const POINTS: usize = 4;
    #[cfg(target_arch = "wasm32")]
    const POINTS: usize = 1;

    #[cfg(not(target_arch = "wasm32"))]
    #[inline(always)]
    fn pack(of: impl Fn(usize) -> Self) -> Self::Pack {
        Lanes([of(0), of(1), of(2), of(3)])
    }

    #[cfg(target_arch = "wasm32")]
    #[inline(always)]
    fn pack(of: impl Fn(usize) -> Self) -> Self::Pack {
        of(0)
    }

    #[cfg(not(target_arch = "wasm32"))]
    #[inline(always)]
    fn of_pack(pack: Self::Pack, point: usize) -> Self {
        pack.0[point]
    }

    #[cfg(target_arch = "wasm32")]
    #[inline(always)]
    fn of_pack(pack: Self::Pack, _: usize) -> Self {
        pack
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
    fn sign(self) -> Self {
        if self < 0.0 { -1.0 } else { 1.0 }
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
