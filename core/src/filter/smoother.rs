//! The Rauch-Tung-Striebel smoother.
//!
//! ```text
//! G = C (P⁻ₖ₊₁)⁻¹,  yₖˢ = yₖ + G (yˢₖ₊₁ - y⁻ₖ₊₁),  Pₖˢ = Pₖ - G Cᵀ + G Pˢₖ₊₁ Gᵀ
//! ```

use super::estimator::{build_filter, in_units, initial_belief};
use super::{Correction, Filter, FilterError, Gaussian};
use crate::estimator::FilterContext;
use crate::linalg::{Ldl, Matrix};
use crate::sink::Sample;
use crate::smoother::Beliefs;
use crate::{Estimates, FilterSettings, Quantity, Record};

/// The beliefs of a filter with these settings; none where it cannot begin.
pub(crate) fn beliefs(settings: &FilterSettings, context: &FilterContext<'_>) -> Option<Box<dyn Beliefs>> {
    let filter = build_filter(initial_belief(settings, context).ok()?, settings, context);
    let sensors = context.sensors.to_vec();
    Some(Box::new(Smoothed {
        filter,
        sensors,
        correction: Correction::default(),
        filtered: Vec::new(),
        steps: Vec::new(),
    }))
}

struct Smoothed {
    filter: Filter,
    sensors: Vec<Quantity>,
    correction: Correction,
    /// The belief after each sample: of the filter, then of the smoother.
    filtered: Vec<Gaussian>,
    /// From each sample to the next: the belief before the latter, and its covariance with the belief after the former.
    steps: Vec<(Gaussian, Matrix)>,
}

impl Beliefs for Smoothed {
    fn len(&self) -> usize {
        self.filtered.len()
    }

    fn filter(&mut self, forces: [f64; 2], record: &Record, k: usize) -> Result<(), FilterError> {
        let Self { filter, sensors, correction, filtered, steps } = self;
        if k > 0 {
            let cross = filter.belief().cross(filter.model(), filter.step(forces))?;
            filter.predict(forces)?;
            let predicted = filter.belief().gaussian().into_owned();
            filter.update(forces[1], &record.sample(k, sensors), correction)?;
            steps.push((predicted, cross));
        }
        filtered.push(filter.belief().gaussian().into_owned());
        Ok(())
    }

    fn smooth(&mut self, k: usize) {
        let (predicted, cross) = &self.steps[k];
        let gain = Ldl::semidefinite(&predicted.cov).divide(cross);
        let (now, later) = self.filtered.split_at_mut(k + 1);
        let (Gaussian { mean, cov }, next) = (&mut now[k], &later[0]);
        *mean += &gain * (&next.mean - &predicted.mean);
        *cov += &gain * &next.cov * gain.transpose() - &gain * cross.transpose();
        for i in 0..cov.nrows() {
            // Zero but for rounding.
            cov[(i, i)] = cov[(i, i)].max(0.0);
        }
        cov.fill_upper_triangle_with_lower_triangle();
    }

    fn report(&self, k: usize, estimates: &mut Estimates) {
        let (belief, _) = in_units(self.filter.model(), &self.filtered[k]);
        estimates.append(&Sample::unmeasured(belief.mean.as_slice(), belief.cov.as_slice()));
    }
}
