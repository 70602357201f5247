//! Gaussian beliefs: moments of mixtures, shares of hypotheses, and the likelihood of measurements, on demand: logarithms are costly.

use std::ops::RangeInclusive;

use crate::engine::columns::factor;
use crate::lists::{mapped, numbers, places};

const LN_2_PI: f64 = 1.837_877_066_409_345_5;

/// `-(NIS + ln det S + m ln 2π) / 2`. From the sums of these terms over several samples it is the sum of their log likelihoods.
pub fn log_likelihood(nis: f64, ln_determinant: f64, measured: u32) -> f64 {
    -0.5 * (nis + ln_determinant + f64::from(measured) * LN_2_PI)
}

/// ln det S from det S or, if that is beyond numbers, from S, m × m, which is NaN at sensors without a measurement.
pub fn ln_determinant(determinant: f64, innovation_cov: &[f64], m: usize) -> f64 {
    if determinant.is_normal() {
        return libm::log(determinant);
    }
    let measured = places(m, &|i| !innovation_cov[i * m + i].is_nan());
    let (mut lower, count) = (part_of(innovation_cov, m, &measured), measured.len());
    // In the order of the filter's own factor: where S is singular to rounding, another order fails.
    let (_, is_positive) = factor(&mut lower, count);
    // The factor has the inverses of D on its diagonal.
    if is_positive { -(0..count).map(|i| libm::log(lower[i * (count + 1)])).sum::<f64>() } else { f64::NAN }
}

pub fn part_of(matrix: &[f64], m: usize, places: &[usize]) -> Vec<f64> {
    let count = places.len();
    numbers(count * count, &|at| matrix[places[at / count] * m + places[at % count]])
}

/// A sum of logarithms. It multiplies factors, and takes a logarithm only when their product nears the limits of `f64`.
#[derive(Clone, Copy, Debug)]
pub struct LogSum {
    pub taken: f64,
    /// The factors that are multiplied but not yet in the logarithm.
    pub product: f64,
}

impl LogSum {
    pub const ZERO: Self = Self { taken: 0.0, product: 1.0 };

    /// Limits factors and products: beyond, the logarithm is taken.
    pub const RANGE: RangeInclusive<f64> = 1e-150..=1e150;

    /// Adds the logarithm of a factor. `ln` computes it where the factor is too large or too small for a number.
    #[inline]
    pub fn add(&mut self, factor: f64, ln: impl FnOnce() -> f64) {
        if !Self::RANGE.contains(&factor) {
            self.taken += if factor.is_normal() { libm::log(factor) } else { ln() };
            return;
        }
        self.product *= factor;
        if !Self::RANGE.contains(&self.product) {
            self.taken += libm::log(self.product);
            self.product = 1.0;
        }
    }

    pub fn value(self) -> f64 {
        self.taken + libm::log(self.product)
    }
}

#[derive(Default)]
pub struct Moments {
    pub mean: Vec<f64>,
    pub cov: Vec<f64>,
}

impl Moments {
    /// Takes mean and covariance of a mixture: each of its parts has a weight, a mean and a covariance; there is at least one.
    pub fn mix<'a>(&mut self, parts: impl Iterator<Item = (f64, [&'a [f64]; 2])> + Clone) {
        let Self { mean: all, cov } = self;
        mean(parts.clone().map(|(weight, [mean, _])| (weight, mean)), all);
        mean(parts.clone().map(|(weight, [_, cov])| (weight, cov)), cov);
        let total: f64 = parts.clone().map(|(weight, _)| weight).sum();
        for (weight, [own, _]) in parts {
            for (place, entry) in cov.iter_mut().enumerate() {
                let [i, j] = [place % own.len(), place / own.len()];
                // Symmetric to the last bit.
                *entry += weight / total * ((own[i] - all[i]) * (own[j] - all[j]));
            }
        }
    }
}

/// The weighted mean of some numbers; what all have in common keeps its bits.
pub fn mean<'a>(mut parts: impl Iterator<Item = (f64, &'a [f64])> + Clone, into: &mut Vec<f64>) {
    let total: f64 = parts.clone().map(|(weight, _)| weight).sum();
    let Some((_, first)) = parts.next() else { return };
    into.clear();
    into.extend_from_slice(first);
    for (weight, part) in parts {
        for ((mean, own), first) in into.iter_mut().zip(part).zip(first) {
            *mean += weight / total * (own - first);
        }
    }
}

/// The share of each of some hypotheses that were as probable as each other, given their log evidences: all 0 where none is possible.
pub fn shares(evidence: &[f64]) -> Vec<f64> {
    let best = evidence.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let share = |x: &f64| if best.is_finite() && !x.is_nan() { libm::exp(x - best) } else { 0.0 };
    let shares: Vec<f64> = mapped(evidence, &share);
    let sum: f64 = shares.iter().sum();
    mapped(&shares, &|share| if sum > 0.0 { share / sum } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

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
