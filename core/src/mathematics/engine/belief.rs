//! The belief of a filter about the state, and the noise that it assumes.

use super::level::Level;
use super::number::{Mask, Number};

/// A normal distribution over n components, in each lane.
#[derive(Clone, Debug)]
pub(crate) struct Belief<T> {
    /// y, n numbers.
    pub mean: Vec<T>,
    /// P, n × n; only the lower triangle is read.
    pub cov: Vec<T>,
}

/// The noise that a filter assumes.
#[derive(Clone, Debug)]
pub(crate) struct Noise<T> {
    /// The diagonal of Q.
    pub process: Vec<T>,
    /// Q, n × n, its lower triangle, where it is not diagonal; else empty.
    pub matrix: Vec<T>,
    /// The diagonal of R.
    pub sensors: Vec<T>,
    /// The fading factor λ ≥ 1 on the predicted covariance.
    pub fading: T,
}

impl<T: Number> Noise<T> {
    /// Gives Q a whole matrix.
    pub(super) fn fill_matrix(&mut self) {
        let n = self.process.len();
        self.matrix = vec![T::of(0.0); n * n];
        self.process.iter().enumerate().for_each(|(i, variance)| self.matrix[i * (n + 1)] = *variance);
    }

    /// The diagonal of Q.
    pub(crate) fn diagonal(&self) -> impl Iterator<Item = T> {
        let n = self.process.len();
        (0..n).map(move |i| if self.matrix.is_empty() { self.process[i] } else { self.matrix[i * (n + 1)] })
    }

    /// A number on the diagonal of Q.
    pub(super) fn variance(&mut self, i: usize) -> &mut T {
        let n = self.process.len();
        if self.matrix.is_empty() { &mut self.process[i] } else { &mut self.matrix[i * (n + 1)] }
    }
}

impl<T: Number> Belief<T> {
    /// n
    #[inline(always)]
    pub(crate) fn size(&self) -> usize {
        self.mean.len()
    }

    /// Makes it a copy of another one of the same size, in its own memory, which a derived `clone_from` would not use.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.mean.copy_from_slice(&other.mean);
        self.cov.copy_from_slice(&other.cov);
    }

    /// `λ P + Q` in place of P. A variance that rounding made negative becomes zero.
    #[inline(always)]
    pub(crate) fn spread<L: Level>(&mut self, level: L, noise: &Noise<T>) {
        let n = level.size(self.size());
        if !noise.matrix.is_empty() {
            for j in 0..n {
                for at in j * n + j..(j + 1) * n {
                    self.cov[at] = self.cov[at] * noise.fading + noise.matrix[at];
                }
            }
            return self.clamp();
        }
        let (cov, process) = (&mut self.cov[..n * n], &noise.process[..n]);
        for j in 0..n {
            for entry in &mut cov[j * n + j..(j + 1) * n] {
                *entry = *entry * noise.fading;
            }
            let variance = cov[j * n + j] + process[j];
            cov[j * n + j] = T::select(variance.lt(T::of(0.0)), T::of(0.0), variance);
        }
    }

    /// Sets variances to zero that rounding made negative.
    #[inline(always)]
    pub(crate) fn clamp(&mut self) {
        let n = self.size();
        for j in 0..n {
            let variance = self.cov[j * n + j];
            self.cov[j * n + j] = T::select(variance.lt(T::of(0.0)), T::of(0.0), variance);
        }
    }

    /// Makes a component another one, which has mean zero and this variance and knows nothing of the others.
    #[inline(always)]
    pub(crate) fn renew(&mut self, place: usize, variance: T) {
        let n = self.size();
        self.mean[place] = T::of(0.0);
        for i in 0..n {
            let at = if i >= place { place * n + i } else { i * n + place };
            self.cov[at] = T::of(0.0);
        }
        self.cov[place * n + place] = variance;
    }

    /// The lanes with finite numbers, and those without a negative variance.
    #[inline(always)]
    pub(crate) fn check<L: Level>(&self, level: L) -> [T::Mask; 2] {
        let n = level.size(self.size());
        let (mean, cov) = (&self.mean[..n], &self.cov[..n * n]);
        let mut sum = T::of(0.0);
        let mut is_positive = T::Mask::of(true);
        for j in 0..n {
            // A sum is finite only if all its terms are, short of an overflow, which is as bad.
            let mut column = mean[j];
            for &entry in &cov[j * n + j..(j + 1) * n] {
                column = column + entry;
            }
            sum = sum + column;
            is_positive = is_positive & !cov[j * n + j].lt(T::of(0.0));
        }
        [sum.is_finite(), is_positive]
    }

    /// Gives a lane a belief that makes no trouble.
    pub(crate) fn park(&mut self, lane: usize) {
        let n = self.size();
        self.mean.iter_mut().for_each(|mean| mean.set_lane(lane, 0.0));
        for (at, entry) in self.cov.iter_mut().enumerate() {
            entry.set_lane(lane, if at % (n + 1) == 0 { 1.0 } else { 0.0 });
        }
    }
}
