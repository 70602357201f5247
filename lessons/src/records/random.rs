//! Random numbers that are the same on every machine.

use std::f64::consts::TAU;

/// A stream of random numbers (xorshift, Marsaglia 2003).
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        // Odd, as xorshift never leaves 0; multiplied, so that neighbouring seeds differ in more than their last bits.
        Self(seed.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    /// A number from 0 on and below 1, evenly distributed.
    pub(crate) fn uniform(&mut self) -> f64 {
        let Self(state) = self;
        *state ^= *state << 13;
        *state ^= *state >> 7;
        *state ^= *state << 17;
        // An `f64` has 53 bits: more would round up to 1.
        (*state >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A normal number of mean 0 and standard deviation 1 (Box and Muller 1958).
    pub(crate) fn normal(&mut self) -> f64 {
        // 1 - u, as u may be 0, which has no logarithm.
        let radius = libm::sqrt(-2.0 * libm::log(1.0 - self.uniform()));
        radius * libm::cos(TAU * self.uniform())
    }
}
