//! Draws from a normal distribution, and quantiles of functions of them.

use std::f64::consts::TAU;

use super::DRAWS;

/// The number of components for which the sequence's root is precomputed.
const USUAL: usize = 6;

/// The root of `x^(d+1) = x + 1` above 1, for d components. Powers of its inverse are a good choice of d numbers that
/// are far from rational and from each other.
fn root(d: usize) -> f64 {
    let mut x = 1.2;
    for _ in 0..60 {
        // A fixed-point iteration: (1 + x)^(1/(d+1)).
        x = libm::pow(1.0 + x, 1.0 / (d + 1) as f64);
    }
    x
}

/// The root for [`USUAL`] components.
const ROOT: f64 = 1.1127756842787055;

/// The component `j` of draw `i` from a standard normal distribution of `d` components: a quasirandom sequence, which
/// fills space more evenly than random points, with the Box-Muller transform.
///
/// Source: Roberts (2018), The unreasonable effectiveness of quasirandom sequences; Niederreiter (1992), *Random Number
/// Generation and Quasi-Monte Carlo Methods*, section 3.1 (Kronecker sequences).
pub(super) fn normal(i: usize, j: usize, d: usize) -> f64 {
    let ratio = if d <= USUAL { ROOT } else { root(d + d % 2) };
    let uniform = |place: usize| {
        let x = 0.5 + (i + 1) as f64 * (0..=place).fold(1.0, |power, _| power / ratio);
        x - libm::floor(x)
    };
    let radius = (-2.0 * libm::log(1.0 - uniform(j & !1))).sqrt();
    let (sin, cos) = libm::sincos(TAU * uniform(j | 1));
    if j.is_multiple_of(2) { radius * cos } else { radius * sin }
}

/// The interpolation weight of the 2.5 % quantile between the second and the third smallest of the draws: the i-th
/// smallest of n evenly spread draws has the share `(i - ½) / n` below it.
///
/// Source: Hyndman and Fan (1996), Sample quantiles in statistical packages, definition 5.
const BEYOND_SECOND: f64 = 0.025 * DRAWS as f64 + 0.5 - 2.0;

/// The three smallest and the three largest values so far, at each frequency.
pub(super) struct Extremes {
    least: [Vec<f64>; 3],
    most: [Vec<f64>; 3],
}

impl Extremes {
    pub(super) fn new(frequencies: usize) -> Self {
        let all = |value: f64| std::array::from_fn(|_| vec![value; frequencies]);
        Self { least: all(f64::INFINITY), most: all(f64::NEG_INFINITY) }
    }

    pub(super) fn push(&mut self, values: &[f64]) {
        insert(&mut self.least, values, |a, b| if a < b { (a, b) } else { (b, a) });
        insert(&mut self.most, values, |a, b| if a > b { (a, b) } else { (b, a) });
    }

    /// The 2.5 % and the 97.5 % quantile at every frequency.
    pub(super) fn quantiles(&self) -> (Vec<f64>, Vec<f64>) {
        (quantile(&self.least), quantile(&self.most))
    }
}

/// Inserts every value among the three that are kept; `sorted` orders two of them.
#[inline]
fn insert([first, second, third]: &mut [Vec<f64>; 3], values: &[f64], sorted: impl Fn(f64, f64) -> (f64, f64)) {
    for (((first, second), third), &value) in first.iter_mut().zip(second).zip(third).zip(values) {
        let rest;
        (*first, rest) = sorted(*first, value);
        let (before, rest) = sorted(*second, rest);
        *second = before;
        *third = sorted(*third, rest).0;
    }
}

fn quantile([_, second, third]: &[Vec<f64>; 3]) -> Vec<f64> {
    let between = |(&a, &b): (&f64, &f64)| if a == b { a } else { a + BEYOND_SECOND * (b - a) };
    second.iter().zip(third).map(between).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_have_the_moments_of_the_standard_normal() {
        assert!((ROOT.powi(7) - ROOT - 1.0).abs() < 1e-14);
        assert!((root(USUAL) - ROOT).abs() < 1e-15);
        for j in 0..5 {
            let moment = |p: i32| (0..DRAWS).map(|i| normal(i, j, 5).powi(p)).sum::<f64>() / DRAWS as f64;
            assert!(moment(1).abs() < 0.06, "mean {}", moment(1));
            assert!((moment(2) - 1.0).abs() < 0.1, "variance {}", moment(2));
            for other in 0..j {
                let product = (0..DRAWS).map(|i| normal(i, j, 5) * normal(i, other, 5)).sum::<f64>() / DRAWS as f64;
                assert!(product.abs() < 0.08, "correlation {product} of {j} and {other}");
            }
        }
    }

    #[test]
    fn quantiles_are_those_of_the_sorted_values() {
        let mut values: Vec<f64> = (0..DRAWS).map(|i| normal(i, 0, 5)).collect();
        let mut extremes = Extremes::new(2);
        values.iter().for_each(|&x| extremes.push(&[x, f64::INFINITY]));
        values.sort_by(f64::total_cmp);
        let (low, high) = extremes.quantiles();
        assert!((low[0] - (values[1] + 0.9 * (values[2] - values[1]))).abs() < 1e-15);
        assert!((high[0] - (values[DRAWS - 2] - 0.9 * (values[DRAWS - 2] - values[DRAWS - 3]))).abs() < 1e-15);
        assert_eq!((low[1], high[1]), (f64::INFINITY, f64::INFINITY));
    }
}
