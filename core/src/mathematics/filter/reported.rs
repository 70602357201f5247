//! The innovations of an update, as they are reported, without those of sensors that measured nothing.

use super::{Correction, Observation};
use crate::mathematics::engine::columns::{factor, square};
use crate::mathematics::engine::residuals::Innovations;

/// Memory for e, S and the factor of S.
#[derive(Clone, Debug, Default)]
pub(super) struct Reported {
    innovation: Vec<f64>,
    innovation_cov: Vec<f64>,
    factor: Vec<f64>,
}

impl Reported {
    /// The measurements of an observation; `None` where S is not positive definite.
    pub(super) fn innovations<'a>(
        &'a mut self,
        correction: &Correction,
        observation: &'a Observation,
    ) -> Option<Innovations<'a, f64>> {
        self.take(correction, observation.sensors())?;
        let Self { innovation, innovation_cov, factor } = self;
        let (sensors, variances) = (observation.sensors(), observation.variances());
        Some(Innovations { sensors, innovation, innovation_cov, factor, variances })
    }

    /// NIS and det S over some sensors; `None` without any, and where S is not positive definite.
    pub(super) fn squares(&mut self, correction: &Correction, sensors: &[usize]) -> Option<[f64; 2]> {
        let determinant = self.take(correction, sensors)?;
        let Self { innovation, factor, .. } = self;
        (!sensors.is_empty()).then(|| [square(factor, sensors.len(), innovation), determinant])
    }

    /// Takes in e and S of some sensors. Returns det S.
    fn take(&mut self, correction: &Correction, sensors: &[usize]) -> Option<f64> {
        let Self { innovation, innovation_cov, factor: lower } = self;
        innovation.clear();
        innovation.extend(sensors.iter().map(|&sensor| correction.innovation[sensor]));
        innovation_cov.clear();
        for &column in sensors {
            innovation_cov.extend(sensors.iter().map(|&row| correction.innovation_cov[(row, column)]));
        }
        lower.clone_from(innovation_cov);
        let (determinant, is_positive) = factor(lower, sensors.len());
        is_positive.then_some(determinant)
    }
}
