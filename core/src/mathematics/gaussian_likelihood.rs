//! The likelihood of measurements under a Gaussian belief. It is computed on demand, because logarithms are costly: a filter's
//! step takes none.

use crate::mathematics::engine::columns::factor;

/// ln 2π
const LN_2_PI: f64 = 1.837_877_066_409_345_5;

/// `-(NIS + ln det S + m ln 2π) / 2`. From the sums of these terms over several samples it is the sum of their log likelihoods.
pub fn log_likelihood(nis: f64, ln_determinant: f64, measured: u32) -> f64 {
    -0.5 * (nis + ln_determinant + f64::from(measured) * LN_2_PI)
}

/// ln det S of a sample, from the determinant. Where that has overflowed or underflowed, it is computed from S, m × m, in which
/// the rows and columns of sensors without a measurement are NaN.
pub fn ln_determinant(determinant: f64, innovation_cov: &[f64], m: usize) -> f64 {
    if determinant.is_normal() {
        return libm::log(determinant);
    }
    let measured: Vec<usize> = (0..m).filter(|i| !innovation_cov[i * m + i].is_nan()).collect();
    let mut lower: Vec<f64> =
        measured.iter().flat_map(|&j| measured.iter().map(move |&i| innovation_cov[j * m + i])).collect();
    let count = measured.len();
    let (_, is_positive) = factor(&mut lower, count);
    // The factor has the inverses of D on its diagonal.
    if is_positive { -(0..count).map(|i| libm::log(lower[i * (count + 1)])).sum::<f64>() } else { f64::NAN }
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
}
