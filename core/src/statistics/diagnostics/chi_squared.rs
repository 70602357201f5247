//! Quantiles and intervals of the χ² distribution, from the incomplete gamma function.

use std::f64::consts::TAU;
use std::ops::RangeInclusive;

/// The 95 % interval of the mean of `samples` sums of squares with `degrees` degrees of freedom in total; `None` without either.
///
/// ```text
/// [χ²(0.025; degrees), χ²(0.975; degrees)] / samples
/// ```
///
/// Costs microseconds; [`quick_interval`] costs nanoseconds.
///
/// Source: Bar-Shalom, Li and Kirubarajan (2001), *Estimation with Applications to Tracking and Navigation*, section 5.4.
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
    if degrees == 0 || samples == 0 {
        return None;
    }
    let (degrees, samples) = (f64::from(degrees), f64::from(samples));
    let variance = 2.0 / (9.0 * degrees);
    let quantile = |z: f64| {
        let root = (1.0 - variance + z * variance.sqrt()).max(0.0);
        degrees * root * root * root / samples
    };
    Some(quantile(-NORMAL_95)..=quantile(NORMAL_95))
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
        p => 2.0 * inverse(0.5 * f64::from(degrees), p),
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
    (degrees > 0).then(|| both(0.5 * f64::from(degrees), 0.5 * statistic).1)
}

/// Limits the terms of a series or a continued fraction. Near x = a they need a few √a; a is at most 2³¹ here.
const MOST_TERMS: usize = 2_000_000;

/// Limits the steps of Newton's method, which needs about six.
const MOST_STEPS: usize = 100;

/// `P(a, x)` and `Q(a, x)` for a > 0 and x ≥ 0. The smaller one has all its digits.
fn both(a: f64, x: f64) -> (f64, f64) {
    if x <= 0.0 {
        return (0.0, 1.0);
    }
    if x.is_infinite() {
        return (1.0, 0.0);
    }
    let scale = power(a, x);
    if x < a + 1.0 {
        let below = scale * series(a, x);
        (below, 1.0 - below)
    } else {
        let above = a * scale * fraction(a, x);
        (1.0 - above, above)
    }
}

/// The x with `P(a, x) = p`, 0 < p < 1: Newton's method on the logarithm of the smaller tail, nearly straight over ln x or x.
/// Source of the start: Wilson and Hilferty (1931), The distribution of chi-square, *PNAS* 17.
fn inverse(a: f64, p: f64) -> f64 {
    let (is_low, tail) = (p <= 0.5, p.min(1.0 - p));
    let z = if is_low { -normal_quantile(tail) } else { normal_quantile(tail) };
    let root = 1.0 - 1.0 / (9.0 * a) + z / (3.0 * a.sqrt());
    // Where the tail is long, P is nearly xᵃ / Γ(a + 1).
    let lowest = || libm::exp((libm::log(tail) + libm::lgamma(a + 1.0)) / a);
    let mut x = if root > 0.3 { a * root * root * root } else { lowest() };
    for _ in 0..MOST_STEPS {
        let (below, above) = both(a, x);
        let density = a * power(a, x) / x;
        let next = if is_low {
            x * libm::exp(-libm::log(below / tail) * below / (x * density))
        } else {
            (x + libm::log(above / tail) * above / density).max(0.5 * x)
        };
        if !next.is_finite() {
            break;
        }
        let step = (next - x).abs();
        x = next;
        if step <= 2.0 * f64::EPSILON * x {
            break;
        }
    }
    x
}

/// The normal number that is exceeded with probability `p` ≤ 0.5, to 5e-4. Source: Abramowitz and Stegun (1964), *Handbook of
/// Mathematical Functions*, equation 26.2.23.
fn normal_quantile(p: f64) -> f64 {
    let t = (-2.0 * libm::log(p)).sqrt();
    let above = 2.515_517 + t * (0.802_853 + t * 0.010_328);
    let below = 1.0 + t * (1.432_788 + t * (0.189_269 + t * 0.001_308));
    t - above / below
}

