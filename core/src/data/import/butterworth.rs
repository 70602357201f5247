//! Butterworth filters run forward and backward.

use std::f64::consts::PI;

/// The order of each filter; run forward and backward it is twice that.
const ORDER: usize = 4;

/// A second-order section, in direct form II transposed.
#[derive(Clone, Copy, Debug)]
struct Section {
    b: [f64; 3],
    a: [f64; 2],
}

/// The side of the cut-off frequency that passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Pass {
    Low,
    High,
}

/// The sections of a filter that passes one side of `cut`, the cut-off frequency as a share of the sample rate below ½.
///
/// Source: Oppenheim and Schafer (2010), *Discrete-Time Signal Processing*, section 7.2 (bilinear transform).
fn sections(pass: Pass, cut: f64) -> [Section; ORDER / 2] {
    let warped = libm::tan(PI * cut);
    std::array::from_fn(|k| {
        let damping = 2.0 * libm::sin(PI * (2 * k + 1) as f64 / (2 * ORDER) as f64);
        let (w, ww) = (damping * warped, warped * warped);
        let scale = 1.0 / (1.0 + w + ww);
        let b = match pass {
            Pass::Low => [ww * scale, 2.0 * ww * scale, ww * scale],
            Pass::High => [scale, -2.0 * scale, scale],
        };
        Section { b, a: [2.0 * (ww - 1.0) * scale, (1.0 - w + ww) * scale] }
    })
}

impl Section {
    /// Filters in place, from the steady state of the first value on.
    fn run(self, values: &mut [f64]) {
        let Self { b, a } = self;
        let Some(&first) = values.first() else { return };
        let steady = first * b.iter().sum::<f64>() / (1.0 + a[0] + a[1]);
        let mut second = b[2] * first - a[1] * steady;
        let mut one = b[1] * first - a[0] * steady + second;
        for value in values {
            let x = *value;
            let y = b[0] * x + one;
            one = b[1] * x - a[0] * y + second;
            second = b[2] * x - a[1] * y;
            *value = y;
        }
    }
}

/// Filters in place: passes frequencies between `low` and `high`, both as shares of the sample rate. A `low` of 0 makes
/// a low-pass, a `high` of ½ or more a high-pass. Nothing is shifted in time. All values must be finite.
pub(super) fn band_pass(values: &mut Vec<f64>, low: f64, high: f64) {
    let mut all = Vec::new();
    if low > 0.0 {
        all.extend(sections(Pass::High, low.min(0.499)));
    }
    if high < 0.5 {
        all.extend(sections(Pass::Low, high));
    }
    let slowest = [low, high].into_iter().filter(|&cut| cut > 0.0).fold(0.5, f64::min);
    let margin = (libm::ceil(3.0 / slowest) as usize).min(values.len().saturating_sub(1));
    if all.is_empty() || values.len() < 2 {
        return;
    }
    let mut extended = Vec::with_capacity(values.len() + 2 * margin);
    // Turned about its ends, so that value and slope go on.
    let (first, last) = (values[0], values[values.len() - 1]);
    extended.extend(values[1..=margin].iter().rev().map(|value| 2.0 * first - value));
    extended.extend_from_slice(values);
    extended.extend(values[values.len() - 1 - margin..values.len() - 1].iter().rev().map(|value| 2.0 * last - value));
    for _ in 0..2 {
        all.iter().for_each(|section| section.run(&mut extended));
        extended.reverse();
    }
    values.clear();
    values.extend_from_slice(&extended[margin..extended.len() - margin]);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coefficients_are_those_of_scipy() {
        // scipy.signal.butter(4, 0.2, output="ba"), the cut-off at a tenth of the sample rate.
        let mut denominator = vec![1.0];
        for Section { a, .. } in sections(Pass::Low, 0.1) {
            let factor = [1.0, a[0], a[1]];
            let mut product = vec![0.0; denominator.len() + 2];
            for (i, x) in denominator.iter().enumerate() {
                factor.iter().enumerate().for_each(|(j, y)| product[i + j] += x * y);
            }
            denominator = product;
        }
        let expected =
            [1.0, -2.369_513_007_182_037, 2.313_988_414_415_879_7, -1.054_665_405_878_567_4, 0.187_379_492_368_185];
        for (found, expected) in denominator.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
        let gain: f64 = sections(Pass::Low, 0.1).iter().map(|section| section.b[0]).product();
        assert!((gain - 0.004_824_343_357_716_2).abs() < 1e-15, "{gain}");
    }

    fn sine(cycles: f64, n: usize) -> Vec<f64> {
        (0..n).map(|k| (2.0 * PI * cycles * k as f64).sin()).collect()
    }

    #[test]
    fn sines_pass_or_vanish_and_are_not_shifted() {
        let middle = 400..600;
        for (cycles, expected) in [(0.02, 0.0), (0.1, 1.0), (0.4, 0.0)] {
            let before = sine(cycles, 1000);
            let mut after = before.clone();
            band_pass(&mut after, 0.05, 0.2);
            let worst = middle.clone().map(|k| (after[k] - expected * before[k]).abs()).fold(0.0, f64::max);
            assert!(worst < 5e-3, "{cycles}: {worst}");
        }
        // At the cut-off, forward and backward leave a half.
        let before = sine(0.2, 1000);
        let mut after = before.clone();
        band_pass(&mut after, 0.0, 0.2);
        let worst = middle.map(|k| (after[k] - 0.5 * before[k]).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-3, "{worst}");
    }

    #[test]
    fn constants_and_lines_pass_a_low_pass_up_to_the_ends() {
        let mut line: Vec<f64> = (0..200).map(|k| 3.0 + 0.5 * f64::from(k)).collect();
        let before = line.clone();
        band_pass(&mut line, 0.0, 0.1);
        for (found, expected) in line.iter().zip(before) {
            assert!((found - expected).abs() < 0.05, "{found} {expected}");
        }
        let mut constant = vec![3.0; 50];
        band_pass(&mut constant, 0.05, 0.5);
        assert!(constant.iter().all(|value| value.abs() < 1e-9));
        let mut short = vec![1.0, 2.0];
        band_pass(&mut short, 0.0, 0.01);
        assert_eq!(short.len(), 2);
    }
}
