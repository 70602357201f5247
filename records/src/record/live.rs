//! A record that becomes longer while readings come in.

use std::collections::VecDeque;
use std::ops::Range;
use std::sync::Arc;

use kalmanscope_filters::lists::mapped;
use kalmanscope_filters::{Hold, InputKind, Quantity};
use thiserror::Error;

use super::clocks::snapped;
use super::{Clocks, Record, Timed};
use crate::resample::change;

/// A record to which samples are added as they come in: readings and input keep their times ([`Record::clocks`]), the samples are dt
/// apart, from the first reading on, or from half a step after it where readings are shifted.
///
/// A reading counts in the step in which it falls, and its column has the last one of each step: shifted to the step's end along the
/// cubic through those around it, where they are dense, as [`Self::smoothing`] says. Of two readings of a sensor at one time the first
/// is kept. The input is that of the scenario's hold, and zero before the first one that is given. A sample is complete once something
/// later comes, and [`Self::waiting`] seconds after it, unless it is [`Self::prompt`]; nothing is added to its step then.
///
/// ```
/// use kalmanscope_records::record::LiveRecord;
/// use kalmanscope_filters::{Hold, InputKind, Quantity};
/// let mut live = LiveRecord::new(0.01, InputKind::Force, Hold::Zero, vec![Quantity::VELOCITY]);
/// for (time, velocity) in [(5.0, 0.0), (5.0099, 0.1), (5.0196, 0.2), (5.0404, 0.4), (5.05, 0.5)] {
///     live.take(time, f64::NAN, &[velocity])?;
/// }
/// let velocity = live.record().measured(0);
/// assert_eq!(velocity[..3], [0.0, 0.1, 0.2]);
/// assert!(velocity[3].is_nan() && velocity[4].is_nan());
/// let times = &live.record().clocks().unwrap().readings[0].times;
/// assert!((times[2] - 1.96).abs() < 1e-9, "in steps of dt after the first");
/// # Ok::<(), kalmanscope_records::record::LiveError>(())
/// ```
#[derive(Clone, Debug)]
pub struct LiveRecord {
    record: Record,
    /// \[s\]
    begin: Option<f64>,
    /// \[s\]
    newest: f64,
    tracks: Vec<Track>,
    input: Track,
    /// Of each sensor, then of the input, in steps.
    latest: Vec<f64>,
    /// A reading out of order ends this.
    prompt: bool,
    wait: f64,
    side: usize,
    repeated: usize,
    /// Once nobody else keeps it, only what it lacks has to be copied.
    spare: Option<Arc<Record>>,
}

/// Limits the wait for the next input \[s\], where the input is linear between two values.
const PATIENCE: f64 = 1.0;

/// [`LiveRecord::update`] copies a whole record when it is longer by 1 / SHARE.
const SHARE: usize = 20_000;

impl LiveRecord {
    /// Limits the samples.
    pub const MOST: usize = 200_000;

    /// Limits the readings of a sensor, and the values of the input: all are kept.
    pub const MOST_READINGS: usize = 1_000_000;

    /// Limits the readings of a sensor that wait for their samples.
    pub const MOST_WAITING: usize = 100_000;

    /// Limits the steps of dt between two times.
    pub const LONGEST_GAP: usize = 20_000;

    /// Before the first reading, with `dt` \[s\] between samples.
    pub fn new(dt: f64, kind: InputKind, hold: Hold, sensors: Vec<Quantity>) -> Self {
        let clocks = Clocks { input: None, readings: vec![Timed::default(); sensors.len()] };
        Self {
            tracks: mapped(&sensors, &|_| Track::default()),
            latest: vec![f64::NEG_INFINITY; sensors.len() + 1],
            prompt: false,
            record: Record { clocks: Some(Arc::new(clocks)), ..Record::empty(dt, kind, hold, sensors, Vec::new()) },
            begin: None,
            newest: f64::NEG_INFINITY,
            input: Track::default(),
            wait: 0.0,
            side: 0,
            repeated: 0,
            spare: None,
        }
    }

    /// The same, where a sample waits this many seconds for late readings.
    #[must_use]
    pub fn waiting(self, seconds: f64) -> Self {
        Self { wait: seconds.max(0.0), ..self }
    }

    /// The same, where a sample does not wait once every sensor, and the input if any was given, has a reading at its time or later.
    /// The first reading out of order is refused if it comes too late; from then on samples wait.
    #[must_use]
    pub fn prompt(self) -> Self {
        Self { prompt: true, ..self }
    }

    /// The same, where the columns have the readings shifted along the cubic through this many to either side. They have to lie within a
    /// third of half a swing. A sample waits for two more.
    #[must_use]
    pub fn smoothing(self, side: usize) -> Self {
        let wait = if side > 0 { self.wait.max(2.0 * self.record.dt) } else { self.wait };
        Self { side, wait, ..self }
    }

    /// The samples that are complete, with the times of the readings in them. The first one's time is zero.
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// The record so far.
    pub fn so_far(&self) -> Arc<Record> {
        Arc::new(self.record.clone())
    }

