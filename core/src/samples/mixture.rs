//! Filters side by side, of which a rule tells what they say together.
//!
//! ```text
//! y = Σ wⱼ yⱼ,    P = Σ wⱼ (Pⱼ + (yⱼ - y) (yⱼ - y)ᵀ)
//! e = Σ w⁻ⱼ eⱼ,  S = Σ w⁻ⱼ (Sⱼ + (eⱼ - e) (eⱼ - e)ᵀ)      w⁻: the weights before the measurement
//! ```
//!
//! Source: Bar-Shalom, Li and Kirubarajan (2001), *Estimation with Applications to Tracking and Navigation*, section 11.6.

pub(crate) mod guesses;
pub(crate) mod scales;
pub(crate) mod walk;

use crate::data::record::Parts;
use crate::samples::estimator::Estimator;
use crate::samples::estimator::engine::Update;
use crate::samples::sink::{LastSample, Sample, Sink};
use crate::{FilterError, FilterSettings};

/// How filters are weighed, and what is told of them.
pub(crate) trait Rule: Send {
    /// Lets the filters begin a step from each other's beliefs.
    ///
    /// # Errors
    /// Those of a belief without a root.
    fn begin(&mut self, _: &mut [Member]) -> Result<(), FilterError> {
        Ok(())
    }

    /// The weight of each filter, before and after [`Self::take`].
    fn weights(&self) -> &[f64];

    /// Takes in the likelihoods of the measurements, and may drop filters.
    ///
    /// # Errors
    /// That of a filter without which the others cannot go on.
    fn take(&mut self, members: &mut Vec<Member>) -> Result<(), FilterError>;

    /// The filter that is told alone, if one is.
    fn leader(&self) -> Option<usize> {
        None
    }

    /// Hands the sample of all together to a sink, with what the rule knows besides.
    fn push(&self, _: &[Member], sample: Sample<'_>, sink: &mut dyn Sink) {
        sink.push(&sample);
    }
}

/// One of the filters.
pub(crate) struct Member {
    estimator: Box<dyn Estimator>,
    last: LastSample,
    failure: Option<FilterError>,
}

impl Member {
    /// The log likelihood of the last sample; NaN without a measurement, -∞ where the filter has failed.
    fn ln_likelihood(&self) -> f64 {
        if self.failure.is_some() { f64::NEG_INFINITY } else { self.last.sample().ln_likelihood() }
    }
}

/// Filters of one state, and their rule.
pub(crate) struct Mixture {
    members: Vec<Member>,
    rule: Box<dyn Rule>,
    /// The weights before the measurement.
    before: Vec<f64>,
    belief: Moments,
    prior: Moments,
    update: Update,
}

/// Mean and covariance, n and n × n numbers.
#[derive(Default)]
struct Moments {
    mean: Vec<f64>,
    cov: Vec<f64>,
}

/// A step of one filter, reporting to a sink.
type Step<'a> = dyn Fn(&mut dyn Estimator, &mut dyn Sink) -> Result<(), FilterError> + 'a;

/// A filter with a smaller share adds nothing.
const LEAST: f64 = 1e-12;

impl Mixture {
    /// The filters of these settings, each of which `build` makes.
    pub(crate) fn new(
        members: &[FilterSettings],
        rule: impl Rule + 'static,
        build: impl Fn(&FilterSettings) -> Box<dyn Estimator>,
    ) -> Self {
        let member = |settings| Member { estimator: build(settings), last: LastSample::default(), failure: None };
        let (belief, prior) = (Moments::default(), Moments::default());
        let members = members.iter().map(member).collect();
        Self { members, rule: Box::new(rule), before: Vec::new(), belief, prior, update: Update::nothing(0, 0) }
    }

    /// Lets all filters take a step, and reports what they say together.
    fn step_all(&mut self, sink: &mut dyn Sink, step: &Step<'_>) -> Result<(), FilterError> {
        let Self { members, rule, before, .. } = self;
        let wants_prior = sink.wants_prior();
        rule.begin(members)?;
        let mut reason = FilterError::NotFinite;
        for Member { estimator, last, failure } in members.iter_mut().filter(|member| member.failure.is_none()) {
            last.want_prior(wants_prior);
            if let Err(error) = step(&mut **estimator, last) {
                (*failure, reason) = (Some(error), error);
            }
        }
        if members.iter().all(|member| member.failure.is_some()) {
            return Err(reason);
        }
        before.clear();
        before.extend_from_slice(rule.weights());
        rule.take(members)?;
        if let Some(leader) = rule.leader() {
            rule.push(members, members[leader].last.sample(), sink);
            return Ok(());
        }
        self.mix(wants_prior)?;
        let Self { members, rule, belief, prior, update, .. } = self;
        let sample = update.sample(&belief.mean, &belief.cov);
        let prior = if wants_prior { [&prior.mean[..], &prior.cov] } else { [&[][..], &[]] };
        rule.push(members, Sample { prior_mean: prior[0], prior_cov: prior[1], ..sample }, sink);
        Ok(())
    }

