//! The innovations of an update, as they are reported, without those of sensors that measured nothing.

use super::Observation;
use crate::mathematics::engine::columns::{factor, square};
use crate::mathematics::engine::residuals::Innovations;
use crate::mathematics::linalg::{Matrix, Vector};

/// Memory for e, S and the factor of S.
#[derive(Clone, Debug, Default)]
pub(super) struct Reported {
    innovation: Vec<f64>,
    innovation_cov: Vec<f64>,
    factor: Vec<f64>,
}

impl Reported {
    /// The measurements of an observation, from e and S of all sensors; `None` where S is not positive definite.
    pub(super) fn innovations<'a>(
        &'a mut self,
        all: (&Vector, &Matrix),
        observation: &'a Observation,
    ) -> Option<Innovations<'a, f64>> {
        self.take(all, observation.sensors())?;
        let Self { innovation, innovation_cov, factor } = self;
        let (sensors, variances) = (observation.sensors(), observation.variances());
        Some(Innovations { sensors, innovation, innovation_cov, factor, variances })
    }

    /// NIS and det S over some sensors, from e and S of all; `None` without any, and where S is not positive definite.
    pub(super) fn squares(&mut self, all: (&Vector, &Matrix), sensors: &[usize]) -> Option<[f64; 2]> {
        let determinant = self.take(all, sensors)?;
        let Self { innovation, factor, .. } = self;
        (!sensors.is_empty()).then(|| [square(factor, sensors.len(), innovation), determinant])
    }

    /// Takes in e and S of some sensors. Returns det S.
    fn take(&mut self, (all, cov): (&Vector, &Matrix), sensors: &[usize]) -> Option<f64> {
        let Self { innovation, innovation_cov, factor: lower } = self;
        innovation.clear();
        innovation.extend(sensors.iter().map(|&sensor| all[sensor]));
        innovation_cov.clear();
        for &column in sensors {
            innovation_cov.extend(sensors.iter().map(|&row| cov[(row, column)]));
        }
        lower.clone_from(innovation_cov);
        let (determinant, is_positive) = factor(lower, sensors.len());
        is_positive.then_some(determinant)
    }
}