    /// Puts the record so far in place of an earlier one of this live record. Returns whether it did: a longer one costs what is new,
    /// as long as nobody else keeps the one before; else it is copied, once it is longer by a small share.
    pub fn update(&mut self, earlier: &mut Arc<Record>) -> bool {
        if self.record.len() <= earlier.len() {
            return false;
        }
        let is_much = self.record.len() > earlier.len() + earlier.len() / SHARE;
        let spare = self.spare.get_or_insert_with(|| Arc::clone(earlier));
        if let Some(spare) = Arc::get_mut(spare).filter(|spare| self.record.goes_on_from(spare)) {
            spare.append(&self.record);
        } else if is_much {
            *spare = Arc::new(self.record.clone());
        } else {
            return false;
        }
        std::mem::swap(earlier, spare);
        true
    }

    /// Completes all samples up to the newest time: nothing more comes.
    pub fn finish(&mut self) {
        self.complete_until(|newest, _, sample| sample > newest);
    }

    /// The time of the first sample in the clock of the readings \[s\].
    pub fn begin(&self) -> Option<f64> {
        self.begin
    }

    /// Readings that were left out because another one of their sensor has their time.
    pub fn repeated(&self) -> usize {
        self.repeated
    }

    /// Takes in the events at a time \[s\]: the input from then on \[m/s²\], NaN if it is not given, and a reading for each
    /// sensor in the unit of its quantity, NaN where there is none.
    ///
    /// # Errors
    /// [`LiveError`]; a refusal leaves the samples as they were.
    pub fn take(&mut self, time: f64, input: f64, readings: &[f64]) -> Result<(), LiveError> {
        self.check(time, input, readings).inspect_err(|error| {
            self.prompt &= !matches!(error, LiveError::TooLate { .. });
        })?;
        let dt = self.record.dt;
        // A reading that comes too early or too late by less than half a step is then the only one in its step.
        let begin = if self.side > 0 { time + 0.5 * dt } else { time };
        let begin = *self.begin.get_or_insert(begin);
        self.newest = self.newest.max(time);
        let time = steps(time - begin, dt);
        for (track, &reading) in self.tracks.iter_mut().zip(readings).filter(|(_, reading)| !reading.is_nan()) {
            self.repeated += usize::from(track.put(time, reading).is_some());
        }
        // Of several inputs at a time the last one counts.
        if !input.is_nan()
            && let Some(before) = self.input.put(time, input)
        {
            *before = input;
        }
        for (latest, value) in self.latest.iter_mut().zip(readings.iter().chain([&input])) {
            if !value.is_nan() {
                self.prompt &= time >= *latest;
                *latest = latest.max(time);
            }
        }
        let hold = self.record.hold;
        self.complete_until(|newest, live, sample| {
            let late = (newest - sample) * live.record.dt;
            let wait = if live.has_all_readings(sample) { 0.0 } else { live.wait };
            let waits_for_input = || hold == Hold::First && live.input.times.back().is_some_and(|time| *time < sample);
            newest <= sample || late < wait || (late < PATIENCE && waits_for_input())
        });
        Ok(())
    }

    fn has_all_readings(&self, sample: f64) -> bool {
        let Some((input, sensors)) = self.latest.split_last() else { return false };
        let is_there = sensors.iter().all(|latest| *latest >= sample);
        self.prompt && self.side == 0 && is_there && (*input >= sample || *input == f64::NEG_INFINITY)
    }

    /// `waits` takes the newest time and the sample's, in steps.
    fn complete_until(&mut self, waits: impl Fn(f64, &Self, f64) -> bool) {
        let Some(begin) = self.begin else { return };
        let newest = steps(self.newest - begin, self.record.dt);
        while self.record.len() < Self::MOST && !waits(newest, self, self.record.len() as f64) {
            self.complete(self.record.len() as f64);
        }
    }

    fn check(&self, time: f64, input: f64, readings: &[f64]) -> Result<(), LiveError> {
        if readings.len() != self.tracks.len() {
            return Err(LiveError::Readings(readings.len(), self.tracks.len()));
        }
        if !time.is_finite() || input.is_infinite() || readings.iter().any(|reading| reading.is_infinite()) {
            return Err(LiveError::Infinite);
        }
        let Some(begin) = self.begin else { return Ok(()) };
        if self.record.len() >= Self::MOST || self.kept() >= Self::MOST_READINGS {
            return Err(LiveError::Full);
        }
        let last = self.record.len() as f64 - 1.0;
        if steps(time - begin, self.record.dt) <= last {
            return Err(LiveError::TooLate(time, begin + last * self.record.dt));
        }
        let is_behind = time <= self.newest + self.wait + PATIENCE + self.record.dt;
        if is_behind && self.tracks.iter().any(|track| track.waiting() >= Self::MOST_WAITING) {
            return Err(LiveError::Burst);
        }
        let steps = (time - self.newest) / self.record.dt;
        if steps > Self::LONGEST_GAP as f64 {
            return Err(LiveError::Gap(time, self.newest));
        }
        Ok(())
    }

