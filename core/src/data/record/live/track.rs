//! The readings of one sensor, and the course of the input, around the sample that is completed next.

use std::collections::VecDeque;

use crate::Hold;
use crate::data::local_cubic::change;

/// The times \[s\] and readings of one sensor, in the order of their times.
#[derive(Clone, Debug)]
pub(super) struct Track {
    times: VecDeque<f64>,
    values: VecDeque<f64>,
    /// The time of the last reading that a sample has taken \[s\].
    used: f64,
}

impl Default for Track {
    fn default() -> Self {
        Self { times: VecDeque::new(), values: VecDeque::new(), used: f64::NEG_INFINITY }
    }
}

impl Track {
    pub(super) fn len(&self) -> usize {
        self.times.len()
    }

    pub(super) fn put(&mut self, time: f64, value: f64) {
        let place = self.times.partition_point(|other| *other <= time);
        self.times.insert(place, time);
        self.values.insert(place, value);
    }

    /// The reading at a sample, NaN if there is none, and the number of those that were passed over. Forgets what no later sample
    /// needs.
    ///
    /// Where readings are dense, a sample without one of its own takes one that a neighbour leaves over.
    pub(super) fn at(&mut self, at: f64, dt: f64, side: usize) -> (f64, usize) {
        let Self { times, used, .. } = self;
        let place_of = |limit: f64| times.partition_point(|time| *time < limit);
        let [before, first, end, after] = [-1.0, -0.5, 0.5, 1.5].map(|steps| place_of(at + steps * dt));
        let fresh = times.partition_point(|time| *time <= *used);
        let distance = |k: &usize| (times[*k] - at).abs();
        let own = (first.max(fresh)..end).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let left_over = || (before.max(fresh)..first).next_back().or((after >= end + 2).then_some(end));
        let taken = if side > 0 { own.or_else(left_over) } else { own };
        let value = taken.map_or(f64::NAN, |k| self.values[k] + self.shift(k, at, dt, side));
        let passed = taken.map_or(0, |k| k - fresh);
        if let Some(k) = taken {
            self.used = self.times[k];
        }
        let old = first.saturating_sub(2 * side + 1);
        self.times.drain(..old);
        self.values.drain(..old);
        (value, passed)
    }

    /// What the reading at a place changes until a time.
    fn shift(&self, place: usize, to: f64, dt: f64, side: usize) -> f64 {
        let length = 2 * side + 1;
        if side == 0 || self.times.len() < length {
            return 0.0;
        }
        let begin = place.saturating_sub(side).min(self.times.len() - length);
        let around = begin..begin + length;
        let readings = self.times.range(around.clone()).zip(self.values.range(around));
        change(readings, self.times[place], to - self.times[place], dt * side as f64)
    }
}

/// The input as it is told.
#[derive(Clone, Debug)]
pub(super) struct InputTrack {
    told: VecDeque<(f64, f64)>,
    hold: Hold,
}

impl InputTrack {
    pub(super) fn new(hold: Hold) -> Self {
        Self { told: VecDeque::new(), hold }
    }

    pub(super) fn put(&mut self, time: f64, value: f64) {
        let place = self.told.partition_point(|(other, _)| *other <= time);
        self.told.insert(place, (time, value));
    }

    /// Whether the value at a time \[s\] depends on one that has not come yet.
    pub(super) fn waits_at(&self, at: f64, slack: f64) -> bool {
        self.hold == Hold::First && self.told.back().is_some_and(|(time, _)| *time < at - slack)
    }

    /// The input at a sample \[s\]; zero before the first one. Forgets what no later sample needs.
    pub(super) fn at(&mut self, at: f64, dt: f64) -> f64 {
        // A held input changes at its nearest sample, where its line's readings go too.
        let slack = if self.hold == Hold::Zero { 0.5 * dt } else { 0.0 };
        let next = self.told.partition_point(|(time, _)| *time <= at + slack);
        self.told.drain(..next.saturating_sub(1));
        let Some(&(from, value)) = self.told.front().filter(|_| next > 0) else { return 0.0 };
        match self.told.get(1).filter(|_| self.hold == Hold::First) {
            Some(&(to, then)) if to > from => value + (then - value) * (at - from) / (to - from),
            _ => value,
        }
    }
}
