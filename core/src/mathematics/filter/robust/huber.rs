//! Huber's weights.

use super::RobustInfo;

/// The residual from which on a measurement pulls with constant force, in standard deviations of the sensor. With normal
/// noise the estimate is 95 % as precise as one without weights.
const LIMIT: f64 = 1.345;

pub(super) static HUBER: RobustInfo = RobustInfo {
    key: "huber",
    name: "Huber",
    description: "lets a reading beyond 1.345 standard deviations pull with constant force",
    reference: "Huber (1964), Robust estimation of a location parameter; Karlgaard and Schaub (2007), Huber-based divided difference filtering",
    passes: 10,
    is_probable: false,
    weight: |misfit| if misfit.residual <= LIMIT * LIMIT { 1.0 } else { LIMIT / misfit.residual.sqrt() },
};
