//! Which model: filters as model classes, and how probable the readings make each of them.
//!
//! ```text
//! P(C | z₁ … zₖ) = p(z₁ … zₖ | C) P(C) / Σ p(z₁ … zₖ | C') P(C'),   P(C) the same for all
//! ln p(z₁ … zₖ | C) = Σ ln p(zⱼ | z₁ … zⱼ₋₁, C):  what each update of the filter says of its readings
//! ```
//!
//! A class with more parameters predicts more widely at first, and pays for it in each of those terms: no penalty is added.
//!
//! Source: Beck and Yuen (2004), Model selection using response measurements: Bayesian probabilistic approach; Huang and Yuen
//! (2023), *Bayesian Real-Time System Identification*; Dawid (1984), Present position and potential developments: the prequential
//! approach, for filters that forget.

use kalmanscope_filters::gaussian_likelihood::{Moments, shares};

use crate::Estimates;

/// The log evidence of a filter over time: what all readings up to a sample say of it.
#[derive(Clone, Debug, Default)]
pub struct Evidence {
    forgotten: usize,
    sums: Vec<f64>,
    total: f64,
    is_stopped: bool,
}

impl Evidence {
    /// The evidence in all estimates of a filter so far.
    pub fn new(estimates: &Estimates) -> Self {
        let mut evidence = Self { forgotten: estimates.forgotten(), ..Self::default() };
        evidence.follow_to(estimates.len(), estimates);
        evidence
    }

    /// Up to `end` of the kept samples of the estimates that it began with; those forgotten unseen are left out.
    pub fn follow_to(&mut self, end: usize, estimates: &Estimates) {
        self.forget_before(estimates.forgotten());
        for k in self.sums.len()..end.min(estimates.len()) {
            let own = estimates.log_likelihood(k);
            self.total += if own.is_nan() { 0.0 } else { own };
            self.sums.push(self.total);
        }
        self.is_stopped = estimates.stop().is_some();
    }

    /// Forgets the samples before one, counted from the run's beginning; their evidence stays in that of the later ones.
    pub fn forget_before(&mut self, sample: usize) {
        self.sums.drain(..sample.saturating_sub(self.forgotten).min(self.sums.len()));
        self.forgotten = self.forgotten.max(sample);
    }

    /// The number of samples that are kept.
    pub fn len(&self) -> usize {
        self.sums.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.sums.is_empty()
    }

    /// The log evidence at sample `k`; minus infinity once the filter has stopped, and `None` for a sample to come.
    pub fn at(&self, k: usize) -> Option<f64> {
        self.sums.get(k).copied().or(self.is_stopped.then_some(f64::NEG_INFINITY))
    }
}

/// The probabilities of model classes, of which each was as probable as any other before the first reading.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelClasses {
    /// The probability of each class, from 0 to 1; all are 0 where none is possible.
    pub probabilities: Vec<f64>,
}

impl ModelClasses {
    /// The classes with these log evidences. One that is not a number is that of a class which cannot have been.
    pub fn new(evidence: impl IntoIterator<Item = f64>) -> Self {
        Self { probabilities: shares(&evidence.into_iter().collect::<Vec<f64>>()) }
    }

    /// A probability in per cent, with two decimals; what these do not tell from certainty is said to be above or below.
    pub fn in_percent(probability: f64) -> String {
        match 100.0 * probability {
            x if x > 99.99 => "> 99.99 %".to_owned(),
            x if x < 0.01 => "< 0.01 %".to_owned(),
            x => format!("{x:.2} %"),
        }
    }

    fn possible(&self) -> impl Iterator<Item = (usize, f64)> {
        self.probabilities.iter().copied().enumerate().filter(|(_, p)| *p > 0.0)
    }

    /// The likeliest class, if any is possible.
    pub fn likeliest(&self) -> Option<usize> {
        self.possible().max_by(|a, b| a.1.total_cmp(&b.1)).map(|(class, _)| class)
    }

    /// Mean and variance of a number over all possible classes that have it, each with its own mean and variance.
    ///
    /// ```text
    /// m = Σ Pᵢ mᵢ,  v = Σ Pᵢ (vᵢ + (mᵢ - m)²)
    /// ```
    pub fn average(&self, of: impl Fn(usize) -> Option<(f64, f64)>) -> Option<(f64, f64)> {
        let own = |(class, p)| of(class).map(|(mean, variance)| (p, [[mean], [variance]]));
        let all: Vec<_> = self.possible().filter_map(own).collect();
        let mut average = Moments::default();
        average.mix(all.iter().map(|(p, [mean, variance])| (*p, [&mean[..], &variance[..]])));
        Some((*average.mean.first()?, *average.cov.first()?))
    }
}
