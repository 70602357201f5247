//! Smoothers whose sizes the compiler knows.

use super::estimator::{build_filter, initial_belief, with_model};
use super::gaussian::{Factor, Gaussian, Matrix, mirrored};
use super::model::Model;
use super::plant::Visitor;
use super::{Correction, Filter, Linearised, SigmaPoints, Smoothable};
use crate::estimator::FilterContext;
use crate::filter::Rule;
use crate::sink::Sample;
use crate::smoother::Beliefs;
use crate::{Estimates, FilterError, FilterKind, FilterSettings, Quantity, Record};

/// The beliefs of a filter, if a kernel serves it.
pub(crate) fn beliefs(settings: &FilterSettings, context: FilterContext<'_>) -> Option<Box<dyn Beliefs>> {
    with_model(settings, &context, Start { settings, context }).flatten()
}

struct Start<'a> {
    settings: &'a FilterSettings,
    context: FilterContext<'a>,
}

impl Visitor for Start<'_> {
    type Output = Option<Box<dyn Beliefs>>;

    fn visit<P: Model<N>, const N: usize>(self, model: P) -> Option<Box<dyn Beliefs>> {
        let Self { settings, .. } = self;
        let belief = initial_belief(&model, settings);
        let linearised = |iterations| Linearised::new(belief.clone(), settings.propagation, iterations);
        let sigma_points = |rule| SigmaPoints::new(belief.clone(), rule);
        match settings.kind {
            kind if kind.is_sampled() => None,
            kind if kind == FilterKind::UKF || kind == FilterKind::SR_UKF => {
                Some(self.begin(model, sigma_points(Rule::Unscented)))
            }
            kind if kind == FilterKind::CKF => Some(self.begin(model, sigma_points(Rule::Cubature))),
            kind if kind == FilterKind::IEKF => Some(self.begin(model, linearised(settings.iterations))),
            kind if kind == FilterKind::KF || kind == FilterKind::EKF => Some(self.begin(model, linearised(1))),
            _ => None,
        }
    }
}

impl Start<'_> {
    fn begin<P: Model<N>, B: Smoothable<P, N> + 'static, const N: usize>(
        &self,
        model: P,
        belief: B,
    ) -> Box<dyn Beliefs> {
        Box::new(Smoothed {
            filter: build_filter(model, belief, self.settings, &self.context),
            sensors: self.context.sensors.to_vec(),
            dt: self.context.dt,
            filtered: Vec::new(),
            steps: Vec::new(),
        })
    }
}

struct Smoothed<P, B, const N: usize> {
    filter: Filter<P, B, N>,
    sensors: Vec<Quantity>,
    dt: f64,
    /// The belief after each sample: of the filter, then of the smoother.
    filtered: Vec<Gaussian<N>>,
    /// From each sample to the next: the belief before the latter, and its covariance with the belief after the former.
    steps: Vec<(Gaussian<N>, Matrix<N, N>)>,
}

impl<P: Model<N>, B: Smoothable<P, N>, const N: usize> Beliefs for Smoothed<P, B, N> {
    fn len(&self) -> usize {
        self.filtered.len()
    }

    fn filter(&mut self, [before, force]: [f64; 2], record: &Record, k: usize) -> Result<(), FilterError> {
        let Self { filter, sensors, dt, filtered, steps, .. } = self;
        if k > 0 {
            let cross = filter.belief().cross(filter.model(), before, *dt)?;
            filter.predict(before)?;
            let predicted = filter.belief().gaussian().into_owned();
            let mut correction = Correction::NOTHING;
            filter.update(force, &record.sample(k, sensors), &mut correction)?;
            steps.push((predicted, cross));
        }
        filtered.push(filter.belief().gaussian().into_owned());
        Ok(())
    }

    fn smooth(&mut self, k: usize) {
        let Self { filtered, steps, .. } = self;
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

    fn report(&self, k: usize, estimates: &mut Estimates) {
        let (belief, _) = self.filter.model().to_units(&self.filtered[k]);
        estimates.append(&Sample::unmeasured(belief.mean.as_slice(), belief.cov.as_slice()));
    }
}
