//! Filters side by side over one state, and a rule that weighs them.
//!
//! ```text
//! y = Σ wⱼ yⱼ,    P = Σ wⱼ (Pⱼ + (yⱼ - y) (yⱼ - y)ᵀ)
//! e = Σ w⁻ⱼ eⱼ,  S = Σ w⁻ⱼ (Sⱼ + (eⱼ - e) (eⱼ - e)ᵀ)      w⁻: the weights before the measurement
//! ```
//!
//! Source: Magill (1965), Optimal adaptive estimation of sampled stochastic processes; Bar-Shalom, Li and Kirubarajan (2001),
//! *Estimation with Applications to Tracking and Navigation*, section 11.6.

use std::f64::consts::TAU;

use kalmanscope_filters::gaussian_likelihood::{Moments, mean, shares};
use kalmanscope_filters::lists::{mapped, numbers, sort_items};
use kalmanscope_filters::noise_scale::NoiseScale;
use kalmanscope_filters::{Adaptation, Channel, FilterError};
use kalmanscope_records::record::Parts;

use crate::FilterSettings;
use crate::run::estimator::setup::Beginning;
use crate::run::estimator::update::SensorUpdate;
use crate::run::estimator::{Estimator, FilterContext};
use crate::run::forces::Forces;
use crate::run::sink::{AssumedNoise, LastSample, Sample, Sink};

/// The weights of filters. It fails where a filter has failed without which the others cannot continue.
pub(crate) trait WeightRule: Send {
    fn begin(&mut self, _: &mut [MixtureMember]) -> Result<(), FilterError> {
        Ok(())
    }

    fn weights(&self) -> &[f64];

    fn update(&mut self, members: &mut [MixtureMember]) -> Result<(), FilterError>;

    fn leader(&self) -> Option<usize> {
        None
    }

    fn push(&self, _: &[MixtureMember], sample: Sample<'_>, sink: &mut dyn Sink) {
        sink.push(&sample);
    }
}

pub(crate) struct MixtureMember {
    estimator: Box<dyn Estimator>,
    last: LastSample,
    failure: Option<FilterError>,
}

pub(crate) struct Mixture {
    members: Vec<MixtureMember>,
    rule: Box<dyn WeightRule>,
    belief: Moments,
    prior: Moments,
    update: SensorUpdate,
}

type Step<'a> = dyn Fn(&mut dyn Estimator, &mut dyn Sink) -> Result<(), FilterError> + 'a;

/// A filter with a smaller weight adds nothing.
const LEAST: f64 = 1e-12;

impl MixtureMember {
    /// NaN without a measurement, -∞ where the filter has failed.
    fn ln_likelihood(&self) -> f64 {
        if self.failure.is_some() { f64::NEG_INFINITY } else { self.last.sample().ln_likelihood() }
    }

    fn is_read(&self) -> bool {
        self.failure.is_none() && self.last.sample().readings() > 0
    }
}

fn samples<'a>(members: &'a [MixtureMember], weights: &[f64]) -> Vec<(f64, Sample<'a>)> {
    let counts = |(member, weight): &(&MixtureMember, &f64)| member.failure.is_none() && **weight > LEAST;
    members.iter().zip(weights).filter(counts).map(|(member, weight)| (*weight, member.last.sample())).collect()
}

impl Mixture {
    pub(crate) fn new(
        members: &[FilterSettings],
        rule: impl WeightRule + 'static,
        build: impl Fn(&FilterSettings) -> Box<dyn Estimator>,
    ) -> Self {
        let member =
            |settings| MixtureMember { estimator: build(settings), last: LastSample::default(), failure: None };
        let (belief, prior) = (Moments::default(), Moments::default());
        let members = mapped(members, &member);
        Self { members, rule: Box::new(rule), belief, prior, update: SensorUpdate::nothing(0, 0) }
    }

    fn step_all(&mut self, sink: &mut dyn Sink, step: &Step<'_>) -> Result<(), FilterError> {
        let Self { members, rule, belief, prior, update } = self;
        let (wants_prior, mut reason) = (sink.wants_prior(), FilterError::ImpossibleMeasurement);
        rule.begin(members)?;
        for MixtureMember { estimator, last, failure } in members.iter_mut().filter(|member| member.failure.is_none()) {
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
        update.earlier = likeliest.earlier;
        if !belief.mean.iter().chain(&belief.cov).all(|number| number.is_finite()) {
            return Err(FilterError::NotFinite);
        }
        let mut sample = update.sample(&belief.mean, &belief.cov);
        // Of several readings of a sensor in one step, NIS and det S are those of the likeliest filter.
        if likeliest.earlier > 0 {
            let Sample { nis, determinant, ln_determinant, .. } = *likeliest;
            sample = Sample { nis, determinant, ln_determinant, ..sample };
        }
        if wants_prior {
            prior.mix(before.iter().map(|(weight, of)| (*weight, [of.prior_mean, of.prior_cov])));
            (sample.prior_mean, sample.prior_cov) = (&prior.mean, &prior.cov);
        }
        rule.push(members, sample, sink);
        Ok(())
    }
}

impl Estimator for Mixture {
    fn begin(&mut self, sink: &mut dyn Sink) -> Result<(), FilterError> {
        let mut first = LastSample::default();
        first.want_prior(sink.wants_prior());
        self.members[0].estimator.begin(&mut first)?;
        self.rule.push(&self.members, first.sample(), sink);
        Ok(())
    }

