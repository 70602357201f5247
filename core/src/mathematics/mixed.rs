//! Moments of mixtures, and the shares of hypotheses.

use crate::mathematics::lists::mapped;

/// Mean and covariance, n and n × n numbers.
#[derive(Default)]
pub(crate) struct Moments {
    pub(crate) mean: Vec<f64>,
    pub(crate) cov: Vec<f64>,
}

impl Moments {
    /// Takes mean and covariance of a mixture: each of its parts has a weight, a mean and a covariance; there is at least one.
    pub(crate) fn mix<'a>(&mut self, parts: impl Iterator<Item = (f64, [&'a [f64]; 2])> + Clone) {
        let Self { mean: all, cov } = self;
        mean(parts.clone().map(|(weight, [mean, _])| (weight, mean)), all);
        mean(parts.clone().map(|(weight, [_, cov])| (weight, cov)), cov);
        let total: f64 = parts.clone().map(|(weight, _)| weight).sum();
        for (weight, [own, _]) in parts {
            for (place, entry) in cov.iter_mut().enumerate() {
                let [i, j] = [place % own.len(), place / own.len()];
                // Symmetric to the last bit.
                *entry += weight / total * ((own[i] - all[i]) * (own[j] - all[j]));
            }
        }
    }
}

/// The weighted mean of some numbers; what all have in common keeps its bits.
pub(crate) fn mean<'a>(mut parts: impl Iterator<Item = (f64, &'a [f64])> + Clone, into: &mut Vec<f64>) {
    let total: f64 = parts.clone().map(|(weight, _)| weight).sum();
    let Some((_, first)) = parts.next() else { return };
    into.clear();
    into.extend_from_slice(first);
    for (weight, part) in parts {
        for ((mean, own), first) in into.iter_mut().zip(part).zip(first) {
            *mean += weight / total * (own - first);
        }
    }
}

/// The share of each of some hypotheses that were as probable as each other, given their log evidences: all 0 where none is possible.
pub(crate) fn shares(evidence: &[f64]) -> Vec<f64> {
    let best = evidence.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let share = |x: &f64| if best.is_finite() && !x.is_nan() { libm::exp(x - best) } else { 0.0 };
    let shares: Vec<f64> = mapped(evidence, &share);
    let sum: f64 = shares.iter().sum();
    mapped(&shares, &|share| if sum > 0.0 { share / sum } else { 0.0 })
}
