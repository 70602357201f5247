//! Several filters side by side that take Q for smaller and larger than the settings say.

use crate::data::record::Parts;
use crate::mathematics::filter::Correction;
use crate::mathematics::linalg::{fit, fit_vector};
use crate::mathematics::noise_scale::NoiseScale;
use crate::samples::estimator::book::{build_filter, initial_belief};
use crate::samples::estimator::{Estimator, FilterContext};
use crate::samples::sample::AssumedNoise;
use crate::samples::sink::{LastSample, Sample, Sink};
use crate::{Adaptation, Channel, FilterError, FilterSettings};

/// A bank of filters that differ in the scale of Q alone: what it tells is their mixture, with the posterior of the scale
/// ([`NoiseScale`]).
///
/// ```text
/// y = Σ wⱼ yⱼ,  P = Σ wⱼ (Pⱼ + (yⱼ - y) (yⱼ - y)ᵀ)
/// e = Σ w⁻ⱼ eⱼ,  S = Σ w⁻ⱼ (Sⱼ + (eⱼ - e) (eⱼ - e)ᵀ)      w⁻: the weights before the measurement
/// ```
///
/// Source: Magill (1965); Bar-Shalom, Li and Kirubarajan (2001), *Estimation with Applications to Tracking and Navigation*, section
/// 11.6.2 (the static multiple model estimator).
pub(crate) struct Scales {
    members: Vec<Member>,
    scale: NoiseScale,
    /// The weights before the measurement.
    before: Vec<f64>,
    adaptation: Adaptation,
    dt: f64,
    sample: usize,
    /// The diagonals of Q and R of the settings.
    process: Vec<f64>,
    sensors: Vec<f64>,
    told: Mixture,
}

/// The filter of one scale.
struct Member {
    estimator: Box<dyn Estimator>,
    last: LastSample,
    has_failed: bool,
}

/// The results of all filters together.
struct Mixture {
    belief: Moments,
    prior: Moments,
    gain: Vec<f64>,
    correction: Correction,
    /// The diagonals of Q and R, and the variances of R.
    noise: [Vec<f64>; 3],
}

/// Mean and covariance, n and n × n numbers.
#[derive(Default)]
struct Moments {
    mean: Vec<f64>,
    cov: Vec<f64>,
}

/// A filter with a smaller share adds nothing.
const LEAST: f64 = 1e-9;

/// The settings of the filter of one scale, u = ln s, over these channels.
fn member(settings: &FilterSettings, channels: &[Channel], u: f64) -> FilterSettings {
    let mut member = FilterSettings { process_scales: 1, ..settings.clone() };
    for &channel in channels {
        member.process_std[channel] = libm::exp(u) * settings.process_std[channel];
    }
    member
}

impl Scales {
    /// Of the filters that `build` makes of each member's settings.
    ///
    /// # Errors
    /// Those of the initial belief.
    pub(crate) fn new(
        settings: &FilterSettings,
        context: &FilterContext<'_>,
        build: impl Fn(&FilterSettings) -> Box<dyn Estimator>,
    ) -> Result<Self, FilterError> {
        let single = FilterSettings { process_scales: 1, ..settings.clone() };
        let filter = build_filter(initial_belief(&single, context)?, &single, context);
        let (n, noise) = (filter.model().size(), filter.noise());
        let scale = NoiseScale::new(settings.process_scales);
        let member = |u: &f64| Member {
            estimator: build(&member(settings, filter.model().channels(), *u)),
            last: LastSample::default(),
            has_failed: false,
        };
        Ok(Self {
            members: scale.grid().iter().map(member).collect(),
            before: scale.weights().to_vec(),
            adaptation: settings.adaptation,
            dt: context.dt,
            sample: 0,
            process: (0..n).map(|i| noise.process[(i, i)]).collect(),
            sensors: noise.sensors.clone(),
            told: Mixture {
                belief: Moments::default(),
                prior: Moments::default(),
                gain: Vec::new(),
                correction: Correction::nothing(n, context.sensors.len()),
                noise: [const { Vec::new() }; 3],
            },
            scale,
        })
    }

