//! An oscillator that was plucked several times, with a pause in the readings while the hand pulled.

use super::ambient::has_no_input;
use super::{Suggestion, rounded};
use crate::{Channel, Record};

/// The whole record, whose longest part gives start values.
pub(super) struct Plucked {
    pub(super) whole: Record,
    /// When the later parts begin \[s\].
    times: Vec<f64>,
    /// The largest reading of all over that of the longest part.
    growth: f64,
}

/// A pause has at least this many usual gaps between readings, and a part this many readings.
const PAUSE: usize = 10;
const PART: usize = 100;

/// A free motion is smaller after a pause than before. One that is this many times as large was pulled.
const PULLED: f64 = 1.05;

impl Plucked {
    /// The longest part of a record without an input that swings more after each pause, and what is needed besides. `None` if it is no such
    /// record.
    pub(super) fn of(record: &Record) -> Option<(Record, Self)> {
        let measured = record.sensors().first().map(|_| record.measured(0)).filter(|_| has_no_input(record))?;
        let read: Vec<usize> = (0..record.len()).filter(|&k| !measured[k].is_nan()).collect();
        let gap = |i: usize| read[i] - read[i - 1];
        let mut sorted: Vec<usize> = (1..read.len()).map(gap).collect();
        sorted.sort_unstable();
        let usual = *sorted.get(sorted.len() / 2)?;
        let largest = |places: &[usize]| places.iter().fold(0.0, |most: f64, &k| most.max(measured[k].abs()));
        let pauses: Vec<usize> = (1..read.len()).filter(|&i| gap(i) >= PAUSE * usual).collect();
        let is_pulled = |&place: &usize| {
            let at = pauses[place];
            let before = place.checked_sub(1).map_or(0, |before| pauses[before]);
            let after = pauses.get(place + 1).copied().unwrap_or(read.len());
            largest(&read[at..after]) > PULLED * largest(&read[usize::midpoint(before, at)..at])
        };
        let begins: Vec<usize> = (0..pauses.len()).filter(is_pulled).map(|place| pauses[place]).collect();
        let ends: Vec<usize> = begins.iter().copied().chain([read.len()]).collect();
        let parts = || [0].into_iter().chain(begins.iter().copied()).zip(ends.iter().copied());
        if begins.is_empty() || parts().any(|(begin, end)| end - begin < PART) {
            return None;
        }
        let (begin, end) = parts().max_by_key(|(begin, end)| end - begin)?;
        let longest = record.part(read[begin]..read[end - 1] + 1);
        let growth = largest(&read) / largest(&read[begin..end]);
        let time = |&begin: &usize| libm::round((record.time(read[begin]) - 0.5 * record.dt()) * 1e6) / 1e6;
        let times = begins.iter().map(time).collect();
        Some((longest, Self { whole: record.clone(), times, growth }))
    }

    /// Lets every filter begin anew where it was plucked.
    pub(super) fn tell(&self, suggestion: &mut Suggestion) {
        for filter in suggestion.filters().filter(|filter| filter.can_be_plucked()) {
            filter.plucks.clone_from(&self.times);
            filter.initial_mean[Channel::DISPLACEMENT] = 0.0;
            for channel in [Channel::DISPLACEMENT, Channel::VELOCITY] {
                filter.initial_std[channel] = rounded(self.growth.max(1.0) * filter.initial_std[channel]);
            }
        }
        let times: Vec<String> = self.times.iter().map(|time| format!("{} s", rounded(*time))).collect();
        suggestion.reasons.push(format!(
            "plucked again at {}: each time the motion begins anew behind a pause, and what is known of ωₙ and ζ stays; start values are \
             those of the longest part",
            times.join(", ")
        ));
    }
}
