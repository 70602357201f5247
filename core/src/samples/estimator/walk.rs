//! Two filters that mix: one whose parameters are still, and one whose parameters walk.

use crate::mathematics::filter::{Correction, Filter, FilterError, Gaussian};
use crate::mathematics::linalg::{Vector, fit, fit_vector};
use crate::samples::estimator::book::{InUnits, Told, build_filter, initial_belief, push};
use crate::samples::estimator::{Estimator, Failed, FilterContext};
use crate::samples::sink::{Sample, Sink};
use crate::{Channel, FilterSettings};

/// An interacting multiple model filter (IMM) of two models of one plant. In the first, noise of the parameters is that of the
/// settings; in the second each of them walks, too: by w times its initial standard deviation in a second.
///
/// ```text
/// cⱼ = Σᵢ pᵢⱼ μᵢ          each filter begins from the mixture of both, with the weights pᵢⱼ μᵢ / cⱼ
/// Λⱼ = N(eⱼ; 0, Sⱼ)       of its prediction and update
/// μⱼ = cⱼ Λⱼ / Σ cᵢ Λᵢ
/// ```
///
/// The belief that is reported is the mixture's mean and covariance, with the weights μⱼ; innovation and S are those of the
/// mixture of both predictions, with cⱼ; the gain is the mean of both, with μⱼ.
///
/// Source: Blom and Bar-Shalom (1988), The interacting multiple model algorithm for systems with Markovian switching coefficients;
/// Bar-Shalom, Li and Kirubarajan (2001), *Estimation with Applications to Tracking and Navigation*, section 11.6.6.
struct Walk {
    members: [Member; 2],
    /// μ of both.
    probability: [f64; 2],
    /// Whether it has been told that the parameters walk.
    is_walking: bool,
    /// p, from a row to a column.
    transition: [[f64; 2]; 2],
    belief: Gaussian,
    prior: Gaussian,
    correction: Correction,
    in_units: InUnits,
}

/// The filter of one model.
struct Member {
    filter: Filter,
    correction: Correction,
    /// The mixture that it begins from.
    mixed: Gaussian,
}

/// The mean time that parameters are still, and that they walk \[s\].
const STILL: f64 = 30.0;
const WALKS: f64 = 1.0;

/// Limits the probability of a change between two samples.
const MOST: f64 = 0.5;

/// Parameters that walked are still again below this probability.
const CALM: f64 = 0.1;

/// A model that is less probable than this is given up for lost, but for what the other one turns into it.
const LEAST: f64 = 1e-12;

/// The bank of a filter whose settings have a walk.
pub(crate) fn estimator(settings: &FilterSettings, context: &FilterContext<'_>) -> Box<dyn Estimator> {
    let still = FilterSettings { walk: 0.0, ..settings.clone() };
    match (member(&still, context), member(&walking(settings, context), context)) {
        (Ok(still), Ok(walking)) => Box::new(Walk::new([still, walking], context)),
        (Err(FilterError::NotFinite), _) | (_, Err(FilterError::NotFinite)) => Box::new(Failed(FilterError::TooLarge)),
        (Err(error), _) | (_, Err(error)) => Box::new(Failed(error)),
    }
}

fn member(settings: &FilterSettings, context: &FilterContext<'_>) -> Result<Member, FilterError> {
    let filter = build_filter(initial_belief(settings, context)?, settings, context);
    let mixed = filter.belief().gaussian().into_owned();
    Ok(Member { correction: Correction::nothing(filter.model().size(), context.sensors.len()), filter, mixed })
}

/// The settings of the filter whose parameters walk.
fn walking(settings: &FilterSettings, context: &FilterContext<'_>) -> FilterSettings {
    let mut walking = FilterSettings { walk: 0.0, ..settings.clone() };
    let model = context.model(settings);
    let is_parameter = |channel: &&Channel| channel.is_parameter() && !settings.knows(**channel);
    for &channel in model.channels().iter().filter(is_parameter) {
        let step = settings.walk * settings.initial_std[channel] * libm::sqrt(context.dt);
        let own = settings.process_std[channel];
        walking.process_std[channel] = libm::sqrt(own * own + step * step);
    }
    walking
}

impl Walk {
    fn new(members: [Member; 2], context: &FilterContext<'_>) -> Self {
        let [begins, ends] = [STILL, WALKS].map(|time| (context.dt / time).min(MOST));
        let belief = members[0].mixed.clone();
        Self {
            prior: belief.clone(),
            correction: Correction::nothing(belief.size(), context.sensors.len()),
            belief,
            members,
            probability: [1.0, 0.0],
            is_walking: false,
            transition: [[1.0 - begins, begins], [ends, 1.0 - ends]],
            in_units: InUnits::default(),
        }
    }

    /// Lets each filter begin from its mixture. Returns c, the probabilities before the measurement.
    fn mix(&mut self) -> Result<[f64; 2], FilterError> {
        let Self { members, probability, transition, .. } = self;
        let before = [0, 1].map(|j| transition[0][j] * probability[0] + transition[1][j] * probability[1]);
        let weights = |j: usize| [0, 1].map(|i| transition[i][j] * probability[i] / before[j]);
        let [still, walking] = members;
        {
            let [a, b] = [&still.filter, &walking.filter].map(|filter| filter.belief().gaussian());
            mixture(weights(0), [&a, &b], &mut still.mixed);
            mixture(weights(1), [&a, &b], &mut walking.mixed);
        }
        for Member { filter, mixed, .. } in [still, walking] {
            filter.belief_mut().replace(mixed)?;
        }
        Ok(before)
    }

