//! The sample at which the size of a series changes.

use super::distributions::normal_tail;

/// Limits a square, so that one reading makes no change.
const LARGEST: f64 = 50.0;

/// Limits the search for a change: the shares of a record, at its beginning and end, that it leaves out.
const MARGINS: (f64, f64) = (0.15, 0.03);

/// Samples of a block. The dispersion of block means includes the correlation of successive squares.
const BLOCK: usize = 20;

/// The least number of blocks of each level.
const FEWEST: usize = 2;

/// A change of the size of normalised squares.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Change {
    /// The first sample after it.
    pub(crate) at: usize,
    /// How many times larger squares are from there on.
    pub(crate) rise: f64,
    /// The probability that squares of constant size show as large a change somewhere.
    pub(crate) p_value: f64,
}

/// The sample from which on normalised squares are larger: where the likelihood of two levels is largest, if squares are
/// exponential.
///
/// ```text
/// least over k of k ln m₁ + (n - k) ln m₂,  m₁, m₂ the means before and after k
/// ```
///
/// The likelihood ratio is divided by the dispersion of the squares about their two levels, so that neither their
/// distribution nor their autocorrelation looks like a change.
///
/// Source: Basseville and Nikiforov (1993), *Detection of Abrupt Changes*, section 2.6; for the dispersion of a quasi-likelihood
/// McCullagh and Nelder (1989), *Generalized Linear Models*, section 9.2.
pub(crate) fn change_point(squares: &[f64]) -> Option<Change> {
    let limited = |x: &f64| if x.is_nan() { 0.0 } else { x.min(LARGEST) };
    let n = squares.len();
    let total: f64 = squares.iter().map(limited).sum();
    let mut before = 0.0;
    let mut best: Option<(f64, usize, [f64; 2])> = None;
    for (k, x) in squares.iter().enumerate() {
        let share = k as f64 / n as f64;
        if share > MARGINS.0 && share < 1.0 - MARGINS.1 && before > 0.0 {
            let (first, second) = (before / k as f64, (total - before) / (n - k) as f64);
            let cost = k as f64 * libm::log(first) + (n - k) as f64 * libm::log(second.max(f64::MIN_POSITIVE));
            if second > first && best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, k, [first, second]));
            }
        }
        before += limited(x);
    }
    let (cost, at, [first, second]) = best?;
    let dispersion = |samples: &[f64], level: f64| {
        let blocks = samples.chunks_exact(BLOCK);
        let count = blocks.len();
        let means = blocks.map(|block| block.iter().map(limited).sum::<f64>() / BLOCK as f64 / level - 1.0);
        (means.map(|x| BLOCK as f64 * x * x).sum::<f64>(), count)
    };
    let of_both = [dispersion(&squares[..at], first), dispersion(&squares[at..], second)];
    let blocks: usize = of_both.iter().map(|(_, count)| count).sum();
    let dispersion = of_both.iter().map(|(sum, _)| sum).sum::<f64>() / blocks.max(1) as f64;
    let ratio = 2.0 * (n as f64 * libm::log(total / n as f64) - cost);
    let p_value = if blocks < 2 * FEWEST { 1.0 } else { supremum_p((ratio / dispersion.max(1.0)).sqrt()) };
    Some(Change { at, rise: second / first, p_value })
}

/// The probability that the root of the largest likelihood ratio over all samples between the margins is above `x` if
/// nothing changes.
///
/// ```text
/// P ≈ x φ(x) (T (1 - 1/x²) + 4/x²),  T = ln((1 - h)(1 - l) / (h l)),  h, l the margins
/// ```
///
/// Source: Csörgő and Horváth (1997), *Limit Theorems in Change-Point Analysis*, equation 1.3.26 with one parameter.
fn supremum_p(x: f64) -> f64 {
    if x.is_nan() || x <= 1.0 {
        return 1.0;
    }
    let (h, l) = MARGINS;
    let t = libm::log((1.0 - h) * (1.0 - l) / (h * l));
    let density = libm::exp(-0.5 * x * x) / std::f64::consts::TAU.sqrt();
    // The probability is at least twice the tail at one sample.
    let both = 2.0 * normal_tail(x);
    (x * density * (t * (1.0 - 1.0 / (x * x)) + 4.0 / (x * x))).clamp(both, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mathematics::random::Normal;

    #[test]
    fn a_change_is_found_where_it_is() {
        let noise = |k: usize| 1.0 + libm::sin((k * k) as f64);
        for at in [400, 700, 950] {
            let squares: Vec<f64> = (0..1000).map(|k| if k < at { noise(k) } else { 3.0 * noise(k) }).collect();
            let Change { at: found, rise, p_value } = change_point(&squares).unwrap();
            assert!(found.abs_diff(at) < 6 && (rise - 3.0).abs() < 0.6, "{found} instead of {at}, {rise} times");
            assert!(p_value < 1e-4, "{p_value} at {at}");
        }
        assert_eq!(change_point(&[]), None);
        assert_eq!(change_point(&[f64::NAN; 100]), None);
    }

    #[test]
    fn squares_of_one_size_have_a_p_value_that_chance_explains() {
        let mut normal = Normal::from_seed(11);
        // Also autocorrelated ones.
        for memory in [0.0, 0.6] {
            let p_values = (0..200).map(|_| {
                let mut last = 0.0;
                let squares = (0..1000).map(|_| {
                    last = memory * last + normal.sample();
                    last * last * (1.0 - memory * memory)
                });
                change_point(&squares.collect::<Vec<_>>()).map_or(1.0, |change| change.p_value)
            });
            let p_values: Vec<f64> = p_values.collect();
            let below = |level: f64| p_values.iter().filter(|p| **p < level).count();
            assert!(below(0.1) <= 40 && below(0.001) <= 3, "{memory}: {} {}", below(0.1), below(0.001));
        }
    }
}