    /// Lets all filters take a step, and reports their mixture.
    fn step_all(
        &mut self,
        sink: &mut dyn Sink,
        step: impl Fn(&mut dyn Estimator, &mut dyn Sink) -> Result<(), FilterError>,
    ) -> Result<(), FilterError> {
        let wants_prior = sink.wants_prior();
        let mut reason = FilterError::NotFinite;
        for Member { estimator, last, has_failed } in self.members.iter_mut().filter(|member| !member.has_failed) {
            last.want_prior(wants_prior);
            if let Err(error) = step(&mut **estimator, last) {
                (*has_failed, reason) = (true, error);
            }
        }
        self.sample += 1;
        self.before.clear();
        self.before.extend_from_slice(self.scale.weights());
        let Some(first) = self.members.iter().find(|member| !member.has_failed) else { return Err(reason) };
        let learns = first.last.sample().readings() > 0 && self.adaptation.learns_at(self.sample, self.dt);
        let has_failed = self.members.iter().zip(&self.before).any(|(one, weight)| one.has_failed && *weight > 0.0);
        if has_failed || learns {
            let of_sample = |member: &Member| match member.has_failed {
                true => f64::NEG_INFINITY,
                false if learns => member.last.sample().ln_likelihood(),
                false => 0.0,
            };
            let keep = if learns { self.adaptation.forgetting } else { 1.0 };
            self.scale.take(self.members.iter().map(of_sample), keep);
        }
        self.told.mix(&self.members, [&self.before, self.scale.weights()], wants_prior)?;
        self.report(wants_prior, sink);
        Ok(())
    }

    fn report(&mut self, has_prior: bool, sink: &mut dyn Sink) {
        let Self { members, scale, process, sensors, told, .. } = self;
        let [u, _] = scale.moments();
        let [of_process, of_sensors, uncertainty] = &mut told.noise;
        of_process.clear();
        of_process.extend(process.iter().map(|variance| libm::exp(2.0 * u) * variance));
        let learnt = || members.iter().zip(scale.weights()).filter(|(_, weight)| **weight > LEAST);
        let of = |member: &Member, sensor: usize| {
            member
                .last
                .sample()
                .noise
                .map_or([sensors[sensor], 0.0], |noise| [noise.sensors[sensor], noise.uncertainty[sensor]])
        };
        of_sensors.clear();
        uncertainty.clear();
        for sensor in 0..sensors.len() {
            let total: f64 = learnt().map(|(_, weight)| weight).sum();
            let r = learnt().map(|(member, weight)| weight * of(member, sensor)[0]).sum::<f64>() / total;
            let apart = |member: &Member| (of(member, sensor)[0] - r).powi(2) + of(member, sensor)[1];
            of_sensors.push(r);
            uncertainty.push(learnt().map(|(member, weight)| weight * apart(member)).sum::<f64>() / total);
        }
        let Mixture { belief, prior, gain, correction, noise: [of_process, of_sensors, uncertainty] } = told;
        let (prior_mean, prior_cov): (&[f64], &[f64]) = if has_prior { (&prior.mean, &prior.cov) } else { (&[], &[]) };
        sink.push(&Sample {
            prior_mean,
            prior_cov,
            innovation: correction.innovation.as_slice(),
            innovation_cov: correction.innovation_cov.as_slice(),
            gain,
            earlier: correction.earlier,
            nis: correction.nis,
            determinant: correction.determinant,
            noise: Some(AssumedNoise {
                process: of_process,
                sensors: of_sensors,
                uncertainty,
                process_scale: scale.moments(),
            }),
            ..Sample::unmeasured(&belief.mean, &belief.cov)
        });
    }
}

