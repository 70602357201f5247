//! Filters side by side over one state, and a rule that weighs them.
//!
//! ```text
//! y = Σ wⱼ yⱼ,    P = Σ wⱼ (Pⱼ + (yⱼ - y) (yⱼ - y)ᵀ)
//! e = Σ w⁻ⱼ eⱼ,  S = Σ w⁻ⱼ (Sⱼ + (eⱼ - e) (eⱼ - e)ᵀ)      w⁻: the weights before the measurement
//! ```
//!
//! Source: Magill (1965), Optimal adaptive estimation of sampled stochastic processes; Bar-Shalom, Li and Kirubarajan (2001),
//! *Estimation with Applications to Tracking and Navigation*, section 11.6.

pub(crate) mod guesses;
pub(crate) mod scales;
pub(crate) mod walk;

use crate::data::record::Parts;
use crate::mathematics::lists::mapped;
use crate::mathematics::mixed::{Moments, mean};
use crate::samples::estimator::Estimator;
use crate::samples::estimator::update::Update;
use crate::samples::sink::{LastSample, Sample, Sink};
use crate::{FilterError, FilterSettings};

/// The weights of filters. It fails where a filter has failed without which the others cannot continue.
pub(crate) trait Rule: Send {
    /// Lets the filters begin a step from each other's beliefs.
    fn begin(&mut self, _: &mut [Member]) -> Result<(), FilterError> {
        Ok(())
    }

    fn weights(&self) -> &[f64];

    fn update(&mut self, members: &mut [Member]) -> Result<(), FilterError>;

    fn leader(&self) -> Option<usize> {
        None
    }

    /// Hands the sample of all filters to a sink, with what the rule knows besides.
    fn push(&self, _: &[Member], sample: Sample<'_>, sink: &mut dyn Sink) {
        sink.push(&sample);
    }
}

pub(crate) struct Member {
    estimator: Box<dyn Estimator>,
    last: LastSample,
    failure: Option<FilterError>,
}

pub(crate) struct Mixture {
    members: Vec<Member>,
    rule: Box<dyn Rule>,
    belief: Moments,
    prior: Moments,
    update: Update,
}

type Step<'a> = dyn Fn(&mut dyn Estimator, &mut dyn Sink) -> Result<(), FilterError> + 'a;

/// A filter with a smaller weight adds nothing.
const LEAST: f64 = 1e-12;

impl Member {
    /// The log likelihood of the last sample; NaN without a measurement, -∞ where the filter has failed.
    fn ln_likelihood(&self) -> f64 {
        if self.failure.is_some() { f64::NEG_INFINITY } else { self.last.sample().ln_likelihood() }
    }

    fn is_read(&self) -> bool {
        self.failure.is_none() && self.last.sample().readings() > 0
    }
}

fn samples<'a>(members: &'a [Member], weights: &[f64]) -> Vec<(f64, Sample<'a>)> {
    let counts = |(member, weight): &(&Member, &f64)| member.failure.is_none() && **weight > LEAST;
    members.iter().zip(weights).filter(counts).map(|(member, weight)| (*weight, member.last.sample())).collect()
}

impl Mixture {
    pub(crate) fn new(
        members: &[FilterSettings],
        rule: impl Rule + 'static,
        build: impl Fn(&FilterSettings) -> Box<dyn Estimator>,
    ) -> Self {
        let member = |settings| Member { estimator: build(settings), last: LastSample::default(), failure: None };
        let (belief, prior) = (Moments::default(), Moments::default());
        let members = mapped(members, &member);
        Self { members, rule: Box::new(rule), belief, prior, update: Update::nothing(0, 0) }
    }

    fn step_all(&mut self, sink: &mut dyn Sink, step: &Step<'_>) -> Result<(), FilterError> {
        let Self { members, rule, belief, prior, update } = self;
        let (wants_prior, mut reason) = (sink.wants_prior(), FilterError::ImpossibleMeasurement);
        rule.begin(members)?;
        for Member { estimator, last, failure } in members.iter_mut().filter(|member| member.failure.is_none()) {
            last.want_prior(wants_prior);
            *failure = step(&mut **estimator, last).err().inspect(|error| reason = *error);
        }
        let before = rule.weights().to_vec();
        rule.update(members)?;
        if let Some(leader) = rule.leader() {
            rule.push(members, members[leader].last.sample(), sink);
            return Ok(());
        }
        let (before, after) = (samples(members, &before), samples(members, rule.weights()));
        let likeliest = after.iter().max_by(|a, b| a.0.total_cmp(&b.0)).filter(|_| !before.is_empty());
        let Some((_, likeliest)) = likeliest else { return Err(reason) };
        belief.mix(after.iter().map(|(weight, of)| (*weight, [of.mean, of.cov])));
        let mut expected = Moments::default();
        expected.mix(before.iter().map(|(weight, of)| (*weight, [of.innovation, of.innovation_cov])));
        (update.innovation, update.innovation_cov) = (expected.mean, expected.cov);
        mean(after.iter().map(|(weight, of)| (*weight, of.gain)), &mut update.gain);
        update.take_squares();
        // Of several readings of a sensor in one step, NIS and det S are those of the likeliest filter.
        update.earlier = likeliest.earlier;
        if likeliest.earlier > 0 {
            (update.nis, update.determinant) = (likeliest.nis, likeliest.determinant);
        }
        if !belief.mean.iter().chain(&belief.cov).all(|number| number.is_finite()) {
            return Err(FilterError::NotFinite);
        }
        let mut sample = update.sample(&belief.mean, &belief.cov);
        if wants_prior {
            prior.mix(before.iter().map(|(weight, of)| (*weight, [of.prior_mean, of.prior_cov])));
            (sample.prior_mean, sample.prior_cov) = (&prior.mean, &prior.cov);
        }
        rule.push(members, sample, sink);
        Ok(())
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

    fn step(&mut self, before: f64, force: f64, measured: &[f64], sink: &mut dyn Sink) -> Result<(), FilterError> {
        self.step_all(sink, &|member, sink| member.step(before, force, measured, sink))
    }

    fn step_through(&mut self, parts: &Parts, sink: &mut dyn Sink) -> Result<(), FilterError> {
        self.step_all(sink, &|member, sink| member.step_through(parts, sink))
    }
}