    fn step(&mut self, force: [f64; 2], forces: &Forces, z: &[f64], sink: &mut dyn Sink) -> Result<(), FilterError> {
        self.step_all(sink, &|member, sink| member.step(force, forces, z, sink))
    }

    fn step_through(&mut self, parts: &Parts, forces: &Forces, sink: &mut dyn Sink) -> Result<(), FilterError> {
        self.step_all(sink, &|member, sink| member.step_through(parts, forces, sink))
    }
}

/// Several filters from guesses of the natural frequency that are far apart; the likeliest so far reports alone.
pub(crate) struct Guesses {
    /// The log likelihood of each filter, and its distance to the likeliest at the last check.
    each: Vec<[f64; 2]>,
    leader: usize,
    measured: usize,
}

/// The outermost guesses are e^±2 times the initial mean: four found 6 rad/s from 1 to 36, one failed in up to 17 %.
const FARTHEST: f64 = 2.0;

/// The measured samples between two checks: so long a filter that is far behind has to catch up.
const CHECKED: usize = 500;

/// A guess that is e^30 times less likely than the best, and falls further behind, only takes time.
const FAR_BEHIND: f64 = 30.0;

impl Guesses {
    /// One filter for each guess, evenly spread in ln ωₙ; the nearest to the initial mean comes first.
    pub(crate) fn members(settings: &FilterSettings) -> Vec<FilterSettings> {
        let count = settings.guesses;
        let place = |i: usize| 2.0 * FARTHEST * i as f64 / (count - 1) as f64 - FARTHEST;
        let mut logarithms: Vec<f64> = numbers(count, &place);
        sort_items(&mut logarithms, |a, b| a.abs().total_cmp(&b.abs()));
        let of = |logarithm: f64| {
            let mut member = FilterSettings { guesses: 1, ..settings.clone() };
            let [mean, std] =
                [&mut member.initial_mean, &mut member.initial_std].map(|of| &mut of[Channel::NATURAL_FREQUENCY]);
            *mean *= libm::exp(logarithm);
            // About half way to the next guess, so that no frequency between two is far from both.
            *std = std.max(FARTHEST / count as f64 * *mean);
            member
        };
        logarithms.into_iter().map(of).collect()
    }

    pub(crate) fn new(count: usize) -> Self {
        Self { each: vec![[0.0, f64::INFINITY]; count], leader: 0, measured: 0 }
    }
}

impl WeightRule for Guesses {
    fn weights(&self) -> &[f64] {
        &[]
    }

    fn leader(&self) -> Option<usize> {
        Some(self.leader)
    }

    fn update(&mut self, members: &mut [MixtureMember]) -> Result<(), FilterError> {
        let Self { each, leader, measured } = self;
        for (member, [sum, _]) in members.iter_mut().zip(&mut *each) {
            let gained = member.ln_likelihood();
            *sum += if gained.is_nan() { 0.0 } else { gained };
            if !sum.is_finite() {
                (*sum, _) = (f64::NEG_INFINITY, member.failure.get_or_insert(FilterError::NotFinite));
            }
        }
        if let (Some(reason), true) = (members[*leader].failure, members.iter().all(|member| member.failure.is_some()))
        {
            return Err(reason);
        }
        // Of equally likely guesses the first counts, which is the nearest: `max_by` takes the last one, so the order is turned.
        *leader = (0..each.len()).rev().max_by(|a, b| each[*a][0].total_cmp(&each[*b][0])).unwrap_or(0);
        let is_measured = members.iter().any(MixtureMember::is_read);
        *measured += usize::from(is_measured);
        if is_measured && measured.is_multiple_of(CHECKED) {
            let best = each[*leader][0];
            for (member, [sum, before]) in members.iter_mut().zip(each) {
                let behind = best - *sum;
                // A guess that catches up stays: it may only have begun far off.
                if behind >= FAR_BEHIND && behind >= *before {
                    (*sum, _) = (f64::NEG_INFINITY, member.failure.get_or_insert(FilterError::ImpossibleMeasurement));
                }
                *before = behind;
            }
        }
        Ok(())
    }
}

pub(crate) struct Scales {
    scale: NoiseScale,
    adaptation: Adaptation,
    dt: f64,
    sample: usize,
    /// The diagonals of Q and R of the settings, and the variances of R.
    process: Vec<f64>,
    sensors: Vec<f64>,
    uncertainty: Vec<f64>,
}

impl Scales {
    pub(crate) fn new(settings: &FilterSettings, context: &FilterContext) -> Self {
        let noise = Beginning::of(settings, context).noise;
        Self {
            scale: NoiseScale::new(settings.process_scales),
            adaptation: settings.adaptation,
            dt: context.dt,
            sample: 0,
            process: noise.process.diagonal().as_slice().to_vec(),
            uncertainty: mapped(&noise.sensors, &|r| settings.adaptation.initial_uncertainty(*r)),
            sensors: noise.sensors,
        }
    }

