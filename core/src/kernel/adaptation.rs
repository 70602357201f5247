//! Noise that a filter learns from its own innovations: the tuned twin.

use super::{Correction, Noise, Observation};
use crate::filter::Adaptation;
use crate::kernel::gaussian::{Factor, Matrix, Vector};

impl Adaptation {
    pub(super) fn adapt_kernel<const N: usize, const M: usize>(
        &self,
        observation: &Observation<M>,
        correction: &Correction<N>,
        noise: &mut Noise<N>,
    ) {
        let keep = self.forgetting;
        let measured = observation.measured();
        let innovation = |sensor: usize| correction.innovation[sensor];
        if self.process_noise {
            let mut shift = Vector::<N>::zeros();
            for active in measured {
                shift += Vector::from(correction.gain[active.sensor]) * innovation(active.sensor);
            }
            noise.process = noise.process * keep + shift * shift.transpose() * (1.0 - keep);
        }
        if self.sensor_noise {
            // Sensors without a measurement have a row of their own.
            let mut cov = Matrix::<M, M>::identity();
            let mut innovations = Vector::<M>::zeros();
            for (i, row) in measured.iter().enumerate() {
                innovations[i] = innovation(row.sensor);
                for (j, column) in measured.iter().enumerate() {
                    cov[(i, j)] = correction.innovation_cov[row.sensor][column.sensor];
                }
            }
            let Some(inverse) = Factor::new(&cov).map(|factor| factor.divide(&Matrix::<M, M>::identity())) else {
                return;
            };
            let white = inverse * innovations;
            for (row, active) in measured.iter().enumerate() {
                let r = active.variance;
                let residual = r * white[row];
                let seen = r - r * r * inverse[(row, row)];
                noise.sensors[active.sensor] = keep * r + (1.0 - keep) * (residual * residual + seen.max(0.0));
            }
        }
    }
}
