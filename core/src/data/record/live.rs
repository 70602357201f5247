//! A record that becomes longer while readings come in.

mod error;
mod track;

use std::sync::Arc;

use super::Record;
use crate::{Hold, InputKind, Quantity};

use track::{InputTrack, Track};

pub use error::LiveError;

/// A record to which samples are added as they come in: sensors and input have times of their own, the samples are dt apart.
///
/// Each reading goes to its nearest sample; of several the nearest one is kept. Where readings are dense, as
/// [`Self::smoothing`] says, it is shifted there along the cubic through those around it. The input is that of the scenario's
/// hold, and zero before the first one that is told; one that is held counts from its nearest sample on. A sample is complete
/// once something comes that is half a step later, and [`Self::waiting`] seconds more, unless it is [`Self::prompt`]; nothing is added to
/// it then.
///
/// ```
/// use kalmanscope_core::record::LiveRecord;
/// use kalmanscope_core::{Hold, InputKind, Quantity};
/// let mut live = LiveRecord::new(0.01, InputKind::Force, Hold::Zero, vec![Quantity::VELOCITY]);
/// for (time, velocity) in [(5.0, 0.0), (5.0101, 0.1), (5.0199, 0.2), (5.0402, 0.4), (5.05, 0.5)] {
///     live.take(time, f64::NAN, &[velocity])?;
/// }
/// let velocity = live.record().measured(0);
/// assert_eq!(velocity[..3], [0.0, 0.1, 0.2]);
/// assert!(velocity[3].is_nan() && velocity[4] == 0.4);
/// # Ok::<(), kalmanscope_core::record::LiveError>(())
/// ```
#[derive(Clone, Debug)]
pub struct LiveRecord {
    record: Record,
    /// The times of the first sample and of the newest that was told \[s\].
    begin: Option<f64>,
    newest: f64,
    tracks: Vec<Track>,
    input: InputTrack,
    /// The newest time of each sensor, then that of the input \[s\].
    latest: Vec<f64>,
    /// Whether a sample is complete as soon as all sensors have told something later. A reading out of order ends this.
    prompt: bool,
    wait: f64,
    side: usize,
    crowded: usize,
}

/// The time for which a sample waits for the next input, where the input is linear between two values \[s\].
const PATIENCE: f64 = 1.0;

/// [`LiveRecord::update`] copies a record when it is longer by 1 / SHARE.
const SHARE: usize = 20_000;

/// A time may be rounded by this share of a step.
const ROUNDED: f64 = 1e-6;

impl LiveRecord {
    /// Limits the samples.
    pub const MOST: usize = 200_000;

    /// Limits the readings of a sensor that wait for their samples.
    pub const MOST_WAITING: usize = 100_000;

    /// Limits the steps of dt between two times.
    pub const LONGEST_GAP: usize = 20_000;

    /// Before the first reading, with `dt` \[s\] between samples.
    pub fn new(dt: f64, kind: InputKind, hold: Hold, sensors: Vec<Quantity>) -> Self {
        Self {
            tracks: sensors.iter().map(|_| Track::default()).collect(),
            latest: vec![f64::NEG_INFINITY; sensors.len() + 1],
            prompt: false,
            record: Record::empty(dt, kind, hold, sensors, Vec::new()),
            begin: None,
            newest: f64::NEG_INFINITY,
            input: InputTrack::new(hold),
            wait: 0.0,
            side: 0,
            crowded: 0,
        }
    }

    /// The same, where a sample waits this many seconds for late readings.
    #[must_use]
    pub fn waiting(self, seconds: f64) -> Self {
        Self { wait: seconds.max(0.0), ..self }
    }

    /// The same, where a sample does not wait once every sensor, and the input if any was told, has told something that is half a step
    /// later: then nothing more comes as long as each tells its readings in order. The first that comes too late is refused; from then
    /// on samples wait.
    #[must_use]
    pub fn prompt(self) -> Self {
        Self { prompt: true, ..self }
    }

    /// The same, where each reading is shifted along the cubic through this many readings to either side. They have to lie within
    /// a third of half a swing. A sample waits for two more.
    #[must_use]
    pub fn smoothing(self, side: usize) -> Self {
        let wait = if side > 0 { self.wait.max(2.0 * self.record.dt) } else { self.wait };
        Self { side, wait, ..self }
    }

    /// The samples that are complete. The first one's time is zero.
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// The record so far.
    pub fn so_far(&self) -> Arc<Record> {
        Arc::new(self.record.clone())
    }

