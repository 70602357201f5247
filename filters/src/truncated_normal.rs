//! A normal number that is known to lie between two ends.
//!
//! ```text
//! α = (a - m) / σ,  β = (b - m) / σ,  Z = Φ(β) - Φ(α),  r = (φ(α) - φ(β)) / Z
//! mean      m + σ r
//! variance  σ² (1 + (α φ(α) - β φ(β)) / Z - r²)
//! ```
//!
//! Source: Johnson, Kotz and Balakrishnan (1994), *Continuous Univariate Distributions*, volume 1, section 13.10.1. Beyond the mean,
//! φ / (1 - Φ) is the inverse of Mills' ratio, by its continued fraction (Abramowitz and Stegun (1964), 26.2.14).

use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// Beyond this many standard deviations the rest is an exponential distribution to less than a thousandth.
const FAR: f64 = 30.0;

/// Beyond this many means of an exponential distribution the other end no longer matters: e⁻⁷⁰⁰ is left of it.
const MOST_WIDE: f64 = 700.0;

/// Limits an interval, in standard deviations, and the share by which the density falls over it, so that it falls along an exponential.
const NARROW: f64 = 1e-3;
const FALL: f64 = 0.1;

/// Mean and standard deviation of a normal number with these, given that it lies between two ends, the first below the second.
pub fn truncated([mean, std]: [f64; 2], [least, most]: [f64; 2]) -> [f64; 2] {
    if std <= 0.0 {
        return [mean, std];
    }
    let [alpha, beta] = [(least - mean) / std, (most - mean) / std];
    let [shift, scale] = if alpha.abs() > beta.abs() {
        // From the side whose end matters more.
        let [shift, scale] = of_standard(-beta, -alpha);
        [-shift, scale]
    } else {
        of_standard(alpha, beta)
    };
    [(mean + std * shift).clamp(least, most), std * scale]
}

/// Mean and standard deviation of a standard normal number between two ends, the first of which is the nearer to zero.
fn of_standard(alpha: f64, beta: f64) -> [f64; 2] {
    let width = beta - alpha;
    if width < NARROW && alpha * width < FALL {
        // The formulas below are differences of numbers that are nearly equal.
        let fall = alpha * width;
        let variance = (1.0 - fall * fall / 20.0) / 12.0;
        return [alpha + width * (0.5 - fall / 12.0), width * variance.sqrt()];
    }
    if alpha == f64::NEG_INFINITY {
        return [0.0, 1.0];
    }
    if alpha > FAR {
        let width = alpha * (beta - alpha);
        let rest = if width < MOST_WIDE { width / libm::expm1(width) } else { 0.0 };
        let variance = if width < MOST_WIDE { 1.0 - rest * (rest + width) } else { 1.0 };
        return [alpha + (1.0 - rest) / alpha, variance.max(0.0).sqrt() / alpha];
    }
    // φ(β) and Z over φ(α), which vanishes far out.
    let other = libm::exp(0.5 * (alpha - beta) * (alpha + beta));
    let far = if other > 0.0 { other * beta } else { 0.0 };
    let beyond_other = if other > 0.0 { other * mills(beta) } else { 0.0 };
    let inside = mills(alpha) - beyond_other;
    let shift = (1.0 - other) / inside;
    let variance = 1.0 + (alpha - far) / inside - shift * shift;
    [shift, variance.max(0.0).sqrt()]
}

/// (1 - Φ(x)) / φ(x).
fn mills(x: f64) -> f64 {
    const TERMS: u32 = 60;
    if x > 4.0 {
        return 1.0 / (1..=TERMS).rev().fold(x, |below, k| x + f64::from(k) / below);
    }
    let density = libm::exp(-0.5 * x * x) / (2.0 * PI).sqrt();
    0.5 * libm::erfc(x * FRAC_1_SQRT_2) / density
}

#[cfg(test)]
mod tests {
    use super::*;

