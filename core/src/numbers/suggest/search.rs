//! Start values of an equation's own parameters: a filter begins from points all over their ranges, and goes on from
//! the end of the likeliest run.

use super::follow::{first_alone, likelihood};
use super::response::{free_response, order};
use super::{Suggestion, moments, motion_sensor, rounded, set_share};
use crate::mathematics::channel::{MAX_MASSES, Role, Sign};
use crate::mathematics::equation::Equation;
use crate::{Aspect, Channel, FilterKind, Quantity, Record, Run, Scenario, Signal};

/// The points for each parameter, and for all of them at most.
const POINTS: (usize, usize) = (10, 48);

/// The number of times that the filter goes on from the end of the likeliest run.
const AGAIN: usize = 4;

/// The motion's process noise per step in a trial, as a share of its size: a parameter that is wrong must not stop the filter.
const SHARE: f64 = 1e-3;

/// The parameters of a linear oscillator that spectra give.
const TOLD: [Channel; 2] = [Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO];

/// Prime numbers; their square roots spread points evenly in as many dimensions.
const PRIMES: [f64; 12] = [2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0, 23.0, 29.0, 31.0, 37.0];

/// The trials of start values for the parameters of an equation.
pub(super) struct Search {
    channels: Vec<Channel>,
    /// The magnitudes between which each is tried, and the share of points with the other sign than the guess.
    ranges: Vec<(f64, f64, f64)>,
    points: usize,
    tried: usize,
    best: Option<Best>,
}

/// A trial that went through.
struct Best {
    likelihood: f64,
    /// The mean and the standard deviation of each parameter at the end.
    ends: Vec<(f64, f64)>,
}

impl Search {
    /// The search for a suggestion, if its first filter has an equation with parameters that the spectra cannot give.
    /// The other parameters are searched around the spectra's values.
    pub(super) fn of(suggestion: &Suggestion) -> Option<Self> {
        let (equation, channels) = suggestion.own_parameters()?;
        let filter = suggestion.scenario.filters.first()?;
        let settings = equation.settings();
        let range = |channel: &Channel| {
            let usual = channel.usual();
            if TOLD.contains(channel) && suggestion.is_guessed {
                let told = filter.initial_mean[*channel];
                return (told / 4.0, 4.0 * told, 0.0);
            }
            let size = if usual.mean == 0.0 { usual.std } else { usual.mean.abs() }.max(f64::MIN_POSITIVE);
            let given = settings.parameter(channel.key()).and_then(|one| one.range);
            let most = given.map_or(50.0 * size, |[low, high]| low.abs().max(high.abs()));
            let is_one_sided = given.is_some_and(|[low, high]| low >= 0.0 || high <= 0.0)
                || !matches!(channel.role(), Role::Parameter(Sign::Any));
            let other = if is_one_sided { 0.0 } else { 0.25 };
            (most / if given.is_some() { 200.0 } else { 2500.0 }, most, other)
        };
        let points = (POINTS.0 * channels.len()).min(POINTS.1);
        let ranges = channels.iter().map(range).collect();
        Some(Self { channels, ranges, points, tried: 0, best: None })
    }

    /// The share that is done, from 0 to 1.
    pub(super) fn progress(&self) -> f64 {
        self.tried as f64 / (self.points + AGAIN) as f64
    }

    pub(super) fn is_done(&self) -> bool {
        self.tried >= self.points + AGAIN || (self.tried >= self.points && self.best.is_none())
    }

    /// The scenario of the next trial.
    pub(super) fn scenario(&self, of: &Scenario) -> Scenario {
        let mut scenario = first_alone(of);
        let (kind, input) = (scenario.plant.kind, scenario.input);
        for filter in &mut scenario.filters {
            filter.kind = FilterKind::EKF;
            set_share(filter, kind, input, SHARE);
            for (place, &channel) in self.channels.iter().enumerate() {
                let guess = (filter.initial_mean[channel], filter.initial_std[channel]);
                let (mean, std) = self.start(place, guess);
                (filter.initial_mean[channel], filter.initial_std[channel]) = (mean, std);
                filter.process_std[channel] = 0.0;
            }
        }
        scenario
    }

    /// Mean and standard deviation with which a parameter begins the next trial: the guess, then points, then the best end.
    fn start(&self, place: usize, guess: (f64, f64)) -> (f64, f64) {
        if self.tried == 0 {
            return guess;
        }
        let (low, high, other) = self.ranges[place];
        if let Some(Best { ends, .. }) = self.best.as_ref().filter(|_| self.tried >= self.points) {
            let (mean, std) = ends[place];
            return (mean, (0.3 * mean.abs()).max(2.0 * std).max(1e-3 * low));
        }
        let root = libm::sqrt(PRIMES[place % PRIMES.len()]);
        let along = (0.5 + self.tried as f64 * root).fract();
        let is_other = along < other;
        let along = if is_other { along / other } else { (along - other) / (1.0 - other) };
        let size = low * libm::pow(high / low, along);
        let is_negative = (guess.0 < 0.0) != is_other;
        (if is_negative { -size } else { size }, 0.5 * size)
    }

