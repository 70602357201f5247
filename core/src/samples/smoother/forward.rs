//! A filter on its way forward.

use crate::mathematics::engine;
use crate::mathematics::filter::{FilterError, Gaussian};
use crate::samples::estimator::FilterContext;
use crate::samples::estimator::bounded::{Truncating, Truncation};
use crate::samples::estimator::in_units::InUnits;
use crate::samples::passage::{Passage, Passages};
use crate::samples::sink::{Sample, Sink};
use crate::{Estimates, FilterSettings, Pass, Record, Stop};

/// A filter whose beliefs are smoothed later: a pass over the record, which keeps its passages.
pub(crate) struct Forward {
    pass: Pass,
    sink: Passages,
    hindsight: Hindsight,
}

/// Smoothed beliefs in the units of the channels, between their bounds.
pub(crate) struct Hindsight {
    in_units: Option<Box<InUnits>>,
    truncation: Truncation,
}

impl Forward {
    /// The filter with these settings before its first sample, over sensors in these columns of a record. `None` if it has no passages.
    pub(crate) fn new(settings: &FilterSettings, context: &FilterContext, sensors: Vec<usize>) -> Option<Self> {
        let one = FilterSettings { guesses: 1, process_scales: 1, walk: 0.0, ..settings.clone() };
        let pass = Pass::with_passages(&one, context, sensors)?;
        Some(Self { pass, sink: Passages::default(), hindsight: Hindsight::new(settings, context) })
    }

    /// The belief after the next sample, and the passages to it in order: none for the first one, where the filter begins.
    pub(crate) fn filter(&mut self, record: &Record) -> Result<(Gaussian, Vec<Passage>), Stop> {
        let Self { pass, sink, .. } = self;
        pass.follow(record, pass.done() + 1, sink);
        let passages = std::mem::take(&mut sink.all);
        match (sink.stop, sink.belief.take()) {
            (None, Some(belief)) => Ok((belief, passages)),
            (stop, _) => Err(stop.unwrap_or(Stop { sample: pass.done(), reason: FilterError::NotFinite })),
        }
    }

    pub(crate) fn report(&mut self, belief: &Gaussian, estimates: &mut Estimates) {
        self.hindsight.report(belief, estimates);
    }
}

impl Hindsight {
    pub(crate) fn new(settings: &FilterSettings, context: &FilterContext) -> Self {
        let model = context.model(settings);
        let in_units = InUnits::new(&engine::model::Model::of(&model).logarithms, model.size(), 0);
        Self { in_units, truncation: Truncation::of(settings, model.channels()) }
    }

    /// Hands a belief to a sink, whatever its numbers are in the channels' units.
    pub(crate) fn report(&mut self, Gaussian { mean, cov }: &Gaussian, sink: &mut dyn Sink) {
        let Self { in_units, truncation } = self;
        let sample = Sample::unmeasured(mean.as_slice(), cov.as_slice());
        let mut sink = Truncating { truncation, sink };
        match in_units.as_deref_mut() {
            Some(in_units) => sink.push(&in_units.take(sample).0),
            None => sink.push(&sample),
        }
    }
}
