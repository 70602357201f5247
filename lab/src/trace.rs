//! One run at a few times.

use kalmanscope_core::score::Look;
use kalmanscope_core::{Channel, Scenario};

use crate::plan::Plan;

/// The places of a run's numbers at the plan's times, within a cell's row: for each filter and each time NEES, NIS, and
/// error and standard deviation of each of the filter's channels. NaN without a value, for example after a filter has
/// stopped.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    begin: usize,
    samples: Vec<usize>,
    channels: Vec<Vec<Channel>>,
}

impl Trace {
    pub(crate) fn new(scenario: &Scenario, plan: &Plan) -> Self {
        let last = scenario.samples().saturating_sub(1);
        // Nothing is measured at the first sample.
        let sample = |nth: usize| (nth as f64 * last as f64 / plan.times as f64).round() as usize;
        let mut samples: Vec<usize> = (1..=plan.times).map(sample).filter(|sample| *sample > 0).collect();
        samples.dedup();
        let channels = |place: &usize| {
            let filter = scenario.filters.get(*place)?;
            Some(filter.model(scenario.plant.kind, scenario.input).channels().to_vec())
        };
        let channels = plan.filters.iter().filter_map(channels).collect();
        Self { begin: plan.filters.len() * plan.measures.len(), samples, channels }
    }

    /// The samples of the trace.
    pub fn samples(&self) -> &[usize] {
        &self.samples
    }

    /// The channels of the `nth` filter of the plan.
    pub fn channels(&self, nth: usize) -> &[Channel] {
        self.channels.get(nth).map_or(&[], Vec::as_slice)
    }

    /// The length of all traces in a row.
    pub(crate) fn width(&self) -> usize {
        self.channels.iter().map(|channels| self.samples.len() * stride(channels)).sum()
    }

    /// NEES and NIS of the `nth` filter at a time.
    pub fn squares(&self, row: &[f64], nth: usize, time: usize) -> [f64; 2] {
        let at = self.at(nth, time);
        [row[at], row[at + 1]]
    }

    /// Error and standard deviation of a channel of the `nth` filter at a time.
    pub fn error(&self, row: &[f64], nth: usize, time: usize, channel: usize) -> [f64; 2] {
        let at = self.at(nth, time) + 2 + 2 * channel;
        [row[at], row[at + 1]]
    }

    fn at(&self, nth: usize, time: usize) -> usize {
        let before: usize = self.channels[..nth].iter().map(|channels| self.samples.len() * stride(channels)).sum();
        self.begin + before + time * stride(&self.channels[nth])
    }

    /// Puts the looks at a run of the `nth` filter into a row.
    pub(crate) fn fill(&self, nth: usize, looks: &[Look], row: &mut [f64]) {
        if self.samples.is_empty() {
            return;
        }
        let begin = self.at(nth, 0);
        for (numbers, look) in row[begin..].chunks_mut(stride(&self.channels[nth])).zip(looks) {
            numbers[..2].copy_from_slice(&[look.nees, look.nis]);
            numbers[2..].copy_from_slice(look.channels.as_flattened());
        }
    }
}

fn stride(channels: &[Channel]) -> usize {
    2 + 2 * channels.len()
}
