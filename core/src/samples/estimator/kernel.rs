//! A filter of any kind over a common plant, with its types and sizes erased.

use crate::mathematics::filter::Rule;
use crate::mathematics::kernel::gaussian::{Gaussian, Matrix, Vector};
use crate::mathematics::kernel::model::{Model, Output};
use crate::mathematics::kernel::plant::{Visitor, visit};
use crate::mathematics::kernel::{Belief, Correction, Filter, Linearised, MAX_SENSORS, Noise, SigmaPoints};
use crate::mathematics::model::Hold;
use crate::samples::estimator::{Estimator, FilterContext};
use crate::samples::sink::{AssumedNoise, Sample, Sink};
use crate::{Estimates, FilterError, FilterKind, FilterSettings, Propagation, Quantity, Values};

/// A filter and the result of its last measurement update.
struct Followed<P, B, const N: usize> {
    filter: Filter<P, B, N>,
    correction: Correction<N>,
}

impl<P: Model<N>, B: Belief<P, N>, const N: usize> Estimator for Followed<P, B, N> {
    fn begin(&self, sink: &mut dyn Sink) -> Result<(), FilterError> {
        // An update checks that a belief is finite; nothing has checked the initial one.
        if !self.filter.noise().is_finite() || !self.filter.belief().gaussian().is_finite() {
            return Err(FilterError::TooLarge);
        }
        let prior = sink.wants_prior().then(|| self.filter.belief().gaussian().into_owned());
        report(&self.filter, &Correction::NOTHING, prior.as_ref(), sink);
        Ok(())
    }

    fn step(
        &mut self,
        force_before: f64,
        force: f64,
        measured: &[f64],
        sink: &mut dyn Sink,
    ) -> Result<(), FilterError> {
        let Self { filter, correction } = self;
        filter.predict(force_before)?;
        let prior = sink.wants_prior().then(|| filter.belief().gaussian().into_owned());
        filter.update(force, measured, correction)?;
        report(filter, correction, prior.as_ref(), sink);
        Ok(())
    }
}

/// Writes a sample to the sink.
fn report<P: Model<N>, B: Belief<P, N>, const N: usize>(
    filter: &Filter<P, B, N>,
    correction: &Correction<N>,
    prior: Option<&Gaussian<N>>,
    sink: &mut dyn Sink,
) {
    let belief = filter.belief().gaussian();
    let noise = filter.is_adaptive().then(|| (filter.noise(), filter.noise_uncertainty()));
    let has_widened = filter.has_widened();
    let told = Told { belief: &belief, prior, correction, sensors: filter.sensors(), noise, has_widened };
    told.push(sink);
}

/// A belief and the result of its last measurement update. Its type does not depend on the filter, so that the code
/// that writes it to the sink is compiled once per size.
#[derive(Clone, Copy)]
struct Told<'a, const N: usize> {
    belief: &'a Gaussian<N>,
    /// The belief before the update, if the sink wants it.
    prior: Option<&'a Gaussian<N>>,
    correction: &'a Correction<N>,
    /// The number of sensors.
    sensors: usize,
    /// The noise, if it is learnt, and the variance of each R.
    noise: Option<(&'a Noise<N>, &'a [f64])>,
    has_widened: bool,
}

impl<const N: usize> Told<'_, N> {
    /// Writes it to the sink. For a history and the usual numbers of sensors, the compiler knows the lengths, so that a
    /// copy needs no call. The page leaves these versions out, to be smaller.
    fn push(self, sink: &mut dyn Sink) {
        let Self { belief, prior, correction, sensors: m, noise, has_widened } = self;
        let process;
        let noise = if let Some((Noise { process: matrix, sensors, fading: _ }, uncertainty)) = noise {
            process = matrix.diagonal();
            Some(AssumedNoise { process: process.as_slice(), sensors, uncertainty, process_scale: [f64::NAN; 2] })
        } else {
            None
        };
        if cfg!(not(target_arch = "wasm32"))
            && let (1 | 2, Some(history)) = (m, sink.history())
        {
            if m == 1 {
                append::<N, 1>(belief, correction, (noise, has_widened), history);
            } else {
                append::<N, 2>(belief, correction, (noise, has_widened), history);
            }
            return;
        }
        let mut cov = [f64::NAN; MAX_SENSORS * MAX_SENSORS];
        for i in 0..m {
            cov[i * m..(i + 1) * m].copy_from_slice(&correction.innovation_cov[i][..m]);
        }
        let mut sample = sample(belief, correction, m, &cov[..m * m], (noise, has_widened));
        if let Some(prior) = prior {
            (sample.prior_mean, sample.prior_cov) = (&prior.mean.data.0[0], prior.cov.data.0.as_flattened());
        }
        sink.push(&sample);
    }
}

/// The noise of an adaptive filter, and whether the filter has widened P.
type Assumed<'a> = (Option<AssumedNoise<'a>>, bool);

#[inline]
fn append<const N: usize, const M: usize>(
    belief: &Gaussian<N>,
    correction: &Correction<N>,
    assumed: Assumed<'_>,
    history: &mut Estimates,
) {
    let cov: [[f64; M]; M] = std::array::from_fn(|i| std::array::from_fn(|j| correction.innovation_cov[i][j]));
    history.append(&sample(belief, correction, M, cov.as_flattened(), assumed));
}