    /// Mixes the results of the filters, with their weights before and after the measurement.
    fn mix(&mut self, wants_prior: bool) -> Result<(), FilterError> {
        let Self { members, rule, before, belief, prior, update } = self;
        let of = |weights: &'_ [f64]| -> Vec<(f64, Sample<'_>)> {
            let own = members.iter().zip(weights);
            let counts = own.filter(|(member, weight)| member.failure.is_none() && **weight > LEAST);
            counts.map(|(member, weight)| (*weight, member.last.sample())).collect()
        };
        let (before, after) = (of(before), of(rule.weights()));
        if before.is_empty() || after.is_empty() {
            return Err(FilterError::ImpossibleMeasurement);
        }
        belief.mix(&after, |sample| [sample.mean, sample.cov]);
        if wants_prior {
            prior.mix(&before, |sample| [sample.prior_mean, sample.prior_cov]);
        }
        mean(&after, &|sample| sample.gain, &mut update.gain);
        let mut expected = Moments::default();
        expected.mix(&before, |sample| [sample.innovation, sample.innovation_cov]);
        (update.innovation, update.innovation_cov) = (expected.mean, expected.cov);
        update.take_squares();
        // Of several readings of a sensor in one step, NIS and det S are those of the likeliest filter.
        if let Some((_, likeliest)) = after.iter().max_by(|a, b| a.0.total_cmp(&b.0)) {
            update.earlier = likeliest.earlier;
            if likeliest.earlier > 0 {
                (update.nis, update.determinant) = (likeliest.nis, likeliest.determinant);
            }
        }
        let is_finite = belief.mean.iter().chain(&belief.cov).all(|number| number.is_finite());
        if is_finite { Ok(()) } else { Err(FilterError::NotFinite) }
    }
}

impl Estimator for Mixture {
    fn begin(&self, sink: &mut dyn Sink) -> Result<(), FilterError> {
        let mut first = LastSample::default();
        first.want_prior(sink.wants_prior());
        self.members[0].estimator.begin(&mut first)?;
        self.rule.push(&self.members, first.sample(), sink);
        Ok(())
    }

    fn step(
        &mut self,
        force_before: f64,
        force: f64,
        measured: &[f64],
        sink: &mut dyn Sink,
    ) -> Result<(), FilterError> {
        self.step_all(sink, &|member, sink| member.step(force_before, force, measured, sink))
    }

    fn step_through(&mut self, parts: &Parts, sink: &mut dyn Sink) -> Result<(), FilterError> {
        self.step_all(sink, &|member, sink| member.step_through(parts, sink))
    }
}

impl Moments {
    /// Mean and covariance of a mixture.
    fn mix<'a>(&mut self, parts: &[(f64, Sample<'a>)], of: fn(&Sample<'a>) -> [&'a [f64]; 2]) {
        mean(parts, &|sample| of(sample)[0], &mut self.mean);
        mean(parts, &|sample| of(sample)[1], &mut self.cov);
        let n = self.mean.len();
        let total: f64 = parts.iter().map(|(weight, _)| weight).sum();
        for (weight, sample) in parts {
            let own = of(sample)[0];
            for j in 0..n {
                for i in 0..n {
                    // Symmetric to the last bit.
                    self.cov[j * n + i] += weight / total * ((own[i] - self.mean[i]) * (own[j] - self.mean[j]));
                }
            }
        }
    }
}

/// The weighted mean of some numbers; what all have in common keeps its bits.
fn mean<'a>(parts: &[(f64, Sample<'a>)], of: &dyn Fn(&Sample<'a>) -> &'a [f64], into: &mut Vec<f64>) {
    let first = of(&parts[0].1);
    let total: f64 = parts.iter().map(|(weight, _)| weight).sum();
    into.clear();
    into.extend_from_slice(first);
    for (weight, sample) in &parts[1..] {
        for ((mean, own), first) in into.iter_mut().zip(of(sample)).zip(first) {
            *mean += weight / total * (own - first);
        }
    }
}