    /// Takes in the trial, if it was possible.
    pub(super) fn take(&mut self, run: Option<Run>) {
        self.tried += 1;
        let Some(run) = run else { return };
        let Some((likelihood, estimates)) = likelihood(&run).zip(run.estimates().first()) else { return };
        let Some(last) = estimates.len().checked_sub(1) else { return };
        let end = |&channel: &Channel| {
            let place = estimates.place(channel)?;
            let mean = estimates.canonical_mean(last, place);
            let is_allowed = match channel.role() {
                Role::Parameter(Sign::Positive) => mean > 0.0,
                Role::Parameter(Sign::NotNegative) => mean >= 0.0,
                _ => mean.is_finite(),
            };
            is_allowed.then(|| (mean, estimates.std(last, place)))
        };
        let Some(ends) = self.channels.iter().map(end).collect::<Option<Vec<_>>>() else { return };
        if self.best.as_ref().is_none_or(|best| likelihood > best.likelihood) {
            self.best = Some(Best { likelihood, ends });
        }
    }

    /// Says that nothing is searched, because the record has no input.
    pub(super) fn give_up(self, suggestion: &mut Suggestion) {
        suggestion.reasons.push(format!(
            "{} begin with the guesses of the equation: without an input no start values of its parameters are searched",
            self.names()
        ));
    }

    /// The symbols of the parameters.
    fn names(&self) -> String {
        self.channels.iter().map(|channel| channel.symbol()).collect::<Vec<_>>().join(", ")
    }

    /// Lets every filter begin where the likeliest trial has ended, or says that none went through.
    pub(super) fn finish(self, suggestion: &mut Suggestion) {
        let names = self.names();
        let Self { channels, best, points, .. } = self;
        let Some(Best { ends, .. }) = best else {
            suggestion.reasons.push(format!(
                "no start values of {names} could be found: the filter goes through from none of {points} points, and begins with \
                 the guesses of the equation"
            ));
            return;
        };
        let mut told = Vec::new();
        for (&channel, (mean, std)) in channels.iter().zip(ends) {
            let (mean, std) = (rounded(mean), rounded((0.2 * mean.abs()).max(3.0 * std)));
            let unit = suggestion.unit(channel.unit());
            told.push(format!("{} {mean} {unit}", channel.symbol()).trim_end().to_owned());
            // The truth of a measured record is not known: these values are for a simulation in its place.
            if suggestion.scenario.plant.parameter(channel).is_some() {
                suggestion.scenario.plant.set(channel, Signal::Constant(mean));
            }
            for filter in &mut suggestion.scenario.filters {
                (filter.initial_mean[channel], filter.initial_std[channel]) = (mean, std);
                filter.process_std[channel] = 0.0;
            }
        }
        suggestion.reasons.push(format!(
            "guess of the equation's parameters: {}, where a filter has ended from the likeliest of {points} points in their \
             ranges; their spread is a fifth of it, or three of the filter's σ",
            told.join(", ")
        ));
    }
}

impl Suggestion {
    /// The equation of the first filter and its parameters, if spectra cannot give all of them.
    pub(super) fn own_parameters(&self) -> Option<(&'static Equation, Vec<Channel>)> {
        let kind = self.scenario.filters.first()?.plant.unwrap_or(self.scenario.plant.kind);
        let equation = kind.own_equation()?;
        kind.parameters().any(|channel| !TOLD.contains(&channel)).then(|| (equation, kind.parameters().collect()))
    }

    /// Whether a constant part may be motion: where the first filter has an equation that is not linear.
    pub(super) fn knows_zero(&self) -> bool {
        self.own_parameters().is_some_and(|(equation, _)| !equation.is_linear())
    }

    /// Lets filters of an equation without a natural frequency expect a motion of the size that the record shows.
    pub(super) fn size_of_motion(&mut self, record: &Record) {
        let Some((quantity, measured)) = motion_sensor(record) else { return };
        let band = self.scenario.record.as_ref().and_then(|mapping| mapping.band);
        let Some(found) = free_response(record, measured, band) else { return };
        let (_, size) = moments(measured);
        let displacement = size / libm::pow(found.natural_frequency, f64::from(order(quantity)));
        for filter in self.filters() {
            for mass in 0..MAX_MASSES {
                let first = record.measured_quantity(Quantity::new(Aspect::DISPLACEMENT, mass));
                let first = first.and_then(|all| all.iter().copied().find(|value| !value.is_nan()));
                let (x, v) = (Channel::displacement(mass), Channel::velocity(mass));
                (filter.initial_mean[x], filter.initial_mean[v]) = (rounded(first.unwrap_or(0.0)), 0.0);
                filter.initial_std[x] = rounded(displacement.max(f64::MIN_POSITIVE));
                filter.initial_std[v] = rounded((displacement * found.natural_frequency).max(f64::MIN_POSITIVE));
            }
        }
    }
}
