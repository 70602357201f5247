//! What was applied and measured, simulated or from a file.

mod csv_file;

pub use csv_file::RecordError;

use crate::{Channel, Hold, InputKind, Quantity};

/// Equally spaced samples of the input, measurements and, where it is known, the truth.
///
/// A run can forget its first samples ([`Run::forget`](crate::Run::forget)). Samples are told by their index among those
/// that are kept; by their number, counted from the run's beginning, only where it says so ([`Self::time_of`]).
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    dt: f64,
    start: f64,
    forgotten: usize,
    kind: InputKind,
    hold: Hold,
    input: Vec<f64>,
    sensors: Vec<Quantity>,
    measured: Vec<Vec<f64>>,
    truth_channels: Vec<Channel>,
    truth: Vec<Vec<f64>>,
}

impl Record {
    pub(crate) fn empty(
        dt: f64,
        kind: InputKind,
        hold: Hold,
        sensors: Vec<Quantity>,
        truth_channels: Vec<Channel>,
    ) -> Self {
        Self {
            dt,
            start: 0.0,
            forgotten: 0,
            kind,
            hold,
            input: Vec::new(),
            measured: vec![Vec::new(); sensors.len()],
            sensors,
            truth: vec![Vec::new(); truth_channels.len()],
            truth_channels,
        }
    }

    /// Takes over the memory of a record that is no longer needed.
    pub(crate) fn recycle(&mut self, old: Self) {
        let new = std::iter::once(&mut self.input).chain(&mut self.measured).chain(&mut self.truth);
        let old = std::iter::once(old.input).chain(old.measured).chain(old.truth);
        for (new, mut old) in new.zip(old) {
            old.clear();
            *new = old;
        }
    }

    /// Forgets the first `samples`, in place.
    pub(crate) fn forget(&mut self, samples: usize) {
        let Self {
            dt: _,
            start: _,
            forgotten,
            kind: _,
            hold: _,
            input,
            sensors: _,
            measured,
            truth_channels: _,
            truth,
        } = self;
        *forgotten += samples;
        for column in std::iter::once(input).chain(measured).chain(truth) {
            column.drain(..samples);
        }
    }

    pub(crate) fn push(
        &mut self,
        input: f64,
        measured: impl IntoIterator<Item = f64>,
        truth: impl IntoIterator<Item = f64>,
    ) {
        self.input.push(input);
        for (column, value) in self.measured.iter_mut().zip(measured) {
            column.push(value);
        }
        for (column, value) in self.truth.iter_mut().zip(truth) {
            column.push(value);
        }
    }

    /// Time between samples \[s\].
    pub fn dt(&self) -> f64 {
        self.dt
    }

    /// Time of sample `k` of those that are kept \[s\].
    pub fn time(&self, k: usize) -> f64 {
        self.time_of(self.forgotten + k)
    }

    /// Time of the sample with this number from the run's beginning \[s\], kept or not, and also beyond the last.
    pub fn time_of(&self, number: usize) -> f64 {
        self.start + number as f64 * self.dt
    }

    /// How many samples have been forgotten: the number of the first one that is kept.
    pub fn forgotten(&self) -> usize {
        self.forgotten
    }

    /// The number of samples that are kept.
    pub fn len(&self) -> usize {
        self.input.len()
    }

    /// Whether there is no sample.
    pub fn is_empty(&self) -> bool {
        self.input.is_empty()
    }

    /// The input at every sample \[m/s²\].
    pub fn input(&self) -> &[f64] {
        &self.input
    }

    /// What the input is.
    pub fn input_kind(&self) -> InputKind {
        self.kind
    }

    /// How the input runs between samples.
    pub fn hold(&self) -> Hold {
        self.hold
    }

    /// The force over mass at sample `k` \[m/s²\].
    #[inline]
    pub fn force(&self, k: usize) -> f64 {
        self.kind.force(self.input[k])
    }

    /// What is measured.
    pub fn sensors(&self) -> &[Quantity] {
        &self.sensors
    }

    /// All measurements of one sensor, in its quantity's unit; NaN where one is missing.
    pub fn measured(&self, sensor: usize) -> &[f64] {
        &self.measured[sensor]
    }

    /// All measurements of one quantity, if there is a sensor for it.
    pub fn measured_quantity(&self, quantity: Quantity) -> Option<&[f64]> {
        self.sensors.iter().position(|&s| s == quantity).map(|i| self.measured(i))
    }

    /// What sample `k` has of some quantities; NaN where one is missing or not measured at all.
    pub(crate) fn sample(&self, k: usize, quantities: &[Quantity]) -> Vec<f64> {
        quantities.iter().map(|&q| self.measured_quantity(q).map_or(f64::NAN, |values| values[k])).collect()
    }

    /// The true values of a channel, if they are known; NaN where one is missing.
    pub fn truth(&self, channel: Channel) -> Option<&[f64]> {
        self.truth_place(channel).map(|i| self.truth[i].as_slice())
    }

    /// The place of a channel among those whose truth is known.
    pub(crate) fn truth_place(&self, channel: Channel) -> Option<usize> {
        self.truth_channels.iter().position(|&c| c == channel)
    }

    /// The true value at sample `k` of the channel in a place that [`Self::truth_place`] gave.
    pub(crate) fn truth_at(&self, place: usize, k: usize) -> f64 {
        self.truth[place][k]
    }
}