    /// Puts the record so far in place of an earlier one, if it is longer by a small share: the copy takes time. Returns whether
    /// it did.
    pub fn update(&self, earlier: &mut Arc<Record>) -> bool {
        let is_longer = self.record.len() > earlier.len() + earlier.len() / SHARE;
        if is_longer {
            *earlier = self.so_far();
        }
        is_longer
    }

    /// Completes all samples up to the newest time: nothing more comes.
    pub fn finish(&mut self) {
        self.complete_until(|newest, _, at| at > newest);
    }

    /// The time of the first sample in the clock of the readings \[s\].
    pub fn begin(&self) -> Option<f64> {
        self.begin
    }

    /// Readings that were left out because another one was nearer to their sample, or taken before they came.
    pub fn crowded(&self) -> usize {
        self.crowded
    }

    /// Takes in what happened at a time \[s\]: the input from then on \[m/s²\], NaN if it is not told, and a reading for each
    /// sensor in the unit of its quantity, NaN where there is none.
    ///
    /// # Errors
    /// [`LiveError`]; what is refused leaves the samples as they were.
    pub fn take(&mut self, time: f64, input: f64, readings: &[f64]) -> Result<(), LiveError> {
        self.check(time, input, readings).inspect_err(|error| {
            self.prompt &= !matches!(error, LiveError::TooLate { .. });
        })?;
        self.begin.get_or_insert(time);
        self.newest = self.newest.max(time);
        for (track, &reading) in self.tracks.iter_mut().zip(readings).filter(|(_, reading)| !reading.is_nan()) {
            track.put(time, reading);
        }
        if !input.is_nan() {
            self.input.put(time, input);
        }
        for (latest, value) in self.latest.iter_mut().zip(readings.iter().chain([&input])) {
            if !value.is_nan() {
                self.prompt &= time >= *latest;
                *latest = latest.max(time);
            }
        }
        self.complete_until(|newest, live, at| {
            let late = newest - at - 0.5 * live.record.dt;
            let wait = if live.all_are_later(at) { 0.0 } else { live.wait };
            late < wait || (late < PATIENCE && live.input.waits_at(at, ROUNDED * live.record.dt))
        });
        Ok(())
    }

    /// Whether nothing more can come for a sample at a time \[s\], as long as all tell their readings in order.
    fn all_are_later(&self, at: f64) -> bool {
        let end = at + 0.5 * self.record.dt;
        let (input, sensors) =
            self.latest.split_last().map_or((f64::NEG_INFINITY, &[][..]), |(input, all)| (*input, all));
        let is_told = input > f64::NEG_INFINITY;
        self.prompt && self.side == 0 && sensors.iter().all(|latest| *latest >= end) && (input >= end || !is_told)
    }

    /// Completes samples until one has to wait, which is asked with the newest time and that of the sample \[s\].
    fn complete_until(&mut self, waits: impl Fn(f64, &Self, f64) -> bool) {
        let Some(begin) = self.begin else { return };
        while self.record.len() < Self::MOST {
            let at = begin + self.record.len() as f64 * self.record.dt;
            if waits(self.newest, self, at) {
                break;
            }
            self.complete(at);
        }
    }

    fn check(&self, time: f64, input: f64, readings: &[f64]) -> Result<(), LiveError> {
        if readings.len() != self.tracks.len() {
            return Err(LiveError::Readings { found: readings.len(), expected: self.tracks.len() });
        }
        if !time.is_finite() || input.is_infinite() || readings.iter().any(|reading| reading.is_infinite()) {
            return Err(LiveError::Infinite);
        }
        let Some(begin) = self.begin else { return Ok(()) };
        if self.record.len() >= Self::MOST {
            return Err(LiveError::Full);
        }
        let complete = begin + (self.record.len() as f64 - 0.5) * self.record.dt;
        if time < complete {
            return Err(LiveError::TooLate { time, complete });
        }
        let is_behind = time <= self.newest + self.wait + PATIENCE + self.record.dt;
        if is_behind && self.tracks.iter().any(|track| track.len() >= Self::MOST_WAITING) {
            return Err(LiveError::Burst);
        }
        let steps = (time - self.newest) / self.record.dt;
        if steps > Self::LONGEST_GAP as f64 {
            return Err(LiveError::Gap { time, before: self.newest });
        }
        Ok(())
    }

    /// Adds the sample at a time \[s\].
    fn complete(&mut self, at: f64) {
        let Self { record, tracks, input, side, crowded, .. } = self;
        let dt = record.dt;
        let measured: Vec<f64> = tracks
            .iter_mut()
            .map(|track| {
                let (value, passed) = track.at(at, dt, *side);
                *crowded += passed;
                value
            })
            .collect();
        record.push(input.at(at, dt), measured, std::iter::empty());
    }
}
