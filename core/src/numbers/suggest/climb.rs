//! The search for the most likely sizes of several noises.

/// Tries factors on several sizes in turn, first large ones, and keeps those that are likelier: it goes on in a
/// direction while the likelihood rises.
#[derive(Clone, Debug)]
pub(super) struct Climb {
    /// The best factors so far, and their log likelihood.
    best: Vec<f64>,
    likelihood: f64,
    /// The place in [`FACTORS`], the size that is tried now, and whether it is made smaller.
    round: usize,
    size: usize,
    is_down: bool,
    /// Whether the last change in this direction was for the better.
    has_moved: bool,
    /// The trials so far.
    trials: usize,
}

/// The tried factors.
const FACTORS: [f64; 3] = [4.0, 2.0, std::f64::consts::SQRT_2];
/// A change is for the better if the log likelihood rises by more than this.
const BETTER: f64 = 0.5;
/// Limits the trials.
const MOST: usize = 48;
/// Limits a factor.
const FAR: f64 = 1e9;

impl Climb {
    /// Before the first trial, which leaves the sizes unchanged.
    pub(super) fn new(sizes: usize) -> Self {
        let best = vec![1.0; sizes];
        Self { best, likelihood: f64::NEG_INFINITY, round: 0, size: 0, is_down: false, has_moved: false, trials: 0 }
    }

    /// The factors of the next trial. `None` if nothing is left to try.
    pub(super) fn next(&self) -> Option<Vec<f64>> {
        if self.trials == 0 {
            return Some(self.best.clone());
        }
        let factor = *FACTORS.get(self.round).filter(|_| self.trials < MOST)?;
        let mut factors = self.best.clone();
        factors[self.size] *= if self.is_down { 1.0 / factor } else { factor };
        Some(factors)
    }

    /// Takes in the log likelihood of the last trial, if there is one.
    pub(super) fn take(&mut self, likelihood: Option<f64>) {
        let Some(factors) = self.next() else { return };
        let is_first = self.trials == 0;
        self.trials += 1;
        let is_better = likelihood.is_some_and(|likelihood| likelihood > self.likelihood + BETTER);
        if let Some(likelihood) = likelihood.filter(|_| is_better) {
            (self.best, self.likelihood) = (factors, likelihood);
        }
        let is_near = self.best[self.size] < FAR && self.best[self.size] > 1.0 / FAR;
        if is_first || (is_better && is_near) {
            self.has_moved = !is_first;
            return;
        }
        // If one direction improves the likelihood, the other one is not tried.
        if self.is_down || self.has_moved {
            self.size += 1;
            if self.size == self.best.len() {
                (self.round, self.size) = (self.round + 1, 0);
            }
            self.is_down = false;
        } else {
            self.is_down = true;
        }
        self.has_moved = false;
    }

    /// The best factors and their log likelihood, if any trial had one.
    pub(super) fn best(&self) -> Option<(&[f64], f64)> {
        self.likelihood.is_finite().then_some((&self.best[..], self.likelihood))
    }

    /// The share of the search that is done, from 0 to 1.
    pub(super) fn progress(&self) -> f64 {
        (self.round * self.best.len() + self.size) as f64 / (FACTORS.len() * self.best.len()) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_climb_finds_a_summit_that_is_far_away() {
        for summit in [[1.0, 1.0], [3e4, 0.02], [2e-5, 700.0]] {
            let mut climb = Climb::new(2);
            while let Some(factors) = climb.next() {
                let off: f64 = factors.iter().zip(summit).map(|(a, b)| libm::log(a / b)).map(|x| 30.0 * x * x).sum();
                climb.take(Some(-off));
            }
            let (best, _) = climb.best().unwrap();
            for (found, at) in best.iter().zip(summit) {
                assert!((found / at).ln().abs() < 0.25, "{best:?} {summit:?}");
            }
            assert!(climb.trials < MOST && climb.progress() >= 1.0, "{}", climb.trials);
        }
    }

    #[test]
    fn trials_without_a_likelihood_are_passed_over() {
        let mut climb = Climb::new(2);
        while climb.next().is_some() {
            climb.take(None);
        }
        assert!(climb.best().is_none());
    }
}
