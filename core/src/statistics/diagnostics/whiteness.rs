//! The whiteness of a sensor's innovations, a test of the filter's gain.

use std::ops::Range;

use super::chi_squared::{self, NORMAL_95};
use crate::Estimates;

/// The number of lags of the autocorrelation.
pub const LAGS: usize = 20;

/// The autocorrelation of one sensor's normalised innovations, from running sums.
///
/// ```text
/// ν = e / √S,  r_l = Σ ν_k ν_(k-l) / Σ ν_k²,  l = 1 … 20
/// ```
///
/// A sample without a measurement is left out: the lag counts measurements.
///
/// Source: Bar-Shalom, Li and Kirubarajan (2001), *Estimation with Applications to Tracking and Navigation*, section 5.4.
#[derive(Clone, Debug, Default)]
pub struct Whiteness {
    samples: u32,
    square: f64,
    products: [f64; LAGS],
    /// The last innovations, the newest first.
    past: [f64; LAGS],
}

/// The test of Ljung and Box: one number for the autocorrelation at all lags.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LjungBox {
    /// `N (N + 2) Σ r_l² / (N - l)`
    pub statistic: f64,
    /// The probability that white innovations give this statistic or a larger one.
    pub p_value: f64,
}

impl Whiteness {
    /// That of a filter's innovations of one sensor over some samples.
    pub fn over(estimates: &Estimates, sensor: usize, samples: Range<usize>) -> Self {
        let mut whiteness = Self::default();
        let m = estimates.sensors().len();
        for k in samples.start..samples.end.min(estimates.len()) {
            let variance = estimates.innovation_cov(k)[sensor * (m + 1)];
            whiteness.push(estimates.innovation(k)[sensor] / variance.sqrt());
        }
        whiteness
    }

    pub(super) fn push(&mut self, innovation: f64) {
        let Self { samples, square, products, past } = self;
        if innovation.is_nan() {
            return;
        }
        products.iter_mut().zip(&*past).for_each(|(sum, before)| *sum += innovation * before);
        *square += innovation * innovation;
        *samples += 1;
        past.rotate_right(1);
        past[0] = innovation;
    }

    /// r at the lags 1 to [`LAGS`]; zero at lags without enough measurements, and where all innovations are zero.
    pub fn autocorrelation(&self) -> [f64; LAGS] {
        if self.square > 0.0 { self.products.map(|product| product / self.square) } else { [0.0; LAGS] }
    }

    /// The 95 % limit of |r| of white innovations, for a single lag: `1.96 / √N`.
    pub fn band(&self) -> f64 {
        NORMAL_95 / f64::from(self.samples).sqrt()
    }

    /// The test of Ljung and Box over all lags, if there are more measurements than lags.
    ///
    /// Source: Ljung and Box (1978), On a measure of lack of fit in time series models, *Biometrika* 65.
    pub fn ljung_box(&self) -> Option<LjungBox> {
        let n = (self.samples > LAGS as u32).then_some(f64::from(self.samples))?;
        let terms = self.autocorrelation().into_iter().zip(1..).map(|(r, lag)| r * r / (n - f64::from(lag)));
        let statistic = n * (n + 2.0) * terms.sum::<f64>();
        Some(LjungBox { statistic, p_value: chi_squared::upper_tail(statistic, LAGS as u32)? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(innovations: impl IntoIterator<Item = f64>) -> Whiteness {
        let mut whiteness = Whiteness::default();
        innovations.into_iter().for_each(|x| whiteness.push(x));
        whiteness
    }

    fn sequence(n: u32, share: f64) -> Vec<f64> {
        (0..n).map(|k| libm::sin(f64::from(k * k)) + share * libm::cos(0.2 * f64::from(k))).collect()
    }

    #[test]
    fn the_autocorrelation_is_the_direct_one() {
        let values = sequence(100, 0.3);
        let whiteness = of(values.iter().copied());
        let square: f64 = values.iter().map(|x| x * x).sum();
        for (i, r) in whiteness.autocorrelation().into_iter().enumerate() {
            let direct: f64 = values.windows(i + 2).map(|w| w[0] * w[i + 1]).sum::<f64>() / square;
            assert!((r - direct).abs() < 1e-14, "lag {}: {r} instead of {direct}", i + 1);
        }
        assert!((whiteness.band() - 0.196).abs() < 1e-5);
    }

    #[test]
    fn the_test_of_ljung_and_box_is_scipys() {
        // `chi2.sf(n (n + 2) sum(r**2 / (n - l)), 20)` by SciPy 1.17.
        for (share, statistic, p_value) in [
            (0.3, 6.792_385_485_956_311, 0.997_312_460_443_071_6),
            (0.6, 47.829_881_777_267_88, 4.494_060_018_126_006e-4),
        ] {
            let test = of(sequence(100, share)).ljung_box().unwrap();
            assert!((test.statistic / statistic - 1.0).abs() < 1e-12, "{test:?}");
            assert!((test.p_value / p_value - 1.0).abs() < 1e-9, "{test:?}");
        }
    }

    #[test]
    fn missing_measurements_are_left_out() {
        let with_gaps = sequence(60, 0.3).into_iter().flat_map(|x| [x, f64::NAN]);
        assert_eq!(of(with_gaps).autocorrelation(), of(sequence(60, 0.3)).autocorrelation());
    }

    #[test]
    fn too_few_measurements_have_no_test() {
        assert_eq!(of(sequence(20, 0.3)).ljung_box(), None);
        assert_eq!(of([0.0; 30]).ljung_box(), Some(LjungBox { statistic: 0.0, p_value: 1.0 }));
        assert_eq!(of([1.0]).autocorrelation(), [0.0; LAGS]);
    }
}
