//! The Rauch-Tung-Striebel smoother.

use super::estimator::{build_filter, in_units, initial_belief};
use super::{Correction, Filter, FilterError, Gaussian};
use crate::estimator::FilterContext;
use crate::linalg::{Ldl, Matrix};
use crate::sink::Sample;
use crate::{Estimates, FilterSettings, Record};

/// Smooths a filter's estimates over the first `samples` of a record, as [`crate::smoother`] says.
pub(crate) fn smooth(
    settings: &FilterSettings,
    context: &FilterContext<'_>,
    record: &Record,
    samples: usize,
    estimates: &mut Estimates,
) {
    let belief = match initial_belief(settings, context) {
        Ok(belief) => belief,
        Err(reason) => return estimates.stop_at(reason),
    };
    let model = context.model(settings);
    let Way { filtered, steps, stop } = forth(build_filter(belief, settings, context), context, record, samples);
    for belief in back(filtered, &steps) {
        let (belief, _) = in_units(&model, &belief);
        estimates.push(&Sample::unmeasured(belief.mean.as_slice(), belief.cov.as_slice()));
    }
    if let Some(reason) = stop {
        estimates.stop_at(reason);
    }
}

/// What a smoother must know of a filter's way.
struct Way {
    /// The belief after each sample.
    filtered: Vec<Gaussian>,
    /// From each sample to the next: the belief before the latter, and its covariance with the belief after the former.
    steps: Vec<(Gaussian, Matrix)>,
    stop: Option<FilterError>,
}

fn forth(mut filter: Filter, context: &FilterContext<'_>, record: &Record, samples: usize) -> Way {
    let mut correction = Correction::default();
    let mut way = Way { filtered: vec![filter.belief().gaussian().into_owned()], steps: Vec::new(), stop: None };
    let mut step = |filter: &mut Filter, k: usize| -> Result<(Gaussian, Matrix), FilterError> {
        let forces = [record.force(k - 1), record.force(k)];
        let cross = filter.belief().cross(filter.model(), filter.step(forces))?;
        filter.predict(forces)?;
        let predicted = filter.belief().gaussian().into_owned();
        filter.update(record.force(k), &record.sample(k, context.sensors), &mut correction)?;
        Ok((predicted, cross))
    };
    for k in 1..samples {
        match step(&mut filter, k) {
            Ok(step) => way.steps.push(step),
            Err(reason) => {
                way.stop = Some(reason);
                break;
            }
        }
        way.filtered.push(filter.belief().gaussian().into_owned());
    }
    way
}

/// The smoothed beliefs, from the first sample on.
///
/// ```text
/// G = C (P⁻ₖ₊₁)⁻¹,  yₖˢ = yₖ + G (yˢₖ₊₁ - y⁻ₖ₊₁),  Pₖˢ = Pₖ - G Cᵀ + G Pˢₖ₊₁ Gᵀ
/// ```
fn back(mut filtered: Vec<Gaussian>, steps: &[(Gaussian, Matrix)]) -> Vec<Gaussian> {
    for (k, (predicted, cross)) in steps.iter().enumerate().rev() {
        let gain = Ldl::semidefinite(&predicted.cov).divide(cross);
        let (now, later) = filtered.split_at_mut(k + 1);
        let (Gaussian { mean, cov }, next) = (&mut now[k], &later[0]);
        *mean += &gain * (&next.mean - &predicted.mean);
        *cov += &gain * &next.cov * gain.transpose() - &gain * cross.transpose();
        for i in 0..cov.nrows() {
            // Zero but for rounding.
            cov[(i, i)] = cov[(i, i)].max(0.0);
        }
        cov.fill_upper_triangle_with_lower_triangle();
    }
    filtered
}