#[inline(always)]
fn sample<'a, const N: usize>(
    belief: &'a Gaussian<N>,
    correction: &'a Correction<N>,
    m: usize,
    innovation_cov: &'a [f64],
    (noise, has_widened): Assumed<'a>,
) -> Sample<'a> {
    Sample {
        mean: &belief.mean.data.0[0],
        cov: belief.cov.data.0.as_flattened(),
        prior_mean: &[],
        prior_cov: &[],
        innovation: &correction.innovation[..m],
        innovation_cov,
        gain: correction.gain[..m].as_flattened(),
        earlier: 0,
        nis: correction.nis,
        determinant: correction.determinant,
        log_likelihood: f64::NAN,
        effective_samples: f64::NAN,
        weights: &[],
        noise,
        has_widened,
    }
}

/// Builds the filter of some settings, if a kernel serves it.
pub(crate) fn estimator(settings: &FilterSettings, context: FilterContext<'_>) -> Option<Box<dyn Estimator>> {
    with_model(settings, &context, Build { settings, context }).flatten()
}

struct Build<'a> {
    settings: &'a FilterSettings,
    context: FilterContext<'a>,
}

impl Visitor for Build<'_> {
    type Output = Option<Box<dyn Estimator>>;

    fn visit<P: Model<N>, const N: usize>(self, model: P) -> Option<Box<dyn Estimator>> {
        let settings = self.settings;
        let belief = initial_belief::<P, N>(settings);
        let linearised = |iterations| Linearised::new(belief.clone(), iterations);
        match settings.kind {
            kind if kind == FilterKind::KF || kind == FilterKind::EKF => Some(self.filter(model, linearised(1))),
            kind if kind == FilterKind::IEKF => Some(self.filter(model, linearised(settings.iterations))),
            _ if const { !P::MOVES_POINTS } => None,
            kind if kind == FilterKind::UKF => Some(self.filter(model, SigmaPoints::new(belief, Rule::Unscented))),
            kind if kind == FilterKind::CKF => Some(self.filter(model, SigmaPoints::new(belief, Rule::Cubature))),
            _ => None,
        }
    }
}

impl Build<'_> {
    fn filter<P: Model<N>, B: Belief<P, N> + 'static, const N: usize>(
        &self,
        model: P,
        belief: B,
    ) -> Box<dyn Estimator> {
        let filter = build_filter(model, belief, self.settings, &self.context);
        let filter = if self.settings.jump { filter.with_jump() } else { filter };
        Box::new(Followed { filter, correction: Correction::NOTHING })
    }
}

/// The filter of some settings, with its types.
pub(crate) fn build_filter<P: Model<N>, B: Belief<P, N>, const N: usize>(
    model: P,
    belief: B,
    settings: &FilterSettings,
    context: &FilterContext<'_>,
) -> Filter<P, B, N> {
    let noise = noise::<P, N>(settings);
    Filter::new(model, belief, context.dt, noise, readings(settings, context), settings.adaptation)
}

/// The reading of each sensor in the filter's model, if the model has it.
pub(super) fn readings(settings: &FilterSettings, context: &FilterContext<'_>) -> Vec<Option<Output>> {
    let model = context.model(settings);
    context.sensors.iter().map(|&quantity| model.reading(quantity).as_ref().and_then(Output::of)).collect()
}

/// Calls a visitor with the model of a filter with these settings, if a kernel serves it. The plant must be a common
/// one without augmentations, the input held, and each sensor must read one component or its rate.
pub(crate) fn with_model<V: Visitor>(
    settings: &FilterSettings,
    context: &FilterContext<'_>,
    visitor: V,
) -> Option<V::Output> {
    let model = context.model(settings);
    serves(settings, context).then(|| visit(model.plant(), model.eta(), visitor)).flatten()
}

/// Whether a kernel serves these settings, if one has the plant. Steps of Euler, and several steps a sample, are the engine's.
pub(crate) fn serves(settings: &FilterSettings, context: &FilterContext<'_>) -> bool {
    let model = context.model(settings);
    let reads = |quantity: &Quantity| model.reading(*quantity).is_none_or(|reading| Output::of(&reading).is_some());
    let is_moved =
        !settings.kind.info().has_propagation || context.propagation(settings) == Propagation::LocalLinearisation;
    is_moved
        && context.steps(settings) == 1
        && settings.augment.is_empty()
        && settings.consider.is_empty()
        && settings.adaptation.training == 0.0
        && !settings.log_parameters
        && !settings.robust.is_on()
        && context.hold == Hold::Zero
        && context.sensors.len() <= MAX_SENSORS
        && context.sensors.iter().all(reads)
}

/// The initial belief.
pub(crate) fn initial_belief<P: Model<N>, const N: usize>(settings: &FilterSettings) -> Gaussian<N> {
    let mean = Vector::from(P::CHANNELS.map(|c| settings.initial_mean[c]));
    Gaussian::independent(mean, &spread::<P, N>(settings, &settings.initial_std))
}

/// Q, R and fading factor.
pub(crate) fn noise<P: Model<N>, const N: usize>(settings: &FilterSettings) -> Noise<N> {
    let process = spread::<P, N>(settings, &settings.process_std);
    Noise {
        process: Matrix::from_diagonal(&process.component_mul(&process)),
        sensors: settings.sensor_std.iter().map(|s| s * s).collect(),
        fading: settings.fading,
    }
}

/// Standard deviations of a model's components; zero for those that the filter knows.
fn spread<P: Model<N>, const N: usize>(settings: &FilterSettings, std: &Values) -> Vector<N> {
    Vector::from(P::CHANNELS.map(|c| if settings.knows(c) { 0.0 } else { std[c] }))
}
