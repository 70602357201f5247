//! The histogram of the last estimates, as numbers.

use kalmanscope_core::internals::sort_numbers;

/// Limits the number of bars.
const BARS: (usize, usize) = (10, 40);

/// The share of the estimates, at either end, that may be beyond the histogram.
const TAIL: f64 = 0.01;

#[derive(Default)]
pub(super) struct Histogram {
    pub(super) from: f64,
    pub(super) to: f64,
    pub(super) counts: Vec<Vec<usize>>,
    pub(super) beyond: Vec<usize>,
}

impl Histogram {
    pub(super) fn new(estimates: &[&[f64]], truth: Option<f64>) -> Self {
        let mut ends: Option<(f64, f64)> = None;
        for estimates in estimates {
            let mut sorted: Vec<f64> = estimates.iter().copied().filter(|value| value.is_finite()).collect();
            sort_numbers(&mut sorted);
            let Some(last) = sorted.len().checked_sub(1) else { continue };
            let tail = (TAIL * last as f64).round() as usize;
            let (low, high) = (sorted[tail], sorted[last - tail]);
            ends = Some(ends.map_or((low, high), |(l, h)| (l.min(low), h.max(high))));
        }
        let Some((low, high)) = ends else { return Self::default() };
        let (low, high) = truth.map_or((low, high), |truth| (low.min(truth), high.max(truth)));
        let margin = 0.04 * (high - low).max(1e-9 * high.abs()).max(f64::MIN_POSITIVE);
        let (from, to) = (low - margin, high + margin);
        let most = estimates.iter().map(|estimates| estimates.len()).max().unwrap_or_default();
        let bars = ((2.0 * (most as f64).sqrt()) as usize).clamp(BARS.0, BARS.1);
        let (mut counts, mut beyond) = (vec![vec![0; bars]; estimates.len()], vec![0; estimates.len()]);
        for (filter, estimates) in estimates.iter().enumerate() {
            for value in *estimates {
                let share = (value - from) / (to - from);
                if (0.0..1.0).contains(&share) {
                    counts[filter][((share * bars as f64) as usize).min(bars - 1)] += 1;
                } else {
                    beyond[filter] += 1;
                }
            }
        }
        Self { from, to, counts, beyond }
    }

    pub(super) fn bars(&self) -> usize {
        self.counts.first().map_or(0, Vec::len)
    }

    pub(super) fn ends(&self, bar: usize) -> [f64; 2] {
        [bar, bar + 1].map(|edge| self.from + edge as f64 / self.bars() as f64 * (self.to - self.from))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_estimate_is_counted_once() {
        let normal: Vec<f64> = (0..1000).map(|k| 6.0 + 0.001 * f64::from(k % 100)).collect();
        let far: Vec<f64> = normal.iter().copied().chain([1e6, f64::NAN]).collect();
        let histogram = Histogram::new(&[&normal, &far], Some(7.0));
        let counted = |at: usize| histogram.counts[at].iter().sum::<usize>() + histogram.beyond[at];
        assert_eq!([counted(0), counted(1)], [1000, 1002]);
        assert_eq!(histogram.beyond, [0, 2]);
        assert!(histogram.from < 6.0 && histogram.to > 7.0);
        assert_eq!(histogram.counts[0], histogram.counts[1]);
    }

    #[test]
    fn a_single_estimate_and_none_are_possible() {
        let histogram = Histogram::new(&[&[6.0]], None);
        assert_eq!(histogram.counts[0].iter().sum::<usize>(), 1);
        assert_eq!(Histogram::new(&[&[f64::NAN]], None).bars(), 0);
    }
}
