//! Where samples come from.

use std::sync::Arc;

use crate::simulate::{Simulator, TruthStop};
use crate::{Record, Scenario};

/// Where the samples of a run come from.
#[derive(Clone, Debug, Default)]
pub enum Source {
    /// The scenario's own truth.
    #[default]
    Simulated,
    /// A given record, whose time between samples counts instead of the scenario's.
    Measured(Arc<Record>),
}

/// A record that is being simulated, or a given one.
pub(crate) enum Recording {
    /// As far as it is simulated and kept.
    Simulated {
        /// Appends to it.
        simulator: Box<Simulator>,
        /// The record.
        record: Record,
    },
    /// All of it.
    Measured(Arc<Record>),
}

impl Recording {
    /// The record of a valid scenario before its first sample, in the memory of one that is no longer needed; or a given one.
    pub(crate) fn new(scenario: &Scenario, source: Source, spare: Option<Record>) -> Self {
        match source {
            Source::Measured(record) => Self::Measured(record),
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

    /// Where its samples come from.
    pub(crate) fn source(&self) -> Source {
        match self {
            Self::Simulated { .. } => Source::Simulated,
            Self::Measured(record) => Source::Measured(Arc::clone(record)),
        }
    }

    /// The record.
    pub(crate) fn record(&self) -> &Record {
        match self {
            Self::Simulated { record, .. } => record,
            Self::Measured(record) => record,
        }
    }

    /// The record, where it is simulated and so can be taken apart.
    pub(crate) fn into_simulated(self) -> Option<Record> {
        match self {
            Self::Simulated { record, .. } => Some(record),
            Self::Measured(_) => None,
        }
    }

    /// How many samples the whole record of a scenario has.
    pub(crate) fn samples(&self, scenario: &Scenario) -> usize {
        match self {
            Self::Simulated { .. } => scenario.samples(),
            Self::Measured(record) => record.len(),
        }
    }

    /// The number of samples, from the beginning, that there are.
    pub(crate) fn len(&self) -> usize {
        let record = self.record();
        record.forgotten() + record.len()
    }

    /// Simulates until there are `samples` samples from the beginning. Returns whether there are: a truth can run away.
    pub(crate) fn advance_to(&mut self, samples: usize) -> bool {
        if let Self::Simulated { simulator, record } = self {
            while record.forgotten() + record.len() < samples {
                if !simulator.step(record) {
                    return false;
                }
            }
        }
        self.len() >= samples
    }

    /// Forgets the first samples of those that are kept. Only a simulated record can; returns whether it is one.
    pub(crate) fn forget(&mut self, samples: usize) -> bool {
        let Self::Simulated { record, .. } = self else { return false };
        record.forget(samples);
        true
    }

    /// Where the simulated truth stopped, if it could not go on.
    pub(crate) fn stop(&self) -> Option<TruthStop> {
        match self {
            Self::Simulated { simulator, .. } => simulator.stop(),
            Self::Measured(_) => None,
        }
    }
}