    fn kept(&self) -> usize {
        let all = self.record.clocks().into_iter().flat_map(|clocks| clocks.readings.iter().chain(&clocks.input));
        all.map(|timed| timed.times.len()).max().unwrap_or(0)
    }

    fn complete(&mut self, sample: f64) {
        let Self { record, tracks, input, side, .. } = self;
        let Clocks { input: told, readings } = Arc::make_mut(record.clocks.get_or_insert_default());
        let measured: Vec<f64> =
            tracks.iter_mut().zip(readings).map(|(track, timed)| track.reading_at(sample, *side, timed)).collect();
        let input = input.input_at(sample, record.hold, told);
        record.push(input, measured, std::iter::empty());
    }
}

/// The reason why a [`LiveRecord`] does not take in what came.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum LiveError {
    /// The number of readings is not that of the sensors: both of them.
    #[error("there are {0} readings, but the record has {1} sensors: a missing reading is NaN")]
    Readings(usize, usize),
    /// A number is infinite, or the time is NaN.
    #[error("a reading, the input or the time is no finite number")]
    Infinite,
    /// Its sample is complete: its time, and that of the last complete sample \[s\].
    #[error("the time is {0} s, which is too late: the record is complete until {1} s")]
    TooLate(f64, f64),
    /// The clock stands still, or is far too slow, while readings come.
    #[error("{} readings of a sensor wait for their samples: the clock hardly advances", LiveRecord::MOST_WAITING)]
    Burst,
    /// Nothing came for too long: the time, and the newest time before it \[s\].
    #[error("the time is {0} s, but before it was {1} s: at most {most} steps may be empty", most = LiveRecord::LONGEST_GAP)]
    Gap(f64, f64),
    /// There are as many samples, or readings of a sensor, as a record may have.
    #[error(
        "the record is full: it has at most {} samples and {} readings of a sensor",
        LiveRecord::MOST,
        LiveRecord::MOST_READINGS
    )]
    Full,
}

fn steps(time: f64, dt: f64) -> f64 {
    snapped(time / dt)
}

/// Values that wait for their samples, and the last ones that samples have taken.
#[derive(Clone, Debug, Default)]
struct Track {
    times: VecDeque<f64>,
    values: VecDeque<f64>,
    taken: usize,
}

impl Track {
    fn waiting(&self) -> usize {
        self.times.len() - self.taken
    }

    /// Returns the value that has this time already, which stays.
    fn put(&mut self, time: f64, value: f64) -> Option<&mut f64> {
        let place = self.times.partition_point(|other| *other < time);
        if self.times.get(place) == Some(&time) {
            return self.values.get_mut(place);
        }
        self.times.insert(place, time);
        self.values.insert(place, value);
        None
    }

    fn take_until(&mut self, sample: f64, into: &mut Timed) -> Range<usize> {
        let own = self.taken..self.times.partition_point(|time| *time <= sample).max(self.taken);
        into.times.extend(self.times.range(own.clone()));
        into.values.extend(self.values.range(own.clone()));
        self.taken = own.end;
        own
    }

    fn forget_all_but(&mut self, last: usize) {
        let old = self.taken.saturating_sub(last);
        self.times.drain(..old);
        self.values.drain(..old);
        self.taken -= old;
    }

    /// Returns the last reading, shifted to the sample along the cubic through `side` readings to either side; NaN if there is none.
    fn reading_at(&mut self, sample: f64, side: usize, into: &mut Timed) -> f64 {
        let last = self.take_until(sample, into).last();
        let value = last.map_or(f64::NAN, |last| self.values[last] + self.shift(last, sample, side));
        self.forget_all_but(2 * side + 1);
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

    /// Returns the input, zero before the first value; `into` is `None` until there is one. On a line it also has the value at the sample.
    fn input_at(&mut self, sample: f64, hold: Hold, into: &mut Option<Timed>) -> f64 {
        if self.times.front().is_none_or(|first| *first > sample) {
            return 0.0;
        }
        let timed = into.get_or_insert_with(|| {
            // The input was zero before: from the first sample on, and on a line up to the last one.
            let mut times = vec![0.0];
            if hold == Hold::First && sample > 1.0 {
                times.push(sample - 1.0);
            }
            times.retain(|zero| *zero < self.times[0]);
            Timed { values: vec![0.0; times.len()], times }
        });
        let next = self.take_until(sample, timed).end;
        let (from, value) = (self.times[next - 1], self.values[next - 1]);
        let value = match self.times.get(next) {
            Some(to) if hold == Hold::First => value + (self.values[next] - value) * (sample - from) / (to - from),
            _ => value,
        };
        if hold == Hold::First && timed.times.last().is_some_and(|last| *last < sample) {
            timed.times.push(sample);
            timed.values.push(value);
        }
        self.forget_all_but(1);
        value
    }
}
