//! Sums of logarithms, with few calls of the logarithm.

use std::ops::RangeInclusive;

/// A sum of logarithms. It multiplies the factors and takes a logarithm only when their product nears the limits of
/// `f64`.
#[derive(Clone, Copy, Debug)]
pub struct LogSum {
    /// The sum of the logarithms that have been taken.
    pub taken: f64,
    /// The factors that are multiplied but not yet in the logarithm.
    pub product: f64,
}

impl LogSum {
    /// The sum of no logarithms.
    pub const ZERO: Self = Self { taken: 0.0, product: 1.0 };

    /// Limits factors and products: beyond, the logarithm is taken.
    pub const RANGE: RangeInclusive<f64> = 1e-150..=1e150;

    /// Adds the logarithm of a factor. `ln` computes it where the factor is too large or too small to be multiplied.
    #[inline]
    pub fn add(&mut self, factor: f64, ln: impl FnOnce() -> f64) {
        if !Self::RANGE.contains(&factor) {
            self.taken += ln();
            return;
        }
        self.product *= factor;
        if !Self::RANGE.contains(&self.product) {
            self.taken += libm::log(self.product);
            self.product = 1.0;
        }
    }

    /// The sum.
    pub fn value(self) -> f64 {
        self.taken + libm::log(self.product)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_logarithm_of_a_product_is_the_sum_of_logarithms() {
        let factors = (0..3000).map(|k: i32| libm::exp2(f64::from(k * k % 1900 - 900)));
        let (mut sum, mut direct) = (LogSum::ZERO, 0.0);
        for factor in factors {
            sum.add(factor, || libm::log(factor));
            direct += libm::log(factor);
            assert!((sum.value() - direct).abs() < 1e-12 * direct.abs().max(1e3), "{} for {direct}", sum.value());
        }
    }
}
