//! Quantiles and intervals of the χ² distribution.

use std::ops::RangeInclusive;

use super::gamma;

/// The two-sided 95 % interval of the mean of `samples` independent sums of squares with `degrees` degrees of freedom
/// in total; `None` if either is zero.
///
/// ```text
/// [χ²(0.025; degrees), χ²(0.975; degrees)] / samples
/// ```
///
/// Costs microseconds; [`quick_interval`] costs nanoseconds.
///
/// Source: Bar-Shalom, Li and Kirubarajan (2001), *Estimation with Applications to Tracking and Navigation*, section
/// 5.4.
pub fn interval(degrees: u32, samples: u32) -> Option<RangeInclusive<f64>> {
    let samples = (samples > 0).then_some(f64::from(samples))?;
    Some(quantile(0.025, degrees)? / samples..=quantile(0.975, degrees)? / samples)
}

/// An approximation of [`interval`] to a few percent of its half width, for curves of thousands of points.
///
/// ```text
/// χ²(p; d) ≈ d (1 - 2/(9d) + z √(2/(9d)))³,  z the normal quantile of p
/// ```
///
/// Source: Wilson and Hilferty (1931), The distribution of chi-square, *PNAS* 17.
pub fn quick_interval(degrees: u32, samples: u32) -> Option<RangeInclusive<f64>> {
    (degrees > 0 && samples > 0).then(|| wilson_hilferty(degrees, samples, NORMAL_95))
}

/// The same interval for `z` normal standard deviations to either side.
pub(super) fn wilson_hilferty(degrees: u32, samples: u32, z: f64) -> RangeInclusive<f64> {
    let (degrees, samples) = (f64::from(degrees), f64::from(samples));
    let variance = 2.0 / (9.0 * degrees);
    let quantile = |z: f64| {
        let root = (1.0 - variance + z * variance.sqrt()).max(0.0);
        degrees * root * root * root / samples
    };
    quantile(-z)..=quantile(z)
}

/// The normal quantile of 97.5 %: 95 % of a normal distribution lies within ± this many standard deviations.
pub const NORMAL_95: f64 = 1.959_963_984_540_054;

/// The quantile of χ² with `degrees` degrees of freedom at probability `p`; `None` without degrees, or where p is no probability.
///
/// ```text
/// P(degrees/2, χ²/2) = p
/// ```
pub fn quantile(p: f64, degrees: u32) -> Option<f64> {
    if degrees == 0 || !(0.0..=1.0).contains(&p) {
        return None;
    }
    Some(match p {
        0.0 => 0.0,
        1.0 => f64::INFINITY,
        p => 2.0 * gamma::inverse(0.5 * f64::from(degrees), p),
    })
}

/// The probability that χ² with `degrees` degrees of freedom is above `statistic`; `None` without degrees.
///
/// ```text
/// Q(degrees/2, statistic/2)
/// ```
pub fn upper_tail(statistic: f64, degrees: u32) -> Option<f64> {
    if statistic.is_nan() {
        return None;
    }
    (degrees > 0).then(|| gamma::both(0.5 * f64::from(degrees), 0.5 * statistic).1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        // Abramowitz and Stegun (1964), *Handbook of Mathematical Functions*, table 26.8.
        for (degrees, low, high) in [
            (1, 9.82069e-4, 5.02389),
            (2, 0.0506356, 7.37776),
            (4, 0.484419, 11.1433),
            (10, 3.24697, 20.4831),
            (30, 16.7908, 46.9792),
            (100, 74.2219, 129.561),
        ] {
            let exact = interval(degrees, 1).unwrap();
            assert!((exact.start() / low - 1.0).abs() < 1e-5 && (exact.end() / high - 1.0).abs() < 1e-5, "{exact:?}");
            let quick = quick_interval(degrees, 1).unwrap();
            let off = (quick.start() - low).abs().max((quick.end() - high).abs()) / (high - low);
            assert!(off < 0.02, "{degrees}: {quick:?} instead of {exact:?}");
        }
        assert!((upper_tail(18.307, 10).unwrap() - 0.05).abs() < 1e-5);
    }

    #[test]
    fn quantiles_and_tails_have_limits() {
        assert_eq!((quantile(0.0, 3), quantile(1.0, 3)), (Some(0.0), Some(f64::INFINITY)));
        assert_eq!(
            (quantile(f64::NAN, 3), quantile(1.1, 3), quantile(-0.1, 3), quantile(0.5, 0)),
            (None, None, None, None)
        );
        assert_eq!((upper_tail(-1.0, 3), upper_tail(f64::INFINITY, 3)), (Some(1.0), Some(0.0)));
        assert_eq!((upper_tail(f64::NAN, 3), upper_tail(1.0, 0)), (None, None));
    }

    /// Limits of verdicts must not depend on the platform's mathematical library: these are bits.
    #[test]
    fn limits_have_the_same_bits_everywhere() {
        let bits = |p, degrees| quantile(p, degrees).unwrap().to_bits();
        let all = [bits(0.95, 1), bits(0.95, 4), bits(0.025, 12_000), bits(0.975, 2)];
        assert_eq!(
            all,
            [
                4_615_832_615_056_735_995,
                4_621_530_734_674_088_381,
                4_667_656_802_099_767_304,
                4_619_992_636_494_869_003
            ]
        );
    }

    #[test]
    fn a_mean_of_many_is_near_its_expectation() {
        let many = interval(12_000, 6_000).unwrap();
        assert!((many.start() - 1.949_710).abs() < 1e-6 && (many.end() - 2.050_921).abs() < 1e-6, "{many:?}");
        let quick = quick_interval(12_000, 6_000).unwrap();
        assert!((many.start() - quick.start()).abs() < 1e-6 && (many.end() - quick.end()).abs() < 1e-6);
        assert_eq!((interval(0, 3), interval(3, 0), quick_interval(0, 0)), (None, None, None));
    }
}
