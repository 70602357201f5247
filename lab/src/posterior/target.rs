//! The likelihood of parameters that a filter takes for known.

use std::num::NonZero;
use std::panic::resume_unwind;
use std::sync::Arc;
use std::thread;

use kalmanscope_core::filter::{Adaptation, Robust};
use kalmanscope_core::{Channel, FilterKind, FilterSettings, Pass, Record, Scenario};

use super::{NoPosterior, PIECE, parameters};
use crate::{CellRun, outcomes_of};

pub(super) struct Target {
    scenario: Scenario,
    record: Arc<Record>,
    channels: Vec<Channel>,
    /// The initial belief of each parameter: mean, and standard deviation.
    belief: Vec<[f64; 2]>,
    bounds: Vec<[f64; 2]>,
    of_logarithms: bool,
    /// The threads that share points, one a processor; a browser has one.
    pub(super) threads: usize,
}

impl Target {
    pub(super) fn new(scenario: &Scenario, place: usize, record: &Record) -> Result<Self, NoPosterior> {
        // The record fits the filter as it is.
        Pass::new(scenario, place, record)?;
        let filter = scenario.filters[place].clone();
        let channels = parameters(&filter, scenario.plant.kind);
        if channels.is_empty() {
            return Err(NoPosterior::Known);
        }
        if filter.robust.is_on() {
            return Err(NoPosterior::Weighs);
        }
        if filter.adaptation.is_on() || filter.process_scales > 1 {
            return Err(NoPosterior::Learns);
        }
        if channels.iter().any(|channel| filter.consider.contains(channel)) {
            return Err(NoPosterior::Considers);
        }
        let belief = channels.iter().map(|&c| [filter.initial_mean[c], filter.initial_std[c]]).collect();
        let bounds = channels.iter().map(|channel| filter.bounds.of(*channel).ends()).collect();
        let of_logarithms = filter.log_parameters;
        let filter = knowing(filter, &channels, scenario);
        let scenario = Scenario { filters: vec![filter], ..scenario.clone() };
        Pass::new(&scenario, 0, record)?;
        let record = Arc::new(record.clone().without_truth());
        let count = || thread::available_parallelism().map_or(1, NonZero::get);
        let threads = if cfg!(target_family = "wasm") { 1 } else { count() };
        Ok(Self { scenario, record, channels, belief, bounds, of_logarithms, threads })
    }

    pub(super) fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// The values of the parameters at a point, which is in standard deviations of the initial belief.
    fn at(&self, point: &[f64]) -> Vec<f64> {
        let value = |(&[mean, std], &by): (&[f64; 2], &f64)| {
            if self.of_logarithms { mean * libm::exp(std / mean * by) } else { mean + std * by }
        };
        self.belief.iter().zip(point).map(value).collect()
    }

    pub(super) fn values(&self, point: &[f64]) -> Vec<f64> {
        let mut values = self.at(point);
        let frequency = self.channels.iter().position(|channel| *channel == Channel::NATURAL_FREQUENCY);
        if frequency.is_some_and(|place| values[place] < 0.0) {
            let mirrored = values.iter_mut().zip(&self.channels).filter(|(_, channel)| channel.is_mirrored());
            mirrored.for_each(|(value, _)| *value = -*value);
        }
        values
    }

    /// ln of the share of the initial belief that lies between the ends.
    pub(super) fn log_share(&self) -> f64 {
        let share = |(&[mean, std], ends): (&[f64; 2], &[f64; 2])| {
            // Φ of either end.
            let below = ends.map(|end| 0.5 * libm::erfc((mean - end) / (std * std::f64::consts::SQRT_2)));
            libm::log(below[1] - below[0])
        };
        self.belief.iter().zip(&self.bounds).map(share).sum()
    }

    /// ln p(z | θ) at some points, which threads share; -∞ where the filter cannot run, and beyond the ends.
    pub(super) fn log_likelihoods(&self, points: &[Vec<f64>]) -> Vec<f64> {
        let each = points.len().div_ceil(self.threads).max(PIECE);
        let (own, others) = points.split_at(points.len().min(each));
        if others.is_empty() {
            return self.piece(own);
        }
        thread::scope(|scope| {
            let begin =
                |piece| thread::Builder::new().spawn_scoped(scope, move || self.piece(piece)).map_err(|_| piece);
            let begun: Vec<_> = others.chunks(each).map(begin).collect();
            let mut all = self.piece(own);
            for other in begun {
                all.extend(match other {
                    Ok(thread) => thread.join().unwrap_or_else(|panic| resume_unwind(panic)),
                    // The system gives no thread.
                    Err(piece) => self.piece(piece),
                });
            }
            all
        })
    }

    fn piece(&self, points: &[Vec<f64>]) -> Vec<f64> {
        let run = |point: &Vec<f64>| {
            let mut scenario = self.scenario.clone();
            let values = self.at(point);
            let is_within =
                values.iter().zip(&self.bounds).all(|(value, [least, most])| (least..=most).contains(&value));
            for (&channel, value) in self.channels.iter().zip(values) {
                scenario.filters[0].initial_mean[channel] = value;
            }
            let is_possible = is_within && scenario.validate().is_ok();
            is_possible.then(|| CellRun { scenario, record: Arc::clone(&self.record) })
        };
        let runs: Vec<Option<CellRun>> = points.iter().map(run).collect();
        let outcomes = outcomes_of(&runs, 0, &[]);
        let likelihood = |outcome: kalmanscope_core::score::Outcome| {
            let is_whole = outcome.stop.is_none() && outcome.log_likelihood.is_finite();
            if is_whole { outcome.log_likelihood } else { f64::NEG_INFINITY }
        };
        outcomes.into_iter().map(|outcome| outcome.map_or(f64::NEG_INFINITY, likelihood)).collect()
    }
}

/// The filter that takes these parameters for known and constant, and forgets nothing.
fn knowing(filter: FilterSettings, channels: &[Channel], scenario: &Scenario) -> FilterSettings {
    let is_linear = filter.plant.unwrap_or(scenario.plant.kind).info().is_linear;
    let kind = match filter.kind {
        _ if is_linear => FilterKind::EKF,
        kind if kind.is_sampled() => FilterKind::UKF,
        kind => kind,
    };
    let mut knowing = FilterSettings {
        kind,
        adaptation: Adaptation::default(),
        robust: Robust::NONE,
        jump: false,
        smoother: false,
        log_parameters: false,
        guesses: 1,
        process_scales: 1,
        walk: 0.0,
        fading: 1.0,
        eta: 0.0,
        ..filter
    };
    knowing.bounds.retain(|channel| !channels.contains(&channel));
    for &channel in channels {
        knowing.initial_std[channel] = 0.0;
        knowing.process_std[channel] = 0.0;
    }
    knowing
}
