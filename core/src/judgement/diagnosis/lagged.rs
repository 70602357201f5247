//! Sums of a series, and its products with another at several lags.

use std::ops::Range;

/// The number of terms that are added side by side, for vector instructions.
const LANES: usize = 4;

/// The sum of a function of each value.
#[inline]
pub(crate) fn sum_of(values: &[f64], of: impl Fn(f64) -> f64) -> f64 {
    let (chunks, rest) = values.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for chunk in chunks {
        for (sum, value) in sums.iter_mut().zip(chunk) {
            *sum += of(*value);
        }
    }
    sums.iter().sum::<f64>() + rest.iter().map(|value| of(*value)).sum::<f64>()
}

/// Adds to each sum, in order of the lags from `first` on, `Σ a_k b_(k - lag)` over the k in `range` for which `b_(k -
/// lag)` exists.
pub(crate) fn add_products(sums: &mut [f64], a: &[f64], b: &[f64], range: Range<usize>, first: i32) {
    for (lag, sum) in (first..).zip(sums) {
        let begin = range.start.max(lag.max(0) as usize).min(range.end);
        let end = range.end.min((b.len() as i64 + i64::from(lag)).max(0) as usize).max(begin);
        let moved = (begin as i64 - i64::from(lag)) as usize;
        if begin < end {
            *sum += product(&a[begin..end], &b[moved..moved + end - begin]);
        }
    }
}

/// The same for few samples. b has `LAGS - 1` samples more than a: it begins that many samples earlier, so that `a[0]`
/// has a partner at every lag.
pub(crate) fn add_near_products<const LAGS: usize>(sums: &mut [f64; LAGS], a: &[f64], b: &[f64]) {
    let mut reversed = [0.0; LAGS];
    for (a, b) in a.iter().zip(b.array_windows::<LAGS>()) {
        for (sum, b) in reversed.iter_mut().zip(b) {
            *sum += a * b;
        }
    }
    for (sum, added) in sums.iter_mut().zip(reversed.iter().rev()) {
        *sum += added;
    }
}

/// `Σ a_k b_k`.
pub(crate) fn product(a: &[f64], b: &[f64]) -> f64 {
    let (a_chunks, a_rest) = a.as_chunks::<LANES>();
    let (b_chunks, b_rest) = b.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for (a, b) in a_chunks.iter().zip(b_chunks) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a * b;
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_products_are_those_of_the_whole_series() {
        let series = |seed: f64| (0..97).map(|k| libm::sin(seed * f64::from(k * k))).collect::<Vec<f64>>();
        let (a, b) = (series(1.0), series(0.7));
        let (mut near, mut direct) = ([1.0; 12], [1.0; 12]);
        add_products(&mut direct, &a, &b, 30..46, -4);
        add_near_products(&mut near, &a[30..46], &b[30 - 7..46 + 4]);
        assert!(near.iter().zip(direct).all(|(near, direct)| (near - direct).abs() < 1e-12), "{near:?}");
    }

    #[test]
    fn every_lag_has_the_sum_of_its_products() {
        let series = |seed: f64| (0..97).map(|k| libm::sin(seed * f64::from(k * k))).collect::<Vec<f64>>();
        let (a, b) = (series(1.0), series(0.7));
        for range in [0..97, 0..10, 40..61, 90..97] {
            let mut sums = [0.0; 12];
            add_products(&mut sums, &a, &b, range.clone(), -5);
            for (lag, sum) in (-5_i64..).zip(sums) {
                let term = |k: usize| Some(a[k] * b.get(usize::try_from(k as i64 - lag).ok()?)?);
                let direct: f64 = range.clone().filter_map(term).sum();
                assert!((sum - direct).abs() < 1e-12, "{range:?}, lag {lag}: {sum} instead of {direct}");
            }
        }
    }
}
