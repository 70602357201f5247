//! The posterior of the parameters of a filter's plant, without the filter's assumption that it is normal.
//!
//! ```text
//! p(θ | z) ∝ p(θ) p(z | θ),  p(z | θ) by the same filter, which takes θ for known
//! ```
//!
//! θ are the parameters of the plant that the filter estimates, constant over the record, and p(θ) is its initial belief. Motion and
//! augmentations stay in the filter. Where the plant is linear for a known θ, p(z | θ) is exact; for other plants it is as good as the
//! filter's prediction of the motion alone.

mod population;

use std::sync::Arc;

use kalmanscope_core::filter::{Adaptation, Robust};
use kalmanscope_core::internals::sort_numbers;
use kalmanscope_core::score::Outcome;
use kalmanscope_core::{Channel, FilterKind, FilterSettings, Pass, PlantKind, Record, RunError, Scenario};
use serde::{Deserialize, Serialize};

use population::Population;

use crate::runner::outcomes_of;
use crate::{CellRun, in_parts, processors};

const PIECE: usize = 16;

/// Limits the points, and the samples that all of them go over between two temperatures, about.
const POINTS: [usize; 2] = [128, 512];
const SAMPLES: usize = 700_000;

/// Why there is no posterior to compare a filter with.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoPosterior {
    /// The filter has no likelihood of constant parameters.
    #[error("the filter {0}")]
    Filter(&'static str),
    /// The filter cannot run over the record.
    #[error(transparent)]
    Run(#[from] RunError),
}

/// Points of a posterior, which all count the same.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sampled {
    /// The parameters.
    pub channels: Vec<Channel>,
    /// A value for each parameter in its unit, canonical: a natural frequency is not negative.
    pub points: Vec<Vec<f64>>,
    /// ln p(z), the logarithm of the probability density of the record.
    pub log_evidence: f64,
    /// The number of runs that it took.
    pub runs: u64,
}

impl Sampled {
    /// The values of one parameter; `None` if the filter does not estimate it.
    pub fn values(&self, channel: Channel) -> Option<Vec<f64>> {
        let place = self.channels.iter().position(|other| *other == channel)?;
        Some(self.points.iter().map(|point| point[place]).collect())
    }

    /// Mean and standard deviation of one parameter.
    pub fn moments(&self, channel: Channel) -> Option<[f64; 2]> {
        let values = self.values(channel)?;
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let variance = values.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>() / (count - 1.0);
        Some([mean, libm::sqrt(variance)])
    }

    /// Whether a filter lets the parameters change over some steps, by more than a part of the width of these points.
    pub fn is_stiller_than(&self, filter: &FilterSettings, steps: usize) -> bool {
        let walks = |channel: &Channel| {
            let way = filter.process_std[*channel] * libm::sqrt(steps as f64);
            self.moments(*channel).is_some_and(|[_, std]| way > PART * std)
        };
        filter.fading > 1.0 || filter.jump || filter.walk > 0.0 || filter.eta > 0.0 || self.channels.iter().any(walks)
    }

    /// The two solutions of the parameter that has them furthest apart; `None` where all points are of one.
    pub fn solutions(&self) -> Option<(Channel, Solutions)> {
        let of = |&channel: &Channel| Some((channel, Solutions::of(self.values(channel)?)?));
        self.channels.iter().filter_map(of).max_by(|a, b| a.1.distance.total_cmp(&b.1.distance))
    }
}

const PART: f64 = 0.3;

fn parameters(filter: &FilterSettings, truth: &PlantKind) -> Vec<Channel> {
    let of_plant = filter.plant.as_ref().unwrap_or(truth).parameters();
    let is_estimated = |channel: &Channel| !filter.knows(*channel) && filter.initial_std[*channel] > 0.0;
    of_plant.filter(|channel| !channel.is_augmentation()).filter(is_estimated).collect()
}

/// Two groups of values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solutions {
    /// The mean of each group; the lower one first.
    pub means: [f64; 2],
    /// The share of the values in each group.
    pub shares: [f64; 2],
    /// The distance of the means over the root mean square of the standard deviations of both groups.
    pub distance: f64,
}

/// The smallest distance of two groups. The halves of a normal distribution are 2.6 apart, those of a uniform one 3.5.
const LEAST_DISTANCE: f64 = 5.0;

const LEAST_SHARE: f64 = 0.03;

impl Solutions {
    /// `None` where the values are one group. Source: Otsu (1979), A threshold selection method from gray-level histograms; Ashman, Bird
    /// and Zepf (1994), Detecting bimodality in astronomical datasets, for the distance.
    pub fn of(mut values: Vec<f64>) -> Option<Self> {
        sort_numbers(&mut values);
        let count = values.len();
        let total: f64 = values.iter().sum();
        let (mut sum, mut best) = (0.0, (0.0, 0));
        for (place, value) in values.iter().enumerate().take(count.saturating_sub(1)) {
            sum += value;
            let [below, above] = [place + 1, count - place - 1].map(|part| part as f64);
            let apart = (total - sum) / above - sum / below;
            let between = below * above * apart * apart;
            if between > best.0 {
                best = (between, place + 1);
            }
        }
        let groups = [&values[..best.1], &values[best.1..]];
        let shares = groups.map(|group| group.len() as f64 / count as f64);
        if shares.iter().any(|share| *share < LEAST_SHARE) {
            return None;
        }
        let means = groups.map(|group| group.iter().sum::<f64>() / group.len() as f64);
        let variance = |i: usize| {
            groups[i].iter().map(|value| (value - means[i]) * (value - means[i])).sum::<f64>() / groups[i].len() as f64
        };
        let distance = (means[1] - means[0]) / libm::sqrt(0.5 * (variance(0) + variance(1)));
        (distance > LEAST_DISTANCE).then_some(Self { means, shares, distance })
    }
}

