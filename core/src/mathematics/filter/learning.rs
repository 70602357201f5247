//! Noise that a filter learns from an update.

use super::{Adaptation, Correction, Noise, Observation};
use crate::mathematics::engine::columns::factor;
use crate::mathematics::engine::weights::{Innovations, Residuals};
use crate::mathematics::linalg::Vector;
use crate::mathematics::lists::{mapped, numbers};

#[derive(Clone, Debug)]
pub(super) struct Learning {
    pub(super) adaptation: Adaptation,
    residuals: Residuals<f64>,
    /// K e
    shift: Vector,
    pub(super) uncertainty: Vec<f64>,
    /// The sample, and the time between samples \[s\].
    pub(super) sample: usize,
    dt: f64,
}

impl Learning {
    pub(super) fn new(adaptation: Adaptation, noise: &Noise, dt: f64) -> Self {
        Self {
            adaptation,
            residuals: Residuals::default(),
            shift: Vector::zeros(0),
            uncertainty: mapped(&noise.sensors, &|r| adaptation.initial_uncertainty(*r)),
            sample: 0,
            dt,
        }
    }

    pub(super) fn is_on_now(&self) -> bool {
        self.adaptation.is_on() && self.adaptation.learns_at(self.sample, self.dt)
    }

    pub(super) fn adapt(&mut self, observation: &Observation, correction: &Correction, noise: &mut Noise) {
        let Self { adaptation, residuals, shift, uncertainty, .. } = self;
        let sensors = &observation.sensors[..];
        if adaptation.process_noise {
            let keep = adaptation.forgetting;
            *shift = Vector::zeros(correction.gain.nrows());
            for &sensor in sensors {
                shift.axpy(correction.innovation[sensor], &correction.gain.column(sensor), 1.0);
            }
            noise.process.ger(1.0 - keep, shift, shift, keep);
        }
        if adaptation.sensor_noise {
            let m = sensors.len();
            let innovation: Vec<f64> = mapped(sensors, &|&sensor| correction.innovation[sensor]);
            let innovation_cov: Vec<f64> =
                numbers(m * m, &|at| correction.innovation_cov[(sensors[at % m], sensors[at / m])]);
            let mut lower = innovation_cov.clone();
            let (_, is_positive) = factor(&mut lower, m);
            if !is_positive {
                return;
            }
            let update = Innovations {
                sensors,
                innovation: &innovation,
                innovation_cov: &innovation_cov,
                factor: &lower,
                variances: &observation.variances,
            };
            for (&sensor, &residual) in sensors.iter().zip(residuals.of(&update)) {
                let known = [noise.sensors[sensor], uncertainty[sensor]];
                [noise.sensors[sensor], uncertainty[sensor]] = adaptation.learn(known, residual);
            }
        }
    }
}
