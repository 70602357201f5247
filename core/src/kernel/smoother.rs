//! Estimates with hindsight: the whole record tells of every sample. The tuned twin.

use super::estimator::{build_filter, initial_belief, with_model};
use crate::estimator::FilterContext;
use crate::filter::Rule;
use crate::kernel::gaussian::{Factor, Gaussian, Matrix, mirrored};
use crate::kernel::model::Model;
use crate::kernel::plant::Visitor;
use crate::kernel::{Correction, Filter, Linearised, SigmaPoints, Smoothable};
use crate::sink::Sample;
use crate::{Estimates, FilterError, FilterKind, FilterSettings, Record};

/// Smooths a filter's estimates over the first `samples` of a record, as [`crate::smoother`] says. Returns whether a kernel
/// serves the filter; if not, there are no estimates.
pub(crate) fn smooth(
    settings: &FilterSettings,
    context: FilterContext<'_>,
    record: &Record,
    samples: usize,
    estimates: &mut Estimates,
) -> bool {
    with_model(settings, &context, Smooth { settings, context, record, samples, estimates }).unwrap_or(false)
}

struct Smooth<'a> {
    settings: &'a FilterSettings,
    context: FilterContext<'a>,
    record: &'a Record,
    samples: usize,
    estimates: &'a mut Estimates,
}

impl Visitor for Smooth<'_> {
    type Output = bool;

    fn visit<P: Model<N>, const N: usize>(self, model: P) -> bool {
        let Self { settings, context, record, samples, estimates } = self;
        let belief = initial_belief(&model, settings);
        let linearised = |iterations| Linearised::new(belief.clone(), settings.propagation, iterations);
        let sigma_points = |rule| SigmaPoints::new(belief.clone(), rule);
        let pass = Pass { settings, context: &context, record, samples };
        let way = match settings.kind {
            kind if kind == FilterKind::UKF || kind == FilterKind::SR_UKF => {
                pass.forth(&model, sigma_points(Rule::Unscented))
            }
            kind if kind == FilterKind::CKF => pass.forth(&model, sigma_points(Rule::Cubature)),
            kind if kind == FilterKind::IEKF => pass.forth(&model, linearised(settings.iterations)),
            kind if kind == FilterKind::KF || kind == FilterKind::EKF => pass.forth(&model, linearised(1)),
            _ => return false,
        };
        let stop = way.stop;
        for belief in back(way) {
            let (belief, _) = model.to_units(&belief);
            estimates.push(&Sample::unmeasured(belief.mean.as_slice(), belief.cov.as_slice()));
        }
        if let Some(reason) = stop {
            estimates.stop_at(reason);
        }
        true
    }
}

/// What a smoother must know of a filter's way.
struct Way<const N: usize> {
    /// The belief after each sample.
    filtered: Vec<Gaussian<N>>,
    /// From each sample to the next: the belief before the latter, and its covariance with the belief after the former.
    steps: Vec<(Gaussian<N>, Matrix<N, N>)>,
    stop: Option<FilterError>,
}

struct Pass<'a> {
    settings: &'a FilterSettings,
    context: &'a FilterContext<'a>,
    record: &'a Record,
    samples: usize,
}

impl Pass<'_> {
    fn forth<P: Model<N>, B: Smoothable<P, N>, const N: usize>(&self, model: &P, belief: B) -> Way<N> {
        let mut filter = build_filter(model.clone(), belief, self.settings, self.context);
        let mut way = Way { filtered: vec![filter.belief().gaussian().into_owned()], steps: Vec::new(), stop: None };
        for k in 1..self.samples {
            match self.step(&mut filter, k) {
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

    fn step<P: Model<N>, B: Smoothable<P, N>, const N: usize>(
        &self,
        filter: &mut Filter<P, B, N>,
        k: usize,
    ) -> Result<(Gaussian<N>, Matrix<N, N>), FilterError> {
        let Self { context: FilterContext { sensors, dt, .. }, record, .. } = self;
        let cross = filter.belief().cross(filter.model(), record.force(k - 1), *dt)?;
        filter.predict(record.force(k - 1))?;
        let predicted = filter.belief().gaussian().into_owned();
        let mut correction = Correction::NOTHING;
        filter.update(record.force(k), &record.sample(k, sensors), &mut correction)?;
        Ok((predicted, cross))
    }
}

/// The smoothed beliefs, from the first sample on.
fn back<const N: usize>(way: Way<N>) -> Vec<Gaussian<N>> {
    let Way { mut filtered, steps, .. } = way;
    for k in (0..steps.len()).rev() {
        let (predicted, cross) = &steps[k];
        let gain = Factor::semidefinite(&predicted.cov).divide(cross);
        let Gaussian { mean: next_mean, cov: next_cov } = filtered[k + 1].clone();
        let Gaussian { mean, cov } = &mut filtered[k];
        *mean += gain * (next_mean - predicted.mean);
        *cov = mirrored(*cov - gain * cross.transpose() + gain * next_cov * gain.transpose());
        for i in 0..N {
            // Zero but for rounding.
            cov[(i, i)] = cov[(i, i)].max(0.0);
        }
    }
    filtered
}
