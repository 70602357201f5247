//! How likely measurements were to a Gaussian belief. Logarithms are costly, and hardly ever asked for: a filter's step
//! takes none.

use crate::kernel::gaussian::{Factor, Matrix};
use crate::linalg::{self, Ldl};
use crate::quantity::MAX_SENSORS;

/// ln 2π
const LN_2_PI: f64 = 1.837_877_066_409_345_5;

/// `-(NIS + ln det S + m ln 2π) / 2`, or the sum of several, from the sums of their terms.
pub(crate) fn log_likelihood(nis: f64, ln_determinant: f64, measured: u32) -> f64 {
    -0.5 * (nis + ln_determinant + f64::from(measured) * LN_2_PI)
}

/// ln det S of a sample, from the determinant or, where that has left the range of numbers, from S itself: m × m, with the
/// rows and columns of sensors that measured nothing NaN.
pub(crate) fn ln_determinant(determinant: f64, innovation_cov: &[f64], m: usize) -> f64 {
    if determinant.is_normal() {
        return libm::log(determinant);
    }
    // Sensors that measured nothing have a row of their own.
    let mut cov = Matrix::<MAX_SENSORS, MAX_SENSORS>::identity();
    for (i, row) in innovation_cov.chunks(m).enumerate() {
        for (j, &entry) in row.iter().enumerate().filter(|(_, entry)| !entry.is_nan()) {
            cov[(i, j)] = entry;
        }
    }
    // Where S is singular but for rounding, the elimination of the book and that of the kernels may differ about it: the one
    // that the filter has used has a factor.
    let by_the_book = || Ldl::new(&linalg::Matrix::from_column_slice(MAX_SENSORS, MAX_SENSORS, cov.as_slice()));
    let tuned = Factor::new(&cov).map(|factor| factor.ln_determinant());
    tuned.or_else(|| Some(by_the_book()?.ln_determinant())).unwrap_or(f64::NAN)
}

/// A sum of logarithms, of which it takes but few: numbers are multiplied as long as their product is far from the ends
/// of the range.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LogSum {
    taken: f64,
    product: f64,
}

impl LogSum {
    pub(crate) const ZERO: Self = Self { taken: 0.0, product: 1.0 };

    /// Adds the logarithm of a factor; `ln` gives it where that is too large or too small to be multiplied.
    #[inline]
    pub(crate) fn add(&mut self, factor: f64, ln: impl FnOnce() -> f64) {
        const RANGE: std::ops::RangeInclusive<f64> = 1e-150..=1e150;
        if !RANGE.contains(&factor) {
            self.taken += ln();
            return;
        }
        self.product *= factor;
        if !RANGE.contains(&self.product) {
            self.taken += libm::log(self.product);
            self.product = 1.0;
        }
    }

    pub(crate) fn value(self) -> f64 {
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

    #[test]
    fn a_determinant_out_of_range_is_that_of_the_covariance() {
        let tiny = |variance: f64| {
            let mut cov = [0.0; 16];
            cov.iter_mut().step_by(5).for_each(|entry| *entry = variance);
            (variance.powi(4), cov)
        };
        for variance in [1e-160, 1e-81, 1e-3, 1.0, 1e100] {
            let (determinant, cov) = tiny(variance);
            let error = ln_determinant(determinant, &cov, 4) - 4.0 * libm::log(variance);
            assert!(error.abs() < 1e-10, "{variance}: {error}");
        }
        let nan = f64::NAN;
        let one_missing = ln_determinant(0.0, &[1e-200, nan, 0.0, nan, nan, nan, 0.0, nan, 1e-200], 3);
        assert!((one_missing - 2.0 * libm::log(1e-200)).abs() < 1e-10);
    }
}
