//! The readings of one sensor, and the course of the input, around the sample that is completed next.

use std::collections::VecDeque;

use crate::Hold;
use crate::data::even_steps::change;
use crate::data::record::Timed;

#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    /// The time of the first one \[s\].
    pub(super) begin: f64,
    pub(super) dt: f64,
}

impl Grid {
    /// A time \[s\] in steps after the first sample. One that is next to a sample's is that.
    pub(super) fn steps(self, time: f64) -> f64 {
        let steps = (time - self.begin) / self.dt;
        let whole = libm::round(steps);
        if (steps - whole).abs() <= ROUNDED { whole } else { steps }
    }
}

/// A time may be rounded by this share of a step.
const ROUNDED: f64 = 1e-6;

/// The times, in steps, and readings of one sensor, in the order of their times.
#[derive(Clone, Debug, Default)]
pub(super) struct Track {
    times: VecDeque<f64>,
    values: VecDeque<f64>,
    taken: usize,
}

impl Track {
    pub(super) fn waiting(&self) -> usize {
        self.times.len() - self.taken
    }

    pub(super) fn put(&mut self, time: f64, value: f64) -> bool {
        let place = self.times.partition_point(|other| *other < time);
        let is_new = self.times.get(place) != Some(&time);
        if is_new {
            self.times.insert(place, time);
            self.values.insert(place, value);
        }
        is_new
    }

    /// Hands over the readings of the step to a sample. Returns the last one, shifted to the sample along the cubic through `side`
    /// readings to either side; NaN if there is none. Forgets what no later sample needs.
    pub(super) fn step_to(&mut self, sample: f64, side: usize, into: &mut Timed) -> f64 {
        let Self { times, values, taken } = self;
        let end = times.partition_point(|time| *time <= sample);
        let own = *taken..end.max(*taken);
        into.times.extend(times.range(own.clone()));
        into.values.extend(values.range(own.clone()));
        *taken = own.end;
        let last = own.last();
        let value = last.map_or(f64::NAN, |last| self.values[last] + self.shift(last, sample, side));
        let old = self.taken.saturating_sub(2 * side + 1);
        self.times.drain(..old);
        self.values.drain(..old);
        self.taken -= old;
        value
    }

    fn shift(&self, place: usize, to: f64, side: usize) -> f64 {
        let length = 2 * side + 1;
        if side == 0 || self.times.len() < length {
            return 0.0;
        }
        let begin = place.saturating_sub(side).min(self.times.len() - length);
        let around = begin..begin + length;
        let readings = self.times.range(around.clone()).zip(self.values.range(around));
        change(readings, self.times[place], to - self.times[place], side as f64)
    }
}

/// The input as it is told, with times in steps.
#[derive(Clone, Debug)]
pub(super) struct InputTrack {
    told: VecDeque<(f64, f64)>,
    /// The number of those that samples have taken; all but the last one are forgotten.
    taken: usize,
    hold: Hold,
}

impl InputTrack {
    pub(super) fn new(hold: Hold) -> Self {
        Self { told: VecDeque::new(), taken: 0, hold }
    }

    /// Of several values at a time the last one counts.
    pub(super) fn put(&mut self, time: f64, value: f64) {
        let place = self.told.partition_point(|(other, _)| *other < time);
        match self.told.get_mut(place) {
            Some(same) if same.0 == time => same.1 = value,
            _ => self.told.insert(place, (time, value)),
        }
    }

    pub(super) fn waits_at(&self, sample: f64) -> bool {
        self.hold == Hold::First && self.told.back().is_some_and(|(time, _)| *time < sample)
    }

    /// Hands over what was told in the step to a sample, and the value there, of a line between two values also that; it is zero before
    /// the first one. `into` is `None` until something is told.
    pub(super) fn step_to(&mut self, sample: f64, into: &mut Option<Timed>) -> f64 {
        let Self { told, taken, hold } = self;
        let next = told.partition_point(|(time, _)| *time <= sample).max(*taken);
        if next > 0 && into.is_none() {
            // Until then it was zero: from the first sample on, and on a line up to the last one.
            let mut times = vec![0.0];
            if *hold == Hold::First && sample > 1.0 {
                times.push(sample - 1.0);
            }
            times.retain(|zero| *zero < told[0].0);
            *into = Some(Timed { values: vec![0.0; times.len()], times });
        }
        let value = match (next.checked_sub(1).map(|last| told[last]), told.get(next)) {
            (None, _) => 0.0,
            (Some((from, value)), Some(&(to, then))) if *hold == Hold::First => {
                value + (then - value) * (sample - from) / (to - from)
            }
            (Some((_, value)), _) => value,
        };
        if let Some(Timed { times, values }) = into {
            for (time, value) in told.range(*taken..next) {
                times.push(*time);
                values.push(*value);
            }
            if *hold == Hold::First && times.last().is_some_and(|last| *last < sample) {
                times.push(sample);
                values.push(value);
            }
        }
        // The last one still counts.
        let old = next.saturating_sub(1);
        told.drain(..old);
        *taken = next - old;
        value
    }
}
