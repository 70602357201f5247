//! A run for the lanes.

use kalmanscope_core::{Record, Scenario};

/// One filter of a scenario, to be run over a record.
#[derive(Clone, Copy, Debug)]
pub struct LaneRun<'a> {
    /// The scenario.
    pub scenario: &'a Scenario,
    /// The place of the filter in it.
    pub place: usize,
    /// The record.
    pub record: &'a Record,
}
