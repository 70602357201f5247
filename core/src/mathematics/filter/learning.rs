//! Noise that a filter learns from an update.

use super::{Adaptation, Correction, Noise, Observation};
use crate::mathematics::linalg::Vector;

impl Adaptation {
    /// Learns from a correction by these measurements.
    pub(super) fn adapt(&self, observation: &Observation, correction: &Correction, noise: &mut Noise) {
        let keep = self.forgetting;
        let sensors = observation.sensors();
        if self.process_noise {
            let mut shift = Vector::zeros(correction.gain.nrows());
            let counts = |sensor: &&usize| !correction.innovation[**sensor].is_nan();
            for &sensor in sensors.iter().filter(counts) {
                shift.axpy(correction.innovation[sensor], &correction.gain.column(sensor), 1.0);
            }
            noise.process.ger(1.0 - keep, &shift, &shift, keep);
        }
        if self.sensor_noise {
            let Some(residuals) = correction.residuals(observation) else { return };
            for ((&sensor, &r), [residual, uncertainty]) in sensors.iter().zip(observation.variances()).zip(residuals) {
                noise.sensors[sensor] = keep * r + (1.0 - keep) * (residual * residual + uncertainty);
            }
        }
    }
}
