//! The sample at which a series changes its size.

/// Limits a square, so that one reading makes no change.
const LARGEST: f64 = 50.0;

/// Limits the search for a change: the shares of a record, at its beginning and end, that it leaves out.
const MARGINS: (f64, f64) = (0.15, 0.03);

/// The sample from which on normalised squares are larger, and how many times they are larger than before: where the
/// likelihood of two levels is largest, if squares are exponential.
///
/// ```text
/// least over k of k ln m₁ + (n - k) ln m₂,  m₁, m₂ the means before and after k
/// ```
///
/// Source: Basseville and Nikiforov (1993), *Detection of Abrupt Changes*, section 2.6.
pub(crate) fn change_point(squares: &[f64]) -> Option<(usize, f64)> {
    let limited = |x: &f64| if x.is_nan() { 0.0 } else { x.min(LARGEST) };
    let n = squares.len();
    let total: f64 = squares.iter().map(limited).sum();
    let mut before = 0.0;
    let mut best: Option<(f64, usize, f64)> = None;
    for (k, x) in squares.iter().enumerate() {
        let share = k as f64 / n as f64;
        if share > MARGINS.0 && share < 1.0 - MARGINS.1 && before > 0.0 {
            let (first, second) = (before / k as f64, (total - before) / (n - k) as f64);
            let cost = k as f64 * libm::log(first) + (n - k) as f64 * libm::log(second.max(f64::MIN_POSITIVE));
            if second > first && best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, k, second / first));
            }
        }
        before += limited(x);
    }
    best.map(|(_, k, rise)| (k, rise))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_is_found_where_it_is() {
        let noise = |k: usize| 1.0 + libm::sin((k * k) as f64);
        for at in [400, 700, 950] {
            let squares: Vec<f64> = (0..1000).map(|k| if k < at { noise(k) } else { 3.0 * noise(k) }).collect();
            let (found, rise) = change_point(&squares).unwrap();
            assert!(found.abs_diff(at) < 6 && (rise - 3.0).abs() < 0.6, "{found} instead of {at}, {rise} times");
        }
        assert_eq!(change_point(&[]), None);
        assert_eq!(change_point(&[f64::NAN; 100]), None);
    }
}
