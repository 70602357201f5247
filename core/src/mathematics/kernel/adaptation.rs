//! Noise that a filter learns from its own innovations: the tuned version.

use super::observation::Active;
use super::{Correction, MAX_SENSORS, Noise};
use crate::mathematics::filter::Adaptation;
use crate::mathematics::kernel::gaussian::{Factor, Matrix, Vector};

type Readings = [f64; MAX_SENSORS];

impl Adaptation {
    pub(super) fn adapt_kernel<const N: usize>(
        &self,
        measured: &[Active],
        correction: &Correction<N>,
        noise: &mut Noise<N>,
        uncertainty: &mut [f64],
    ) {
        let Correction { innovation, innovation_cov, gain, .. } = correction;
        if self.process_noise {
            let keep = self.forgetting;
            let mut shift = Vector::<N>::zeros();
            for active in measured {
                shift += Vector::from(gain[active.sensor]) * innovation[active.sensor];
            }
            noise.process = noise.process * keep + shift * shift.transpose() * (1.0 - keep);
        }
        if self.sensor_noise {
            self.adapt_sensors(measured, innovation, innovation_cov, [&mut noise.sensors, uncertainty]);
        }
    }

    /// Learns R. Its type depends on no length that differs between filters, so that it is compiled once.
    fn adapt_sensors(
        &self,
        measured: &[Active],
        innovation: &Readings,
        innovation_cov: &[Readings; MAX_SENSORS],
        [variances, uncertainties]: [&mut [f64]; 2],
    ) {
        // Sensors without a measurement keep a row of the identity.
        let mut cov = Matrix::<MAX_SENSORS, MAX_SENSORS>::identity();
        let mut innovations = Vector::<MAX_SENSORS>::zeros();
        for (i, row) in measured.iter().enumerate() {
            innovations[i] = innovation[row.sensor];
            for (j, column) in measured.iter().enumerate() {
                cov[(i, j)] = innovation_cov[row.sensor][column.sensor];
            }
        }
        let Some(factor) = Factor::new(&cov) else { return };
        let inverse = factor.divide(&Matrix::<MAX_SENSORS, MAX_SENSORS>::identity());
        let white = inverse * innovations;
        for (row, active) in measured.iter().enumerate() {
            let r = active.variance;
            let residual = r * white[row];
            let seen = r - r * r * inverse[(row, row)];
            let known = [r, uncertainties[active.sensor]];
            [variances[active.sensor], uncertainties[active.sensor]] = self.learn(known, [residual, seen.max(0.0)]);
        }
    }
}
