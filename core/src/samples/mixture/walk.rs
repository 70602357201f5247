//! Two filters that mix: one whose parameters are still, and one whose parameters walk.

use std::f64::consts::TAU;

use super::{LEAST, Member, Rule};
use crate::mathematics::mixed::{Moments, shares};
use crate::samples::estimator::FilterContext;
use crate::samples::sink::{Sample, Sink};
use crate::{Channel, FilterError, FilterSettings};

/// An interacting multiple model filter (IMM) of two models of one plant. In the first, noise of the parameters is that of the
/// settings; in the second each of them walks, too: by w times its initial standard deviation in a second.
///
/// ```text
/// cⱼ = Σᵢ pᵢⱼ μᵢ          each filter begins from the mixture of both, with the weights pᵢⱼ μᵢ / cⱼ
/// Λⱼ = N(eⱼ; 0, Sⱼ)       of its prediction and update
/// μⱼ = cⱼ Λⱼ / Σ cᵢ Λᵢ
/// ```
///
/// The weights before the measurement are cⱼ, those after it μⱼ.
///
/// Source: Blom and Bar-Shalom (1988), The interacting multiple model algorithm for systems with Markovian switching coefficients;
/// Bar-Shalom, Li and Kirubarajan (2001), *Estimation with Applications to Tracking and Navigation*, section 11.6.6.
pub(crate) struct Walk {
    /// μ of both, or c before a measurement.
    weights: [f64; 2],
    /// p, from a row to a column.
    transition: [[f64; 2]; 2],
    is_walking: bool,
    has_begun: bool,
    has_samples: bool,
}

/// The mean time that parameters are still, and that they walk, in periods of the plant by the initial mean.
const STILL: f64 = 30.0;
const WALKS: f64 = 1.0;

/// Limits the probability of a change between two samples.
const MOST: f64 = 0.5;

/// Parameters that walked are still again below this probability.
const CALM: f64 = 0.1;

pub(crate) fn members(settings: &FilterSettings, context: &FilterContext) -> [FilterSettings; 2] {
    let still = FilterSettings { walk: 0.0, ..settings.clone() };
    let mut walking = still.clone();
    let model = context.model(settings);
    let is_parameter = |channel: &&Channel| channel.is_parameter() && !settings.knows(**channel);
    for &channel in model.channels().iter().filter(is_parameter) {
        let step = settings.walk * settings.initial_std[channel] * libm::sqrt(context.dt);
        let own = settings.process_std[channel];
        walking.process_std[channel] = libm::sqrt(own * own + step * step);
    }
    [still, walking]
}

impl Walk {
    /// Of a plant that turns by so much from a sample to the next \[rad\].
    pub(crate) fn new(turn: f64) -> Self {
        let [begins, ends] = [STILL, WALKS].map(|periods| (turn / (TAU * periods)).min(MOST));
        Self {
            weights: [1.0, 0.0],
            transition: [[1.0 - begins, begins], [ends, 1.0 - ends]],
            is_walking: false,
            has_begun: false,
            has_samples: false,
        }
    }
}

impl Rule for Walk {
    fn begin(&mut self, members: &mut [Member]) -> Result<(), FilterError> {
        let Self { weights, transition, has_samples, .. } = self;
        let before = |j: usize| transition[0][j] * weights[0] + transition[1][j] * weights[1];
        let before = [before(0), before(1)];
        if std::mem::replace(has_samples, true) {
            let mixed = [0, 1].map(|j| {
                let mut mixed = Moments::default();
                let of = |i: usize| (transition[i][j] * weights[i] / before[j], members[i].last.sample());
                mixed.mix([of(0), of(1)].iter().map(|(weight, sample)| (*weight, [sample.mean, sample.cov])));
                mixed
            });
            for (Member { estimator, .. }, Moments { mean, cov }) in members.iter_mut().zip(&mixed) {
                estimator.set_belief(mean, cov)?;
            }
        }
        *weights = before;
        Ok(())
    }

    fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// Without any measurement, nothing is learnt.
    fn update(&mut self, members: &mut [Member]) -> Result<(), FilterError> {
        if let Some(reason) = members.iter().find_map(|member| member.failure) {
            return Err(reason);
        }
        let evidence = |j: usize| libm::log(self.weights[j]) + members[j].ln_likelihood();
        let evidence = [evidence(0), evidence(1)];
        if !evidence.iter().all(|ln| ln.is_nan()) {
            let shares = shares(&evidence);
            let [still, walks] = [shares[0], shares[1]];
            if still + walks == 0.0 {
                return Err(FilterError::ImpossibleMeasurement);
            }
            let walks = walks.clamp(LEAST, 1.0 - LEAST);
            self.weights = [1.0 - walks, walks];
        }
        let walked = self.is_walking;
        self.is_walking = self.weights[1] > if walked { CALM } else { 0.5 };
        self.has_begun = self.is_walking && !walked;
        Ok(())
    }

    fn push(&self, _: &[Member], sample: Sample<'_>, sink: &mut dyn Sink) {
        sink.push(&Sample { has_widened: self.has_begun, ..sample });
    }
}