/// The likelihood of parameters, by the filter that takes them for known.
pub struct Target {
    scenario: Scenario,
    record: Arc<Record>,
    channels: Vec<Channel>,
    belief: Vec<[f64; 2]>,
    bounds: Vec<[f64; 2]>,
    of_logarithms: bool,
    /// The number of threads that share the points.
    pub threads: usize,
}

impl Target {
    /// The likelihood of the parameters that the filter at `place` of a scenario estimates.
    ///
    /// # Errors
    /// [`NoPosterior`]
    pub fn new(scenario: &Scenario, place: usize, record: &Record) -> Result<Self, NoPosterior> {
        Pass::new(scenario, place, record)?;
        let filter = scenario.filters[place].clone();
        let channels = parameters(&filter, &scenario.plant.kind);
        let learns = filter.adaptation.is_on() || filter.process_scales > 1;
        // Those of considered parameters have the ±2σ of the initial belief on purpose.
        let considers = channels.iter().any(|channel| filter.consider.contains(channel));
        let reasons = [
            (channels.is_empty(), "estimates no parameter of its plant"),
            (filter.robust.is_on(), "weighs its readings, which then have no likelihood"),
            (learns, "learns its noise, so the likelihood is not known beforehand"),
            (considers, "considers parameters that it does not estimate"),
        ];
        if let Some((_, why)) = reasons.into_iter().find(|(is_so, _)| *is_so) {
            return Err(NoPosterior::Filter(why));
        }
        let belief = channels.iter().map(|&c| [filter.initial_mean[c], filter.initial_std[c]]).collect();
        let bounds = channels.iter().map(|channel| filter.bounds.of(*channel).ends()).collect();
        let of_logarithms = filter.log_parameters;
        let filter = knowing(filter, &channels, scenario);
        let scenario = Scenario { filters: vec![filter], ..scenario.clone() };
        Pass::new(&scenario, 0, record)?;
        let record = Arc::new(record.clone().without_truth());
        Ok(Self { scenario, record, channels, belief, bounds, of_logarithms, threads: processors() })
    }

    /// Points of the posterior; equal arguments give equal points. `None` where no draw of the initial belief explains the record. They
    /// begin as draws of the initial belief, and the likelihood is turned on by degrees. At each degree the points are drawn again by
    /// their weights, and move by differences of others.
    ///
    /// Source: Del Moral, Doucet and Jasra (2006), Sequential Monte Carlo samplers; Neal (2001), Annealed importance sampling; ter Braak
    /// (2006), A Markov chain Monte Carlo version of the genetic algorithm differential evolution.
    pub fn sample(self) -> Option<Sampled> {
        let count = (SAMPLES / self.record.len().max(1)).clamp(POINTS[0], POINTS[1]) / PIECE * PIECE;
        let log_likelihoods = |points: &[Vec<f64>]| self.log_likelihoods(points);
        let mut population = Population::new(count, self.channels.len(), self.scenario.seed, log_likelihoods);
        // Draws of the whole belief have begun, of which those beyond its ends count for nothing.
        let log_evidence = population.heat()? - self.log_share();
        let points = population.points.iter().map(|point| self.values(&point.at)).collect();
        let runs = population.runs;
        Some(Sampled { channels: self.channels, points, log_evidence, runs })
    }

    fn at(&self, point: &[f64]) -> Vec<f64> {
        let value = |(&[mean, std], &by): (&[f64; 2], &f64)| {
            if self.of_logarithms { mean * libm::exp(std / mean * by) } else { mean + std * by }
        };
        self.belief.iter().zip(point).map(value).collect()
    }

    fn values(&self, point: &[f64]) -> Vec<f64> {
        let mut values = self.at(point);
        let frequency = self.channels.iter().position(|channel| *channel == Channel::NATURAL_FREQUENCY);
        if frequency.is_some_and(|place| values[place] < 0.0) {
            let mirrored = values.iter_mut().zip(&self.channels).filter(|(_, channel)| channel.is_mirrored());
            mirrored.for_each(|(value, _)| *value = -*value);
        }
        values
    }

    /// ln of the share of the initial belief that lies between the ends.
    fn log_share(&self) -> f64 {
        let share = |(&[mean, std], ends): (&[f64; 2], &[f64; 2])| {
            let below = ends.map(|end| 0.5 * libm::erfc((mean - end) / (std * std::f64::consts::SQRT_2)));
            libm::log(below[1] - below[0])
        };
        self.belief.iter().zip(&self.bounds).map(share).sum()
    }

    /// ln p(z | θ) at points in standard deviations of the initial belief; -∞ where the filter cannot run, and beyond the bounds.
    pub fn log_likelihoods(&self, points: &[Vec<f64>]) -> Vec<f64> {
        in_parts(points, self.threads, PIECE, |points| self.piece(points))
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
        let is_whole = |outcome: &&Outcome| outcome.stop.is_none() && outcome.log_likelihood.is_finite();
        let likelihood = |outcome: &Option<Outcome>| outcome.as_ref().filter(is_whole).map(|one| one.log_likelihood);
        outcomes.iter().map(|outcome| likelihood(outcome).unwrap_or(f64::NEG_INFINITY)).collect()
    }
}

fn knowing(filter: FilterSettings, channels: &[Channel], scenario: &Scenario) -> FilterSettings {
    let is_linear = filter.plant.as_ref().unwrap_or(&scenario.plant.kind).info().is_linear;
    let kind = match filter.kind {
        // With known parameters a linear plant makes of an EKF a Kalman filter, whose likelihood is exact.
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
