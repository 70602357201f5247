//! A belief that widens once: where the innovations grow at once, or where the plant is plucked.

use super::{Learnt, Readings, Recursion, Span, Wrapper};
use crate::engine::dynamics::Dynamics;
use crate::engine::filter::GaussianFilter;
use crate::engine::number::{Mask, Number};
use crate::engine::update::UpdateResult;

/// A filter that adds its initial variances to Q, in lanes that jump, for one prediction.
pub struct Jumping<T> {
    jumps: Vec<Jump>,
    narrow: Vec<T>,
}

impl<T: Number> Jumping<T> {
    pub fn of<P: Dynamics>(is_on: bool, filter: &GaussianFilter<T, P>) -> Option<Box<dyn Wrapper<T, P>>> {
        let n = filter.belief.size();
        let variances = |lane: usize| (0..n).map(|i| filter.belief.cov[i * n + i].lane(lane)).collect();
        let jumps = || (0..T::LANES).map(|lane| Jump::new(variances(lane))).collect();
        is_on.then(|| Box::new(Self { jumps: jumps(), narrow: vec![T::of(0.0); n] }) as _)
    }
}

impl<T: Number, P: Dynamics> Wrapper<T, P> for Jumping<T> {
    fn predict(&mut self, inner: &mut dyn Recursion<T, P>, span: Span<'_, T>) {
        let Self { jumps, narrow } = self;
        let GaussianFilter { noise, design, .. } = inner.filter();
        let mut has_widened = false;
        for (lane, jump) in jumps.iter_mut().enumerate() {
            let Some(widening) = jump.widening() else { continue };
            if !std::mem::replace(&mut has_widened, true) {
                // Kept to be put back: to add and subtract would leave a rounding error in Q after each jump.
                narrow.iter_mut().enumerate().for_each(|(i, variance)| *variance = *noise.variance(i));
            }
            // A force that is drawn again at each sample always has its full variance.
            let is_kept = |i: usize| design.white.is_none_or(|(place, _)| place != i);
            for (i, more) in widening.enumerate().filter(|(i, _)| is_kept(*i)) {
                let variance = noise.variance(i);
                variance.set_lane(lane, variance.lane(lane) + more);
            }
        }
        inner.predict(span);
        if has_widened {
            let noise = &mut inner.filter().noise;
            narrow.iter().enumerate().for_each(|(i, variance)| *noise.variance(i) = *variance);
        }
    }

    fn update(&mut self, inner: &mut dyn Recursion<T, P>, readings: Readings<'_, T>) -> UpdateResult<T> {
        let result = inner.update(readings);
        let has_measured = T::of(0.0).lt(result.measured);
        // Without a reading, NIS / m is no number, which `min` would turn into the largest gain of the sum.
        for (lane, jump) in self.jumps.iter_mut().enumerate().filter(|(lane, _)| has_measured.lane(*lane)) {
            jump.observe(result.nis.lane(lane), result.measured.lane(lane) as usize);
        }
        result
    }

    fn report<'a>(&'a self, learnt: &mut Learnt<'a, T>) {
        learnt.has_widened = self.jumps.iter().any(|jump| jump.has_widened);
    }
}

/// A filter that widens its belief of the motion where a plant is plucked: parameters and augmentations are what they were.
///
/// ```text
/// P ← P + P₀ of displacements, velocities and hidden states, before the prediction over the time of a pluck
/// ```
///
/// The pull is an unknown force over a short time: it adds to the motion whatever was there before, about which nothing is known but its size.
pub struct Restarting {
    /// In rising order, from the first sample on \[s\].
    times: Vec<f64>,
    variances: Vec<(usize, f64)>,
}

impl Restarting {
    pub fn of<T: Number, P: Dynamics>(times: Vec<f64>, variances: Vec<(usize, f64)>) -> Option<Box<dyn Wrapper<T, P>>> {
        (!times.is_empty()).then(|| Box::new(Self { times, variances }) as _)
    }
}

impl<T: Number, P: Dynamics> Wrapper<T, P> for Restarting {
    fn predict(&mut self, inner: &mut dyn Recursion<T, P>, span: Span<'_, T>) {
        let [before, after] = span.times.map(|end| self.times.partition_point(|time| *time <= end));
        if after > before {
            let count = (after - before) as f64;
            inner.filter().widen(self.variances.iter().map(|&(place, variance)| (place, T::of(count * variance))));
        }
        inner.predict(span);
    }
}