/// `xᵃ e⁻ˣ / Γ(a + 1)`, without the cancellation of its logarithms. Source: Loader (2000), *Fast and accurate computation of
/// binomial probabilities*.
fn power(a: f64, x: f64) -> f64 {
    libm::exp(-stirling_error(a) - deviance(a, x)) / (TAU * a).sqrt()
}

/// `a ln(a/x) + x - a`.
fn deviance(a: f64, x: f64) -> f64 {
    let difference = a - x;
    if difference.abs() >= 0.1 * (a + x) {
        return a * libm::log(a / x) - difference;
    }
    let ratio = difference / (a + x);
    let (mut sum, mut power) = (difference * ratio, 2.0 * a * ratio);
    for odd in (3..).step_by(2) {
        power *= ratio * ratio;
        let next = sum + power / f64::from(odd);
        if next == sum {
            break;
        }
        sum = next;
    }
    sum
}

/// `ln Γ(a + 1) - ln(√(2πa) (a/e)ᵃ)`.
fn stirling_error(a: f64) -> f64 {
    if a <= 15.0 {
        return libm::lgamma(a + 1.0) - (a + 0.5) * libm::log(a) + a - 0.5 * libm::log(TAU);
    }
    let square = a * a;
    (1.0 / 12.0 - (1.0 / 360.0 - (1.0 / 1260.0 - (1.0 / 1680.0 - 1.0 / 1188.0 / square) / square) / square) / square)
        / a
}

/// `P(a, x) Γ(a + 1) / (xᵃ e⁻ˣ) = Σ xⁿ / ((a + 1) … (a + n))`. Source: Press, Teukolsky, Vetterling and Flannery (2007),
/// *Numerical Recipes*, section 6.2.
fn series(a: f64, x: f64) -> f64 {
    let (mut term, mut sum, mut factor) = (1.0, 1.0, a);
    for _ in 0..MOST_TERMS {
        factor += 1.0;
        term *= x / factor;
        sum += term;
        if term < sum * (0.5 * f64::EPSILON) {
            break;
        }
    }
    sum
}

/// `Q(a, x) Γ(a) / (xᵃ e⁻ˣ)` as a continued fraction, by Lentz's method. Source: Press, Teukolsky, Vetterling and Flannery
/// (2007), *Numerical Recipes*, sections 5.2 and 6.2.
fn fraction(a: f64, x: f64) -> f64 {
    let mut partial = x + 1.0 - a;
    let mut c = f64::INFINITY;
    let mut d = 1.0 / partial;
    let mut value = d;
    for n in 1..MOST_TERMS {
        let n = n as f64;
        let numerator = n * (a - n);
        partial += 2.0;
        d = 1.0 / not_zero(numerator * d + partial);
        c = not_zero(partial + numerator / c);
        let factor = c * d;
        value *= factor;
        if (factor - 1.0).abs() <= f64::EPSILON {
            break;
        }
    }
    value
}

fn not_zero(value: f64) -> f64 {
    if value.abs() < f64::MIN_POSITIVE { f64::MIN_POSITIVE } else { value }
}

#[cfg(test)]
mod tests {
    use statrs::distribution::{ChiSquared, ContinuousCDF as _};

    use super::*;

    #[test]
    fn quantiles_and_tails_have_limits() {
        assert_eq!((quantile(0.0, 3), quantile(1.0, 3)), (Some(0.0), Some(f64::INFINITY)));
        assert_eq!([(f64::NAN, 3), (1.1, 3), (-0.1, 3), (0.5, 0)].map(|(p, degrees)| quantile(p, degrees)), [None; 4]);
        assert_eq!((upper_tail(-1.0, 3), upper_tail(f64::INFINITY, 3)), (Some(1.0), Some(0.0)));
        assert_eq!((upper_tail(f64::NAN, 3), upper_tail(1.0, 0)), (None, None));
    }

