//! Sources of samples.

use std::sync::Arc;

use crate::samples::bank::lookahead;
use crate::samples::simulate::{Simulator, TruthStop};
use crate::{Record, Scenario};

/// The source of a run's samples.
#[derive(Clone, Debug, Default)]
pub enum Source {
    /// A simulation of the scenario's truth.
    #[default]
    Simulated,
    /// A given record. Its time between samples replaces the scenario's.
    Measured(Arc<Record>),
    /// A given record to which samples are still added: [`Run::lengthen`](crate::Run::lengthen). Smoothers and free runs, which need the end, wait.
    Live(Arc<Record>),
}

impl Source {
    /// The record, if it is given.
    pub fn record(&self) -> Option<&Arc<Record>> {
        match self {
            Self::Simulated => None,
            Self::Measured(record) | Self::Live(record) => Some(record),
        }
    }

    /// Whether the samples are measured, not simulated.
    pub fn is_measured(&self) -> bool {
        self.record().is_some()
    }
}

pub(crate) enum Recording {
    Simulated { simulator: Box<Simulator>, record: Record },
    Given { record: Arc<Record>, is_live: bool },
}

impl Recording {
    /// The empty record of a valid scenario, in the memory of an old one; or a given one.
    pub(crate) fn new(scenario: &Scenario, source: Source, spare: Option<Record>) -> Self {
        match source {
            Source::Measured(record) => Self::Given { record, is_live: false },
            Source::Live(record) => Self::Given { record, is_live: true },
            Source::Simulated => {
                let simulator = Box::new(Simulator::new(scenario));
                let mut record = simulator.empty_record();
                if let Some(spare) = spare {
                    record.recycle(spare);
                }
                Self::Simulated { simulator, record }
            }
        }
    }

    pub(crate) fn source(&self) -> Source {
        match self {
            Self::Simulated { .. } => Source::Simulated,
            Self::Given { record, is_live: false } => Source::Measured(Arc::clone(record)),
            Self::Given { record, is_live: true } => Source::Live(Arc::clone(record)),
        }
    }

    pub(crate) fn record(&self) -> &Record {
        match self {
            Self::Simulated { record, .. } => record,
            Self::Given { record, .. } => record,
        }
    }

    pub(crate) fn into_simulated(self) -> Option<Record> {
        match self {
            Self::Simulated { record, .. } => Some(record),
            Self::Given { .. } => None,
        }
    }

    /// Of a live record those that a filter can do, which may read the input of later ones.
    pub(crate) fn samples(&self, scenario: &Scenario) -> usize {
        match self {
            Self::Simulated { .. } => scenario.samples(),
            Self::Given { record, is_live: false } => record.len(),
            Self::Given { record, is_live: true } => record.len().saturating_sub(lookahead(scenario, record.dt())),
        }
    }

    pub(crate) fn len(&self) -> usize {
        let record = self.record();
        record.forgotten() + record.len()
    }

    /// Counted from the beginning. Returns false if the truth has diverged before.
    pub(crate) fn advance_to(&mut self, samples: usize) -> bool {
        while self.len() < samples {
            if !self.advance_some(samples) {
                return false;
            }
        }
        true
    }

    /// The same, but stops after about a millisecond, even within a sample, if the plant is hard to simulate.
    pub(crate) fn advance_some(&mut self, samples: usize) -> bool {
        let Self::Simulated { simulator, record } = self else { return self.len() >= samples };
        simulator.advance_some(record, samples)
    }

    pub(crate) fn is_live(&self) -> bool {
        matches!(self, Self::Given { is_live: true, .. })
    }

    /// Takes a longer record in place of a live one. Returns false if it is not live, or the longer one does not go on from it.
    pub(crate) fn lengthen(&mut self, longer: Arc<Record>) -> bool {
        let Self::Given { record, is_live: true } = self else { return false };
        let goes_on = longer.goes_on_from(record);
        if goes_on {
            *record = longer;
        }
        goes_on
    }

    /// Forgets the first samples that are still kept. Returns false for a given record, which cannot be forgotten.
    pub(crate) fn forget(&mut self, samples: usize) -> bool {
        let Self::Simulated { record, .. } = self else { return false };
        record.forget(samples);
        true
    }

    pub(crate) fn stop(&self) -> Option<TruthStop> {
        match self {
            Self::Simulated { simulator, .. } => simulator.stop(),
            Self::Given { .. } => None,
        }
    }
}