/// Detects a sudden growth of a filter's innovations, and computes what to add to P.
///
/// ```text
/// s ← max(0, s + min(½ (NIS (1 - 1/ρ) / ℓ - m ln ρ), h/10)),   ρ = 1.5,  h = 20
/// s > h:  P⁻ ← P⁻ + a P₀ in the next prediction
/// ```
///
/// s is the cumulative sum of the log likelihood of innovations with the covariance ρ S against that of innovations
/// with S, of m measurements a sample. Innovations of a consistent filter raise it above h once in e^h = 4.9e8 samples
/// or less often (56 days at 100 Hz). A sample raises it by a tenth of h at most, so that an outlier is no change. ℓ is
/// the mean of NIS/m before, if that is above 1 by more than chance: a filter with too small R or Q from the beginning
/// does not jump over and over.
///
/// P₀ is the initial covariance: the filter keeps its mean. After a jump it has 50 samples to learn before the next one can be found.
/// Another one within 150 samples shows that P₀ was too small: then a, which is 1, becomes four times what it was.
///
/// Source: Page (1954), Continuous inspection schemes; Lorden (1971), Procedures for reacting to a change in distribution
/// (the time between false alarms); Willsky and Jones (1976), A generalized likelihood ratio approach to the detection and
/// estimation of jumps in linear systems (a wider P after a jump).
#[derive(Clone, Debug, Default)]
pub(crate) struct Jump {
    /// The diagonal of P₀, in the state's units squared.
    initial: Vec<f64>,
    /// s
    sum: f64,
    /// The mean of NIS/m before, and the number of samples in that mean.
    level: f64,
    learnt: usize,
    blind: usize,
    since: Option<usize>,
    /// a
    factor: f64,
    is_due: bool,
    pub(crate) has_widened: bool,
}

/// ρ, the growth of S that is found fastest, and its logarithm, which no constant expression can take.
const GROWTH: f64 = 1.5;
const LN_GROWTH: f64 = 0.405_465_108_108_164_4;

/// h: consistent innovations pass it once in e^h = 4.9e8 samples or less often (Lorden 1971).
const ALARM: f64 = 20.0;

/// More than ten samples make an alarm: an outlier is no change.
const MOST_OF_ALARM: f64 = 0.1;

/// No search at the beginning: the level is not known yet, and a filter that begins far off has large innovations too.
const FIRST: usize = 200;

/// No search after a jump: the innovations are large until the filter has learnt anew.
const DEAD: usize = 50;

/// Two jumps within this many samples say that the first was too small.
const SOON: usize = 150;

// 4⁶: a model that is always wrong jumps again and again, and without a limit P would grow to infinity.
const LARGEST_FACTOR: f64 = 4096.0;

/// Later samples replace the first in the level: a filter that slowly becomes worse does not jump.
const LEVEL_SAMPLES: usize = 1000;

/// The samples of a level of 1 that the level begins with: without them it would be the first NIS.
const LEVEL_PRIOR: usize = 10;

/// Limits the NIS of one sample in the level, in levels: an outlier of a thousand levels would double the level.
const LEVEL_LIMIT: f64 = 5.0;

impl Jump {
    pub(crate) fn new(initial: Vec<f64>) -> Self {
        Self { initial, level: 1.0, blind: FIRST, factor: 1.0, ..Self::default() }
    }

    /// The variances that this prediction adds to the diagonal of P⁻. `None` unless a change was found at the sample before.
    pub(crate) fn widening(&mut self) -> Option<impl Iterator<Item = f64>> {
        self.has_widened = std::mem::take(&mut self.is_due);
        let factor = self.factor;
        self.has_widened.then(|| self.initial.iter().map(move |variance| factor * variance))
    }