    /// Limits of verdicts must not depend on the platform's mathematical library: these are bits.
    #[test]
    fn limits_have_the_same_bits_everywhere() {
        for (p, degrees, bits) in [
            (0.95, 1, 4_615_832_615_056_735_995),
            (0.95, 4, 4_621_530_734_674_088_381),
            (0.025, 12_000, 4_667_656_802_099_767_304),
            (0.975, 2, 4_619_992_636_494_869_003),
        ] {
            assert_eq!(quantile(p, degrees).unwrap().to_bits(), bits);
        }
    }

    #[test]
    fn a_mean_of_many_is_near_its_expectation() {
        let many = interval(12_000, 6_000).unwrap();
        assert!((many.start() - 1.949_710).abs() < 1e-6 && (many.end() - 2.050_921).abs() < 1e-6, "{many:?}");
        let quick = quick_interval(12_000, 6_000).unwrap();
        assert!((many.start() - quick.start()).abs() < 1e-6 && (many.end() - quick.end()).abs() < 1e-6);
        assert_eq!((interval(0, 3), interval(3, 0), quick_interval(0, 0)), (None, None, None));
    }

    const DEGREES: [u32; 16] = [1, 2, 3, 4, 5, 7, 10, 20, 29, 30, 31, 50, 100, 1_000, 12_000, 4_000_000];
    const PROBABILITIES: [f64; 15] =
        [1e-9, 1e-6, 1e-3, 0.01, 0.025, 0.05, 0.2, 0.4, 0.5, 0.7, 0.9, 0.95, 0.975, 0.999, 0.999_999];

    #[test]
    fn quantiles_are_those_of_an_independent_program() {
        for degrees in DEGREES {
            let other = ChiSquared::new(f64::from(degrees)).unwrap();
            for p in PROBABILITIES {
                let a = 0.5 * f64::from(degrees);
                let x = inverse(a, p);
                let (below, above) = both(a, x);
                // A quantile to the last bit leaves the slope times that bit.
                let off = if p <= 0.5 { below / p - 1.0 } else { above / (1.0 - p) - 1.0 };
                assert!(off.abs() < 1e-13 * (a.sqrt() + 1.0), "{degrees} {p}: {off:e}");
                // The tails of the other lose digits as degrees grow, since it takes a difference of logarithms: at 12,000 they have 11.
                if degrees > 12_000 {
                    continue;
                }
                let off = (below - other.cdf(2.0 * x)).abs().max((above - other.sf(2.0 * x)).abs());
                let change = off / (a * power(a, x));
                assert!(change < 1e-12, "{degrees} {p}: {change:e}");
            }
        }
    }

    #[test]
    fn quantiles_are_those_of_forty_digits() {
        // From mpmath 1.3 with 40 digits: degrees, and the quantiles of 2.5, 95 and 97.5 %.
        for (degrees, expected) in [
            (1, [9.820_691_171_752_56e-4, 3.841_458_820_694_126, 5.023_886_187_314_889]),
            (2, [0.050_635_615_968_579_75, 5.991_464_547_107_982, 7.377_758_908_227_873]),
            (4, [0.484_418_557_087_929_8, 9.487_729_036_781_158, 11.143_286_781_877_798]),
            (12_000, [11_698.262_408_215_567, 12_255.951_580_688_436, 12_305.526_158_142_953]),
            (100_000, [99_125.373_300_647_35, 100_736.736_177_319, 100_878.415_305_665_56]),
        ] {
            for (p, expected) in [0.025, 0.95, 0.975].into_iter().zip(expected) {
                let found = 2.0 * inverse(0.5 * f64::from(degrees), p);
                assert!((found / expected - 1.0).abs() < 4e-15, "{degrees} {p}: {found:e}");
            }
            let quick = quick_interval(degrees, 1).unwrap();
            let off = (quick.start() - expected[0]).abs().max((quick.end() - expected[2]).abs());
            assert!(off < 0.02 * (expected[2] - expected[0]), "{degrees}: {quick:?}");
        }
        assert!((2.0 * inverse(2e6, 0.025) / 3_994_458.279_251_604_3 - 1.0).abs() < 1e-14);
    }
}