    fn by_quadrature(least: f64, most: f64) -> [f64; 2] {
        let from = least.max(-12.0);
        let nearest = from.max(0.0).min(most.abs());
        let to = most.min(if from > 3.0 { from + 60.0 / from } else { 12.0 });
        let n = 200_000;
        let h = (to - from) / f64::from(n);
        let mut sums = [0.0; 3];
        for k in 0..=n {
            let x = from + h * f64::from(k);
            let weight = match k {
                0 => 1.0,
                k if k == n => 1.0,
                k if k % 2 == 1 => 4.0,
                _ => 2.0,
            };
            let density = weight * (0.5 * (nearest * nearest - x * x)).exp();
            (0..3).for_each(|i| sums[i] += density * (x - from).powi(i as i32));
        }
        let mean = sums[1] / sums[0];
        [from + mean, (sums[2] / sums[0] - mean * mean).sqrt()]
    }

    /// The exponential distribution far out is one to a thousandth; all else is exact to rounding.
    const LIMIT: f64 = 2e-3;

    #[test]
    fn moments_are_those_of_a_quadrature() {
        for (least, most) in [
            (0.0, f64::INFINITY),
            (-1.0, f64::INFINITY),
            (2.0, f64::INFINITY),
            (7.0, f64::INFINITY),
            (25.0, f64::INFINITY),
            (-0.5, 0.7),
            (-0.5, 3.0),
            (1.0, 1.2),
            (5.0, 5.5),
            (-8.0, 9.0),
            (3.0, 40.0),
            (-0.0002, 0.0003),
            (5.0, 5.0005),
            (29.0, 29.0005),
            (31.0, 31.0005),
            (29.0, 29.002),
        ] {
            let expected = by_quadrature(least, most);
            for sign in [1.0, -1.0] {
                let ends = if sign > 0.0 { [least, most] } else { [-most, -least] };
                let found = truncated([0.0, 1.0], ends);
                let [mean, std] = [(found[0] - sign * expected[0]).abs(), (found[1] / expected[1] - 1.0).abs()];
                let limit = if least > 20.0 { LIMIT } else { 1e-6 };
                assert!(mean < limit * expected[1] && std < limit, "{ends:?}: {found:?} instead of {expected:?}");
            }
        }
    }

    #[test]
    fn far_out_and_narrow_ends_are_continued() {
        for (near, far) in [(29.999, 30.001), (-29.999, -30.001)] {
            let of = |mean: f64| {
                truncated([-mean, 1.0], if mean > 0.0 { [0.0, f64::INFINITY] } else { [f64::NEG_INFINITY, 0.0] })
            };
            let (one, other) = (of(near), of(far));
            assert!(
                (one[0] / other[0] - 1.0).abs() < 5e-3 && (one[1] / other[1] - 1.0).abs() < 5e-3,
                "{one:?} {other:?}"
            );
        }
        for mean in [1e3, 1e8, -1e3, -1e8] {
            let [at, std] = truncated([mean, 1.0], [-2.0, 3.0]);
            assert!((-2.0..=3.0).contains(&at) && (0.0..1e-2).contains(&std), "{at} {std}");
        }
        let narrow = truncated([0.3, 1e9], [-1.0, 1.0]);
        assert!(narrow[0].abs() < 1e-9 && (narrow[1] - 1.0 / 3.0_f64.sqrt()).abs() < 1e-9, "{narrow:?}");
        assert_eq!(truncated([0.3, 0.1], [f64::NEG_INFINITY, f64::INFINITY]), [0.3, 0.1]);
        assert_eq!(truncated([0.3, 0.0], [0.0, 1.0]), [0.3, 0.0]);
    }

    #[test]
    fn ends_that_are_far_away_change_nothing() {
        let [mean, std] = truncated([5.0, 0.1], [0.0, 20.0]);
        assert!((mean - 5.0).abs() < 1e-12 && (std / 0.1 - 1.0).abs() < 1e-12);
    }
}