    pub(crate) fn observe(&mut self, nis: f64, measurements: usize) {
        let m = measurements as f64;
        let mean = nis / m;
        if let Some(since) = &mut self.since {
            *since += 1;
        }
        let is_first = self.since.is_none() && self.blind > 0;
        // Above zero, a change may be under way: its innovations must not raise the level that they are held against.
        if is_first || (self.blind == 0 && self.sum == 0.0) {
            self.learn_level(mean);
        }
        if self.blind > 0 {
            self.blind -= 1;
            return;
        }
        let gain = 0.5 * m * (mean / self.level_before(m) * (1.0 - 1.0 / GROWTH) - LN_GROWTH);
        self.sum = (self.sum + gain.min(MOST_OF_ALARM * ALARM)).max(0.0);
        if self.sum > ALARM {
            let is_soon = self.since.is_some_and(|since| since <= SOON);
            self.factor = if is_soon { (4.0 * self.factor).min(LARGEST_FACTOR) } else { 1.0 };
            (self.sum, self.blind, self.since, self.is_due) = (0.0, DEAD, Some(0), true);
        }
    }

    fn learn_level(&mut self, mean: f64) {
        self.learnt = (self.learnt + 1).min(LEVEL_SAMPLES);
        let weight = (self.learnt + LEVEL_PRIOR) as f64;
        self.level += (mean.min(LEVEL_LIMIT * self.level) - self.level) / weight;
    }

    /// ℓ: 1 while the level is within three standard errors of 1, else the level plus two standard errors.
    fn level_before(&self, m: f64) -> f64 {
        let error = (2.0 / (m * (self.learnt + LEVEL_PRIOR) as f64)).sqrt();
        if self.level > 1.0 + 3.0 * error { self.level * (1.0 + 2.0 * error) } else { 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Normal, Purpose};

    /// The samples at which a filter with these squares of innovations, each of `m` measurements, jumps.
    fn jumps(count: usize, m: usize, seed: u64, size: impl Fn(usize) -> f64) -> Vec<usize> {
        let mut normal = Normal::new(seed, Purpose::Ensemble(0));
        let mut jump = Jump::new(vec![1.0]);
        let look = |k: &usize| {
            let square: f64 = (0..m).map(|_| normal.sample()).map(|x| x * x).sum();
            jump.observe(square * size(*k), m);
            jump.widening().is_some()
        };
        (0..count).filter(look).collect()
    }

    #[test]
    fn a_consistent_filter_does_not_jump() {
        for m in 1..=3 {
            for seed in 0..10 {
                assert_eq!(jumps(100_000, m, seed, |_| 1.0), Vec::<usize>::new(), "{m} measurements, seed {seed}");
            }
        }
    }

    #[test]
    fn a_change_is_found_within_a_window_and_once() {
        for m in 1..=3 {
            for seed in 0..20 {
                let found = jumps(6000, m, seed, |k| if (3000..3060).contains(&k) { 6.0 } else { 1.0 });
                assert!(found.len() == 1 && (3009..3060).contains(&found[0]), "{m} measurements: {found:?}");
                let small = jumps(6000, m, seed, |k| if k < 3000 { 1.0 } else { 2.0 });
                assert!(small.first().is_some_and(|k| (3009..3300).contains(k)), "{m} measurements: {small:?}");
            }
        }
    }

    #[test]
    fn an_outlier_is_no_change_nor_is_a_noise_that_was_always_wrong() {
        for seed in 0..20 {
            assert_eq!(
                jumps(20_000, 2, seed, |k| if k % 150 == 140 { 400.0 } else { 1.0 }),
                Vec::<usize>::new(),
                "outliers"
            );
            for size in [0.2, 3.0, 30.0] {
                assert_eq!(jumps(20_000, 2, seed, |_| size), Vec::<usize>::new(), "mean NIS {size}, seed {seed}");
            }
            let found = jumps(6000, 2, seed, |k| if k < 3000 { 3.0 } else { 12.0 });
            assert!(found.first().is_some_and(|k| (3009..3060).contains(k)), "{found:?}");
        }
    }

    #[test]
    fn a_jump_that_was_too_small_is_followed_by_a_larger_one() {
        let mut jump = Jump::new(vec![2.0, 3.0]);
        let mut added = Vec::new();
        for k in 0..500 {
            jump.observe(if k < 300 { 1.0 } else { 50.0 }, 1);
            added.extend(jump.widening().map(Iterator::collect::<Vec<f64>>));
        }
        assert_eq!(added, [[2.0, 3.0], [8.0, 12.0], [32.0, 48.0], [128.0, 192.0]]);
    }
}
