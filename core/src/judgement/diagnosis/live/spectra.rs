//! The spectra of the windows of a periodogram, each computed once.

use std::ops::Range;

use super::innovations::LiveInnovations;
use super::series::Series;
use crate::judgement::diagnosis::periodogram::{Periodogram, WelchWindows};

/// The spectra of windows that begin at multiples of their length from the run's beginning, of all sensors.
#[derive(Debug, Default)]
pub(super) struct LiveSpectra {
    windows: Option<WelchWindows>,
    /// For each window the powers of the sensors, two by two.
    powers: Option<Series<Vec<Vec<[f64; 2]>>>>,
}

impl LiveSpectra {
    /// Takes in the new windows in some samples, and forgets the windows before.
    pub(super) fn follow(&mut self, samples: &Range<usize>, innovations: &LiveInnovations) {
        let length = WelchWindows::length_for(samples.len());
        if self.windows.as_ref().map(WelchWindows::length) != length {
            *self = Self { windows: WelchWindows::of(samples.len()), powers: None };
        }
        let Some(windows) = &mut self.windows else { return };
        let first = samples.start.div_ceil(windows.length());
        let kept = self.powers.take().filter(|powers| (powers.first()..=powers.end()).contains(&first));
        let powers = self.powers.insert(kept.unwrap_or_else(|| Series::starting_at(first)));
        while (powers.end() + 1) * windows.length() <= samples.end {
            let begin = powers.end() * windows.length();
            let values: Vec<&[f64]> = innovations.values(&(begin..begin + windows.length())).collect();
            let pairs = values.chunks(2).map(|pair| windows.powers(pair[0], pair.get(1).copied()).to_vec());
            powers.push(pairs.collect());
        }
        powers.forget_before(first);
    }

    /// The periodogram of each sensor, of windows that have no sample outside some ranges in ascending order.
    pub(super) fn of(&self, kept: &[Range<usize>], sensors: usize) -> Vec<Periodogram> {
        let (Some(windows), Some(powers)) = (&self.windows, &self.powers) else {
            return vec![Periodogram::default(); sensors];
        };
        let mut all = vec![Periodogram::empty(windows.length()); sensors];
        for number in numbers(kept, windows.length()) {
            for (of_pair, pair) in all.chunks_mut(2).zip(powers.at(number)) {
                for (of, one) in of_pair.iter_mut().enumerate() {
                    one.add(pair.iter().map(|both| both[of]));
                }
            }
        }
        all.into_iter().map(|one| one.averaged(windows)).collect()
    }
}

/// The numbers of the windows of a length that fit into ranges. Adjacent ranges count as one.
fn numbers(kept: &[Range<usize>], length: usize) -> Vec<usize> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for range in kept {
        match runs.last_mut() {
            Some(before) if before.end == range.start => before.end = range.end,
            _ => runs.push(range.clone()),
        }
    }
    runs.iter().flat_map(|run| run.start.div_ceil(length)..run.end / length).collect()
}
