//! The plan of an ensemble: the settings that it varies, and its scores.

use serde::{Deserialize, Serialize};

use kalmanscope_core::{Axis, Measure};

/// The axes, filters and measures of an ensemble, without its scenario: plain data for files and messages.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plan {
    /// The places of the filters to score, from 0 on.
    pub filters: Vec<usize>,
    /// The scores to take.
    pub measures: Vec<Measure>,
    /// The number of times, equally spaced over the record, at which each run is recorded, for Monte Carlo.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub times: usize,
    /// The settings to vary, in the order of the cells; without one there is a single cell.
    #[serde(default)]
    pub axes: Vec<Axis>,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes references")]
fn is_zero(count: &usize) -> bool {
    *count == 0
}
