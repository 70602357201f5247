//! Several filters side by side that take Q for smaller and larger than the settings say.

use super::{Member, Rule};
use crate::mathematics::lists::mapped;
use crate::mathematics::mixed::Moments;
use crate::mathematics::noise_scale::NoiseScale;
use crate::samples::estimator::FilterContext;
use crate::samples::estimator::setup::Beginning;
use crate::samples::sink::{AssumedNoise, Sample, Sink};
use crate::{Adaptation, Channel, FilterError, FilterSettings};

/// Filters that differ in the scale of Q alone, weighed by the posterior of the scale ([`NoiseScale`]).
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

impl Rule for Scales {
    fn weights(&self) -> &[f64] {
        &self.scale.weights
    }

    fn update(&mut self, members: &mut [Member]) -> Result<(), FilterError> {
        self.sample += 1;
        let learns = members.iter().any(Member::is_read) && self.adaptation.learns_at(self.sample, self.dt);
        let has_failed = members.iter().zip(self.weights()).any(|(one, weight)| one.failure.is_some() && *weight > 0.0);
        if has_failed || learns {
            let counts = |member: &Member| learns || member.failure.is_some();
            let keep = if learns { self.adaptation.forgetting } else { 1.0 };
            self.scale.take(members.iter().map(|one| if counts(one) { one.ln_likelihood() } else { 0.0 }), keep);
        }
        Ok(())
    }

    fn push(&self, members: &[Member], sample: Sample<'_>, sink: &mut dyn Sink) {
        let [u, std] = self.scale.moments();
        let process = mapped(&self.process, &|variance| libm::exp(2.0 * u) * variance);
        let samples = super::samples(members, self.weights());
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