    /// Takes in the likelihood of each filter's measurements. Without any, nothing is learnt.
    fn weigh(&mut self, before: [f64; 2]) -> Result<(), FilterError> {
        let ln: [f64; 2] = self.members.each_ref().map(|member| ln_likelihood(&member.correction));
        if ln.iter().all(|ln| ln.is_nan()) {
            self.probability = before;
            return Ok(());
        }
        let best = ln[0].max(ln[1]);
        let weights = [0, 1].map(|j| before[j] * libm::exp(ln[j] - best));
        let sum = weights[0] + weights[1];
        if !(sum.is_finite() && sum > 0.0) {
            return Err(FilterError::ImpossibleMeasurement);
        }
        let walks = (weights[1] / sum).clamp(LEAST, 1.0 - LEAST);
        self.probability = [1.0 - walks, walks];
        Ok(())
    }

    /// The innovation and the gain of both together.
    fn combine(&mut self, before: [f64; 2]) {
        let Self { members, probability, correction, .. } = self;
        let [a, b] = members.each_ref().map(|member| &member.correction);
        let m = a.innovation.len();
        fit_vector(&mut correction.innovation, m);
        fit(&mut correction.innovation_cov, m, m);
        let mixed = |pair: [f64; 2]| before[0] * pair[0] + before[1] * pair[1];
        for i in 0..m {
            correction.innovation[i] = mixed([a.innovation[i], b.innovation[i]]);
        }
        let apart = |part: &Correction, e: &Vector, i: usize, j: usize| {
            part.innovation_cov[(i, j)] + (part.innovation[i] - e[i]) * (part.innovation[j] - e[j])
        };
        let kept: Vec<usize> = (0..m).filter(|&i| !correction.innovation[i].is_nan()).collect();
        correction.innovation_cov.copy_from(&a.innovation_cov);
        for &i in &kept {
            for &j in &kept {
                let e = &correction.innovation;
                correction.innovation_cov[(i, j)] = mixed([apart(a, e, i, j), apart(b, e, i, j)]);
            }
        }
        correction.gain.copy_from(&(&a.gain * probability[0] + &b.gain * probability[1]));
        correction.take_squares(&kept);
    }

    fn report(&mut self, has_prior: bool, has_widened: bool, sink: &mut dyn Sink) -> Result<(), FilterError> {
        let Self { members, belief, prior, correction, in_units, .. } = self;
        let told =
            Told { model: members[0].filter.model(), belief, correction, noise: None, weights: &[], has_widened };
        push(&told, has_prior.then_some(prior), in_units, sink)
    }
}

impl Estimator for Walk {
    fn begin(&self, sink: &mut dyn Sink) -> Result<(), FilterError> {
        let [Member { filter, .. }, walking] = &self.members;
        let is_finite = [filter, &walking.filter].iter().all(|filter| filter.noise().is_finite());
        let mut prior = sink.wants_prior().then(|| self.belief.clone());
        let told = Told {
            model: filter.model(),
            belief: &self.belief,
            correction: &self.correction,
            noise: None,
            weights: &[],
            has_widened: false,
        };
        if !is_finite
            || !self.belief.is_finite()
            || push(&told, prior.as_mut(), &mut self.in_units.clone(), sink).is_err()
        {
            return Err(FilterError::TooLarge);
        }
        Ok(())
    }

    fn step(
        &mut self,
        force_before: f64,
        force: f64,
        measured: &[f64],
        sink: &mut dyn Sink,
    ) -> Result<(), FilterError> {
        let wants_prior = sink.wants_prior();
        let before = self.mix()?;
        for Member { filter, .. } in &mut self.members {
            filter.predict([force_before, force])?;
        }
        if wants_prior {
            mixture_of(&self.members, before, &mut self.prior);
        }
        for Member { filter, correction, .. } in &mut self.members {
            filter.update(force, measured, correction)?;
        }
        self.weigh(before)?;
        self.combine(before);
        mixture_of(&self.members, self.probability, &mut self.belief);
        self.belief.check()?;
        let walked = self.is_walking;
        self.is_walking = self.probability[1] > if walked { CALM } else { 0.5 };
        self.report(wants_prior, self.is_walking && !walked, sink)
    }
}

/// The log likelihood of the measurements of an update; NaN where there was none.
fn ln_likelihood(correction: &Correction) -> f64 {
    let Correction { innovation, innovation_cov, nis, determinant, .. } = correction;
    let sample = Sample {
        innovation: innovation.as_slice(),
        innovation_cov: innovation_cov.as_slice(),
        nis: *nis,
        determinant: *determinant,
        ..Sample::unmeasured(&[], &[])
    };
    sample.ln_likelihood()
}

/// The mixture of both filters' beliefs with some weights.
fn mixture_of(members: &[Member; 2], weights: [f64; 2], into: &mut Gaussian) {
    let [a, b] = members.each_ref().map(|member| member.filter.belief().gaussian());
    mixture(weights, [&a, &b], into);
}

/// Mean and covariance of a mixture.
fn mixture(weights: [f64; 2], parts: [&Gaussian; 2], into: &mut Gaussian) {
    let [a, b] = parts;
    let n = a.size();
    fit_vector(&mut into.mean, n);
    fit(&mut into.cov, n, n);
    // A number that both parts share keeps its bits.
    let mixed = |one: f64, other: f64| one + weights[1] * (other - one);
    for i in 0..n {
        into.mean[i] = mixed(a.mean[i], b.mean[i]);
    }
    // With two parts both spreads are one product.
    let apart = weights[0] * weights[1];
    for j in 0..n {
        for i in j..n {
            let spread = (a.mean[i] - b.mean[i]) * (a.mean[j] - b.mean[j]);
            into.cov[(i, j)] = mixed(a.cov[(i, j)], b.cov[(i, j)]) + apart * spread;
        }
    }
    into.cov.fill_upper_triangle_with_lower_triangle();
}
