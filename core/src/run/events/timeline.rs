//! What has come, in the order of its times, and the course of the input through it.

use std::collections::VecDeque;

use kalmanscope_filters::Hold;

use crate::run::estimator::State;
use crate::run::passage::Passage;

#[derive(Clone, Debug)]
pub(super) struct TimedEvent {
    /// \[s\]
    pub(super) time: f64,
    /// The force over mass from now on \[m/s²\], if it was known.
    pub(super) force: Option<f64>,
    /// A reading for each sensor, NaN where there is none.
    pub(super) readings: Vec<f64>,
    pub(super) state: Option<State>,
    pub(super) passages: Vec<Passage>,
}

impl TimedEvent {
    pub(super) fn new(time: f64, force: Option<f64>, readings: Vec<f64>) -> Self {
        Self { time, force, readings, state: None, passages: Vec::new() }
    }
}

/// Events in the order of their times, the oldest first. Those of one time stand in the order in which they came.
#[derive(Debug)]
pub(super) struct Timeline {
    pub(super) events: VecDeque<TimedEvent>,
    hold: Hold,
    /// \[s\]
    kept: f64,
    before: Option<(f64, f64)>,
}

const MOST: usize = 1 << 16;

impl Timeline {
    pub(super) fn new(hold: Hold, kept: f64) -> Self {
        Self { events: VecDeque::new(), hold, kept, before: None }
    }

    pub(super) fn last_at(&self, time: f64) -> usize {
        self.place_until(time).unwrap_or(0)
    }

    pub(super) fn place_until(&self, time: f64) -> Option<usize> {
        self.events.partition_point(|event| event.time <= time).checked_sub(1)
    }

    /// Puts an event at its place. Returns the first place after which beliefs are no longer right.
    pub(super) fn insert(&mut self, event: TimedEvent) -> usize {
        let place = self.events.partition_point(|other| other.time <= event.time);
        let has_force = event.force.is_some();
        self.events.insert(place, event);
        // On a line between inputs, an input changes the force back to the one before it.
        match (self.hold, has_force) {
            (Hold::First, true) => {
                let before = self.events.range(..place).rposition(|event| event.force.is_some());
                before.map_or(place, |before| before + 1).min(place)
            }
            _ => place,
        }
    }

    /// The force over mass from the event before a place to that at the place, at the beginning and at the end \[m/s²\].
    pub(super) fn forces_to(&self, place: usize) -> [f64; 2] {
        let known = |event: &TimedEvent| event.force.map(|force| (event.time, force));
        let last = self.events.range(..place).rev().find_map(known).or(self.before);
        let Some((from, begin)) = last else { return [0.0; 2] };
        let next = || self.events.range(place..).find_map(known);
        match (self.hold, if self.hold == Hold::First { next() } else { None }) {
            (Hold::First, Some((to, end))) if to > from => {
                let at = |time: f64| begin + (end - begin) * ((time - from) / (to - from));
                let before = place.checked_sub(1).map_or(from, |before| self.events[before].time);
                let time = self.events[place].time;
                [at(before), if time == to { end } else { at(time) }]
            }
            _ => [begin; 2],
        }
    }

    pub(super) fn force_at(&self, place: usize) -> f64 {
        self.events[place].force.unwrap_or_else(|| self.forces_to(place)[1])
    }

    pub(super) fn forget(&mut self, now: f64, place: usize) -> usize {
        let mut forgotten = 0;
        while forgotten < place && (self.events[1].time < now - self.kept || self.events.len() > MOST) {
            let Some(TimedEvent { time, force, .. }) = self.events.pop_front() else { break };
            self.before = force.map(|force| (time, force)).or(self.before);
            forgotten += 1;
        }
        forgotten
    }
}
