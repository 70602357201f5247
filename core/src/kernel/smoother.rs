//! Estimates with hindsight: the whole record tells of every sample.

use super::estimator::{build_filter, initial_belief, with_model};
use crate::estimator::FilterContext;
use crate::filter::Rule;
use crate::kernel::gaussian::{Factor, Gaussian, Matrix, mirrored};
use crate::kernel::model::Model;
use crate::kernel::plant::Visitor;
use crate::kernel::{Correction, Filter, Linearised, SigmaPoints, Smoothable};
use crate::sink::Sample;
use crate::{Estimates, FilterError, FilterKind, FilterSettings, Quantity, Record, Stop};

/// A smoother in progress: the filter goes forward, the smoother back.
///
/// ```text
/// G = C (P⁻ₖ₊₁)⁻¹,  C = cov(yₖ, y⁻ₖ₊₁)
/// yₖˢ = yₖ + G (yˢₖ₊₁ - y⁻ₖ₊₁),  Pₖˢ = Pₖ + G (Pˢₖ₊₁ - P⁻ₖ₊₁) Gᵀ
/// ```
///
/// `C = P Φᵀ` for the KF, EKF and IEKF, and comes from the sigma points for UKF, SR-UKF and CKF. Sampled filters have no
/// smoother here: they give no estimates. Where the filter stops, the smoother begins with the last sample before.
///
/// Source: Rauch, Tung and Striebel (1965), Maximum likelihood estimates of linear dynamic systems; Särkkä (2008), Unscented
/// Rauch-Tung-Striebel smoother.
pub(crate) trait Smoothing: Send {
    /// Goes on for at most `steps` steps over the first `samples` samples of a record, which must be the same each time;
    /// appends to `estimates` at last. Returns whether all is done.
    fn advance(&mut self, record: &Record, samples: usize, steps: usize, estimates: &mut Estimates) -> bool;

    /// The share that is done, from 0 to 1.
    fn progress(&self, samples: usize) -> f64;
}

/// The smoother of a filter, if a kernel serves it.
pub(crate) fn smoother(settings: &FilterSettings, context: FilterContext<'_>) -> Option<Box<dyn Smoothing>> {
    with_model(settings, &context, Start { settings, context }).flatten()
}

struct Start<'a> {
    settings: &'a FilterSettings,
    context: FilterContext<'a>,
}

impl Visitor for Start<'_> {
    type Output = Option<Box<dyn Smoothing>>;

    fn visit<P: Model<N>, const N: usize>(self, model: P) -> Option<Box<dyn Smoothing>> {
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
            _ => Some(self.begin(model, linearised(1))),
        }
    }
}

impl Start<'_> {
    fn begin<P: Model<N>, B: Smoothable<P, N> + 'static, const N: usize>(
        &self,
        model: P,
        belief: B,
    ) -> Box<dyn Smoothing> {
        Box::new(Smoother {
            filter: build_filter(model, belief, self.settings, &self.context),
            sensors: self.context.sensors.to_vec(),
            dt: self.context.dt,
            filtered: Vec::new(),
            steps: Vec::new(),
            stop: None,
            stage: Stage::Forth,
        })
    }
}

/// How far a smoother has come.
#[derive(Clone, Copy)]
enum Stage {
    /// The filter is on its way.
    Forth,
    /// The samples before this one are to be smoothed.
    Back(usize),
    /// The samples from this one on are to be written down.
    Report(usize),
}

struct Smoother<P, B, const N: usize> {
    filter: Filter<P, B, N>,
    sensors: Vec<Quantity>,
    dt: f64,
    /// The belief after each sample: of the filter, then of the smoother.
    filtered: Vec<Gaussian<N>>,
    /// From each sample to the next: the belief before the latter, and its covariance with the belief after the former.
    steps: Vec<(Gaussian<N>, Matrix<N, N>)>,
    stop: Option<Stop>,
    stage: Stage,
}

impl<P: Model<N>, B: Smoothable<P, N>, const N: usize> Smoothing for Smoother<P, B, N> {
    fn advance(&mut self, record: &Record, samples: usize, steps: usize, estimates: &mut Estimates) -> bool {
        for _ in 0..steps {
            match self.stage {
                Stage::Forth => {
                    let k = self.filtered.len();
                    if k == samples || self.stop.is_some() {
                        self.stage = Stage::Back(k.saturating_sub(1));
                    } else if let Err(reason) = self.forth(record, k) {
                        self.stop = Some(Stop { sample: k, reason });
                    }
                }
                Stage::Back(0) => {
                    self.steps = Vec::new();
                    self.stage = Stage::Report(0);
                }
                Stage::Back(k) => {
                    self.back(k - 1);
                    self.stage = Stage::Back(k - 1);
                }
                Stage::Report(k) if k == self.filtered.len() => {
                    if let Some(stop) = self.stop {
                        estimates.set_stop(stop);
                    }
                    return true;
                }
                Stage::Report(k) => {
                    let (belief, _) = self.filter.model().to_units(&self.filtered[k]);
                    estimates.append(&Sample::unmeasured(belief.mean.as_slice(), belief.cov.as_slice()));
                    self.stage = Stage::Report(k + 1);
                }
            }
        }
        false
    }

    fn progress(&self, samples: usize) -> f64 {
        let of = |done: usize| done as f64 / samples.max(1) as f64;
        match self.stage {
            // The way forth takes the most time.
            Stage::Forth => 0.6 * of(self.filtered.len()),
            Stage::Back(k) => 0.6 + 0.3 * (1.0 - of(k)),
            Stage::Report(k) => 0.9 + 0.1 * of(k),
        }
    }
}

impl<P: Model<N>, B: Smoothable<P, N>, const N: usize> Smoother<P, B, N> {
    /// Filters sample `k`.
    fn forth(&mut self, record: &Record, k: usize) -> Result<(), FilterError> {
        let Self { filter, sensors, dt, filtered, steps, .. } = self;
        if k > 0 {
            let cross = filter.belief().cross(filter.model(), record.force(k - 1), *dt)?;
            filter.predict(record.force(k - 1))?;
            let predicted = filter.belief().gaussian().into_owned();
            let mut correction = Correction::NOTHING;
            filter.update(record.force(k), &record.sample(k, sensors), &mut correction)?;
            steps.push((predicted, cross));
        }
        filtered.push(filter.belief().gaussian().into_owned());
        Ok(())
    }

    /// Smooths sample `k`, whose successor is smooth.
    fn back(&mut self, k: usize) {
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
}
