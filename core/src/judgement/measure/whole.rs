//! The sums of a whole run, as measures look at them.

use super::Measure;
use crate::numbers::score::{ChannelScore, Outcome};
use crate::{Channel, Record};

/// The sums of one filter's run over a whole record.
#[derive(Clone, Copy)]
pub struct Whole<'a> {
    pub(super) record: &'a Record,
    pub(super) outcome: &'a Outcome,
    channels: &'a [Channel],
}

impl<'a> Whole<'a> {
    /// The sums of a filter with these channels over a record.
    pub fn new(record: &'a Record, outcome: &'a Outcome, channels: &'a [Channel]) -> Self {
        Self { record, outcome, channels }
    }

    pub(super) fn of(&self, measure: Measure) -> Sums<'_> {
        Sums { whole: self, channel: measure.channel }
    }
}

/// The sums that a measure of a channel needs.
pub(super) struct Sums<'a> {
    pub(super) whole: &'a Whole<'a>,
    channel: Option<Channel>,
}

impl Sums<'_> {
    /// A number from the score of the channel; NaN if its truth is not known.
    pub(super) fn score(&self, number: impl Fn(&ChannelScore) -> f64) -> f64 {
        let mut scores = self.whole.outcome.channels.iter();
        scores.find(|(channel, _)| Some(*channel) == self.channel).map_or(f64::NAN, |(_, score)| number(score))
    }

    fn place(&self) -> Option<usize> {
        self.whole.channels.iter().position(|channel| Some(*channel) == self.channel)
    }
}

/// The last standard deviation of the channel; NaN if the filter does not have it.
pub(super) fn std(sums: &Sums<'_>) -> f64 {
    sums.place().map_or(f64::NAN, |place| sums.whole.outcome.std[place])
}

/// The last mean of the channel in the canonical form of the oscillator, with a natural frequency that is not negative; NaN if
/// the filter does not have it.
pub(super) fn estimate(sums: &Sums<'_>) -> f64 {
    let Whole { channels, outcome, .. } = sums.whole;
    let frequency = channels.iter().position(|channel| *channel == Channel::NATURAL_FREQUENCY);
    let is_mirrored = frequency.is_some_and(|place| outcome.mean[place] < 0.0);
    let mean = sums.place().map_or(f64::NAN, |place| outcome.mean[place]);
    if is_mirrored && sums.channel.is_some_and(Channel::is_mirrored) { -mean } else { mean }
}
