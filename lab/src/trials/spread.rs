//! The differences among trials.

use super::Estimated;

/// Statistics of numbers of one kind, each with its own σ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Their number.
    pub count: usize,
    /// The smallest and the largest one.
    pub ends: [f64; 2],
    /// Their mean.
    pub mean: f64,
    /// Their standard deviation among each other.
    pub among: f64,
    /// The root mean square of their own σ.
    pub own: f64,
}

impl Spread {
    /// The spread of some numbers; `None` for fewer than two.
    pub fn of(numbers: &[Estimated]) -> Option<Self> {
        let count = numbers.len();
        if count < 2 {
            return None;
        }
        let mean = numbers.iter().map(|one| one.mean).sum::<f64>() / count as f64;
        let squares: f64 = numbers.iter().map(|one| (one.mean - mean).powi(2)).sum();
        let own: f64 = numbers.iter().map(|one| one.std * one.std).sum();
        let ends = numbers
            .iter()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], one| [low.min(one.mean), high.max(one.mean)]);
        let (among, own) = ((squares / (count - 1) as f64).sqrt(), (own / count as f64).sqrt());
        Some(Self { count, ends, mean, among, own })
    }
}
