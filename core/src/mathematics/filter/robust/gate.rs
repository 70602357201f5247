//! A gate: measurements too far from their prediction are left out.

use super::RobustInfo;

/// Limits the distance of a measurement from its prediction, in standard deviations: normal noise passes it once in 16,000
/// readings.
const LIMIT: f64 = 4.0;

pub(super) static GATE: RobustInfo = RobustInfo {
    key: "gate",
    name: "gate",
    description: "leaves out a reading more than 4 standard deviations from its prediction",
    reference: "Bar-Shalom, Li and Kirubarajan (2001), *Estimation with Applications to Tracking and Navigation*, section 5.4",
    passes: 1,
    is_probable: false,
    weight: |misfit| if misfit.predicted <= LIMIT * LIMIT { 1.0 } else { 0.0 },
};
