//! Noise that a filter learns from an update.

use super::reported::Reported;
use super::{Adaptation, Correction, Noise, Observation};
use crate::mathematics::engine::residuals::Residuals;
use crate::mathematics::linalg::{Vector, fit_vector};

/// What is learnt, with memory to work in.
#[derive(Clone, Debug)]
pub(super) struct Learning {
    adaptation: Adaptation,
    reported: Reported,
    residuals: Residuals<f64>,
    /// K e
    shift: Vector,
    /// The variance of each R.
    uncertainty: Vec<f64>,
}

impl Learning {
    /// The memory to learn this, from this noise on.
    pub(super) fn new(adaptation: Adaptation, noise: &Noise) -> Self {
        Self {
            adaptation,
            reported: Reported::default(),
            residuals: Residuals::default(),
            shift: Vector::zeros(0),
            uncertainty: noise.sensors.iter().map(|r| adaptation.initial_uncertainty(*r)).collect(),
        }
    }

    /// The variance of each R by now.
    pub(super) fn uncertainty(&self) -> &[f64] {
        &self.uncertainty
    }

    /// Whether anything is learnt.
    pub(super) fn is_on(&self) -> bool {
        self.adaptation.is_on()
    }

    /// Learns from a correction by these measurements.
    pub(super) fn adapt(&mut self, observation: &Observation, correction: &Correction, noise: &mut Noise) {
        let Self { adaptation, reported, residuals, shift, uncertainty } = self;
        let sensors = observation.sensors();
        if adaptation.process_noise {
            let keep = adaptation.forgetting;
            fit_vector(shift, correction.gain.nrows());
            shift.fill(0.0);
            let counts = |sensor: &&usize| !correction.innovation[**sensor].is_nan();
            for &sensor in sensors.iter().filter(counts) {
                shift.axpy(correction.innovation[sensor], &correction.gain.column(sensor), 1.0);
            }
            noise.process.ger(1.0 - keep, shift, shift, keep);
        }
        if adaptation.sensor_noise {
            let Some(update) = reported.innovations(correction.reported(), observation) else { return };
            for (&sensor, &residual) in sensors.iter().zip(residuals.of(&update)) {
                let known = [noise.sensors[sensor], uncertainty[sensor]];
                [noise.sensors[sensor], uncertainty[sensor]] = adaptation.learn(known, residual);
            }
        }
    }
}