impl Mixture {
    /// Mixes the results of the filters, with their weights before and after the measurement.
    fn mix(&mut self, members: &[Member], [before, after]: [&[f64]; 2], wants_prior: bool) -> Result<(), FilterError> {
        let of = |weights: &'_ [f64]| -> Vec<(f64, Sample<'_>)> {
            let own = members.iter().zip(weights).filter(|(member, weight)| !member.has_failed && **weight > LEAST);
            own.map(|(member, weight)| (*weight, member.last.sample())).collect()
        };
        let (before, after) = (of(before), of(after));
        if before.is_empty() || after.is_empty() {
            return Err(FilterError::ImpossibleMeasurement);
        }
        self.belief.mix(&after, |sample| (sample.mean, sample.cov));
        if wants_prior {
            self.prior.mix(&before, |sample| (sample.prior_mean, sample.prior_cov));
        }
        mean(&after, |sample| sample.gain, &mut self.gain);
        self.correct(&before, &after);
        let is_finite = self.belief.mean.iter().chain(&self.belief.cov).all(|number| number.is_finite());
        if is_finite { Ok(()) } else { Err(FilterError::NotFinite) }
    }

    /// Innovation and S of the mixture of the predictions. Of several readings of a sensor in one step, NIS and det S are those of the
    /// likeliest filter.
    fn correct(&mut self, before: &[(f64, Sample<'_>)], after: &[(f64, Sample<'_>)]) {
        let correction = &mut self.correction;
        let (mut innovation, mut moments) = (Vec::new(), Moments::default());
        mean(before, |sample| sample.innovation, &mut innovation);
        moments.mix(before, |sample| (sample.innovation, sample.innovation_cov));
        let m = innovation.len();
        fit_vector(&mut correction.innovation, m);
        fit(&mut correction.innovation_cov, m, m);
        correction.innovation.as_mut_slice().copy_from_slice(&innovation);
        correction.innovation_cov.as_mut_slice().copy_from_slice(&moments.cov);
        let kept: Vec<usize> = (0..m).filter(|&i| !innovation[i].is_nan()).collect();
        correction.take_squares(&kept);
        let likeliest = after.iter().max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, sample)| sample);
        correction.earlier = likeliest.map_or(0, |sample| sample.earlier);
        if let Some(sample) = likeliest.filter(|sample| sample.earlier > 0) {
            (correction.nis, correction.determinant) = (sample.nis, sample.determinant);
        }
    }
}

impl Moments {
    /// Mean and covariance of a mixture.
    fn mix<'a>(&mut self, parts: &[(f64, Sample<'a>)], of: impl Fn(&Sample<'a>) -> (&'a [f64], &'a [f64])) {
        mean(parts, |sample| of(sample).0, &mut self.mean);
        mean(parts, |sample| of(sample).1, &mut self.cov);
        let n = self.mean.len();
        let total: f64 = parts.iter().map(|(weight, _)| weight).sum();
        for (weight, sample) in parts {
            let own = of(sample).0;
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
fn mean<'a>(parts: &[(f64, Sample<'a>)], of: impl Fn(&Sample<'a>) -> &'a [f64], into: &mut Vec<f64>) {
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

impl Estimator for Scales {
    fn begin(&self, sink: &mut dyn Sink) -> Result<(), FilterError> {
        let mut first = LastSample::default();
        first.want_prior(sink.wants_prior());
        self.members[0].estimator.begin(&mut first)?;
        let noise = AssumedNoise {
            process: &self.process,
            sensors: &self.sensors,
            uncertainty: &self.sensors.iter().map(|r| self.adaptation.initial_uncertainty(*r)).collect::<Vec<_>>(),
            process_scale: self.scale.moments(),
        };
        sink.push(&Sample { noise: Some(noise), ..first.sample() });
        Ok(())
    }

    fn step(
        &mut self,
        force_before: f64,
        force: f64,
        measured: &[f64],
        sink: &mut dyn Sink,
    ) -> Result<(), FilterError> {
        self.step_all(sink, |member, sink| member.step(force_before, force, measured, sink))
    }

    fn step_through(&mut self, parts: &Parts, sink: &mut dyn Sink) -> Result<(), FilterError> {
        self.step_all(sink, |member, sink| member.step_through(parts, sink))
    }
}
