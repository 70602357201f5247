//! Several filters side by side that take Q for smaller and larger than the settings say.

use super::{Member, Rule};
use crate::mathematics::noise_scale::NoiseScale;
use crate::samples::estimator::FilterContext;
use crate::samples::estimator::setup::Beginning;
use crate::samples::sink::{AssumedNoise, Sample, Sink};
use crate::{Adaptation, Channel, FilterError, FilterSettings};

/// Filters that differ in the scale of Q alone, weighed by the posterior of the scale ([`NoiseScale`]).
///
/// Source: Magill (1965); Bar-Shalom, Li and Kirubarajan (2001), *Estimation with Applications to Tracking and Navigation*, section
/// 11.6.2 (the static multiple model estimator).
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
    /// Of the filters of some settings.
    pub(crate) fn new(settings: &FilterSettings, context: &FilterContext) -> Self {
        let noise = Beginning::of(settings, context).noise;
        Self {
            scale: NoiseScale::new(settings.process_scales),
            adaptation: settings.adaptation,
            dt: context.dt,
            sample: 0,
            process: noise.process.diagonal().as_slice().to_vec(),
            uncertainty: noise.sensors.iter().map(|r| settings.adaptation.initial_uncertainty(*r)).collect(),
            sensors: noise.sensors,
        }
    }

    /// The settings of all filters, over these channels.
    pub(crate) fn members(&self, settings: &FilterSettings, channels: &[Channel]) -> Vec<FilterSettings> {
        let of = |u: &f64| {
            let mut member = FilterSettings { process_scales: 1, ..settings.clone() };
            for &channel in channels {
                member.process_std[channel] = libm::exp(*u) * settings.process_std[channel];
            }
            member
        };
        self.scale.grid.iter().map(of).collect()
    }
}

impl Rule for Scales {
    fn weights(&self) -> &[f64] {
        &self.scale.weights
    }

    fn take(&mut self, members: &mut Vec<Member>) -> Result<(), FilterError> {
        self.sample += 1;
        let is_read = members.iter().any(|member| member.failure.is_none() && member.last.sample().readings() > 0);
        let learns = is_read && self.adaptation.learns_at(self.sample, self.dt);
        let has_failed = members.iter().zip(self.weights()).any(|(one, weight)| one.failure.is_some() && *weight > 0.0);
        if has_failed || learns {
            let of_sample = |member: &Member| {
                if learns || member.failure.is_some() { member.ln_likelihood() } else { 0.0 }
            };
            let keep = if learns { self.adaptation.forgetting } else { 1.0 };
            self.scale.take(members.iter().map(of_sample), keep);
        }
        Ok(())
    }

    fn push(&self, members: &[Member], sample: Sample<'_>, sink: &mut dyn Sink) {
        let [u, _] = self.scale.moments();
        let process: Vec<f64> = self.process.iter().map(|variance| libm::exp(2.0 * u) * variance).collect();
        let learnt: Vec<(f64, AssumedNoise<'_>)> = (members.iter().zip(self.weights()))
            .filter(|(member, weight)| member.failure.is_none() && **weight > super::LEAST)
            .filter_map(|(member, weight)| Some((*weight, member.last.sample().noise?)))
            .collect();
        let total: f64 = learnt.iter().map(|(weight, _)| weight).sum();
        let (mut sensors, mut uncertainty) = (self.sensors.clone(), self.uncertainty.clone());
        if total > 0.0 {
            for sensor in 0..sensors.len() {
                let mean = |of: &dyn Fn(&AssumedNoise<'_>) -> f64| {
                    learnt.iter().map(|(weight, noise)| weight * of(noise)).sum::<f64>() / total
                };
                let r = mean(&|noise| noise.sensors[sensor]);
                sensors[sensor] = r;
                uncertainty[sensor] = mean(&|noise| (noise.sensors[sensor] - r).powi(2) + noise.uncertainty[sensor]);
            }
        }
        let (process, sensors, uncertainty) = (&process[..], &sensors[..], &uncertainty[..]);
        let noise = AssumedNoise { process, sensors, uncertainty, process_scale: self.scale.moments() };
        sink.push(&Sample { noise: Some(noise), ..sample });
    }
}