    pub(crate) fn members(&self, settings: &FilterSettings, channels: &[Channel]) -> Vec<FilterSettings> {
        let of = |u: &f64| {
            let mut member = FilterSettings { process_scales: 1, ..settings.clone() };
            for &channel in channels {
                member.process_std[channel] = libm::exp(*u) * settings.process_std[channel];
            }
            member
        };
        mapped(&self.scale.grid, &of)
    }
}

impl WeightRule for Scales {
    fn weights(&self) -> &[f64] {
        &self.scale.weights
    }

    fn update(&mut self, members: &mut [MixtureMember]) -> Result<(), FilterError> {
        self.sample += 1;
        let learns = members.iter().any(MixtureMember::is_read) && self.adaptation.learns_at(self.sample, self.dt);
        let has_failed = members.iter().zip(self.weights()).any(|(one, weight)| one.failure.is_some() && *weight > 0.0);
        if has_failed || learns {
            let counts = |member: &MixtureMember| learns || member.failure.is_some();
            let keep = if learns { self.adaptation.forgetting } else { 1.0 };
            self.scale.take(members.iter().map(|one| if counts(one) { one.ln_likelihood() } else { 0.0 }), keep);
        }
        Ok(())
    }

    fn push(&self, members: &[MixtureMember], sample: Sample<'_>, sink: &mut dyn Sink) {
        let [u, std] = self.scale.moments;
        let process = mapped(&self.process, &|variance| libm::exp(2.0 * u) * variance);
        let samples = samples(members, self.weights());
        let learnt = samples.iter().filter_map(|(weight, sample)| Some((*weight, sample.noise?)));
        let (mut sensors, mut uncertainty) = (self.sensors.clone(), self.uncertainty.clone());
        for place in 0..sensors.len() {
            let mut own = Moments::default();
            own.mix(learnt.clone().map(|(weight, AssumedNoise { sensors, uncertainty, .. })| {
                (weight, [&sensors[place..=place], &uncertainty[place..=place]])
            }));
            if let ([r], [variance]) = (&own.mean[..], &own.cov[..]) {
                (sensors[place], uncertainty[place]) = (*r, *variance);
            }
        }
        let (process, sensors, uncertainty) = (&process[..], &sensors[..], &uncertainty[..]);
        let noise = AssumedNoise { process, sensors, uncertainty, process_scale: [u, std] };
        sink.push(&Sample { noise: Some(noise), ..sample });
    }
}

/// An interacting multiple model filter (IMM): in its second filter, parameters walk by w times their initial standard deviation a second.
/// ```text
/// cⱼ = Σᵢ pᵢⱼ μᵢ          each filter begins from the mixture of both, with the weights pᵢⱼ μᵢ / cⱼ
/// Λⱼ = N(eⱼ; 0, Sⱼ)       of its prediction and update
/// μⱼ = cⱼ Λⱼ / Σ cᵢ Λᵢ
/// ```
/// Source: Blom and Bar-Shalom (1988), The interacting multiple model algorithm for systems with Markovian switching coefficients;
/// Bar-Shalom, Li and Kirubarajan (2001), *Estimation with Applications to Tracking and Navigation*, section 11.6.6.
#[derive(Default)]
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

/// Beyond a half, the parameters would rather walk after a rest than go on resting.
const MOST_CHANGE: f64 = 0.5;

/// Parameters that walked are still again below this probability.
const CALM: f64 = 0.1;

impl Walk {
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

    /// For a plant that turns by this angle from a sample to the next \[rad\].
    pub(crate) fn new(turn: f64) -> Self {
        let [begins, ends] = [STILL, WALKS].map(|periods| (turn / (TAU * periods)).min(MOST_CHANGE));
        Self { weights: [1.0, 0.0], transition: [[1.0 - begins, begins], [ends, 1.0 - ends]], ..Self::default() }
    }
}

impl WeightRule for Walk {
    fn begin(&mut self, members: &mut [MixtureMember]) -> Result<(), FilterError> {
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
            for (MixtureMember { estimator, .. }, Moments { mean, cov }) in members.iter_mut().zip(&mixed) {
                estimator.set_belief(mean, cov)?;
            }
        }
        *weights = before;
        Ok(())
    }

    fn weights(&self) -> &[f64] {
        &self.weights
    }

    fn update(&mut self, members: &mut [MixtureMember]) -> Result<(), FilterError> {
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
        // Two thresholds: a probability that wavers about one half would begin a walk again and again.
        self.is_walking = self.weights[1] > if walked { CALM } else { 0.5 };
        self.has_begun = self.is_walking && !walked;
        Ok(())
    }

    fn push(&self, _: &[MixtureMember], sample: Sample<'_>, sink: &mut dyn Sink) {
        sink.push(&Sample { has_widened: self.has_begun, ..sample });
    }
}
