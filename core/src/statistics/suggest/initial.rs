//! The belief that filters begin with, the gain of the input, and the search for parameters of an equation.

use crate::equation::Equation;
use kalmanscope_filters::channel::{Role, Sign};
use kalmanscope_filters::lists::{mapped, sort_items};
use kalmanscope_filters::{Aspect, Channel, FilterKind, InputKind, Quantity};
use kalmanscope_records::Record;

use super::likeliest::{Likeliest, first_alone, likelihood_over, tried};
use super::response::{DecayFit, MeasuredResponse, order};
use super::{Suggestion, augment, begin_with, moments, rounded, set_share};
use crate::{FilterSettings, PlantKind, Run, Scenario};

/// A filter of a free decay begins with this many σ of the fit: readings count again, and a linearisation must hold.
pub(super) const LOOSE: f64 = 30.0;

impl Suggestion {
    pub(super) fn begin_at(&mut self, record: &mut Record, quantity: Quantity, found: &MeasuredResponse, reason: &str) {
        let MeasuredResponse { natural_frequency, damping_ratio, gain } = *found;
        let (wn, zeta) = (rounded(natural_frequency), rounded(damping_ratio));
        let hertz = rounded(wn / std::f64::consts::TAU);
        self.reasons.push(format!("guess of ωₙ: {wn} rad/s ({hertz} Hz) and of ζ: {zeta}, {reason}"));
        self.simulate_with(Channel::NATURAL_FREQUENCY, wn);
        self.simulate_with(Channel::DAMPING_RATIO, zeta);
        self.gain(record, gain);
        let displacement = self.expect_motion(record, quantity, natural_frequency, 1);
        let measured = record.measured_quantity(quantity).unwrap_or_default();
        let most = measured.iter().filter(|value| !value.is_nan()).fold(0.0_f64, |most, value| most.max(value.abs()));
        let largest = most / libm::pow(natural_frequency, f64::from(order(quantity)));
        let cubic = 0.5 * natural_frequency * natural_frequency / (largest * largest);
        let cubic = if largest > 0.0 { cubic } else { 1.0 };
        for filter in self.filters() {
            let std = |value: f64| rounded(value.max(f64::MIN_POSITIVE));
            begin_with(filter, Channel::NATURAL_FREQUENCY, (wn, std(0.1 * natural_frequency)));
            begin_with(filter, Channel::DAMPING_RATIO, (zeta, std((0.5 * damping_ratio).max(0.01))));
            begin_with(filter, Channel::CUBIC_STIFFNESS, (0.0, std(cubic)));
        }
        self.reasons.push("initial spread: a tenth of ωₙ, half of ζ, and the size of the motion itself".to_owned());
        let (kind, input) = (self.scenario.plant.kind.clone(), self.scenario.input);
        let mut yields = false;
        self.filters().for_each(|filter| yields |= start_yielding(filter, &kind, input, displacement));
        if yields {
            self.reasons.push(
                "β and γ: the spring is about to yield at twice the root mean square of the displacement".to_owned(),
            );
        }
    }

    pub(super) fn begin_as_large(&mut self, quantity: Quantity, decay: &DecayFit) {
        let DecayFit { found: MeasuredResponse { natural_frequency, damping_ratio, .. }, spread, amplitude, .. } =
            *decay;
        let displacement = amplitude / libm::pow(natural_frequency, f64::from(order(quantity)));
        let sizes = [(Channel::DISPLACEMENT, displacement), (Channel::VELOCITY, displacement * natural_frequency)];
        for filter in self.filters() {
            for (channel, size) in sizes {
                filter.initial_std[channel] = filter.initial_std[channel].max(rounded(size));
            }
        }
        if !decay.is_all {
            return;
        }
        // The readings count again in the filter: a spread far above that of the fit says next to nothing, and breaks a linearisation.
        let eight_digits = |value: f64| format!("{value:.7e}").parse().unwrap_or(value);
        let starts = [
            (Channel::NATURAL_FREQUENCY, natural_frequency, (LOOSE * spread[0]).max(1e-5 * natural_frequency)),
            (Channel::DAMPING_RATIO, damping_ratio, (LOOSE * spread[1]).max(0.01 * damping_ratio)),
        ];
        for filter in self.filters() {
            for (channel, value, spread) in starts.map(|(channel, value, spread)| (channel, value, rounded(spread))) {
                if spread < filter.initial_std[channel] {
                    (filter.initial_mean[channel], filter.initial_std[channel]) = (eight_digits(value), spread);
                }
            }
        }
        self.reasons.push(format!("spread of ωₙ and ζ: {LOOSE} times that of the fit at most"));
    }

    fn gain(&mut self, record: &mut Record, gain: Option<f64>) {
        // The fitted gain may include terms of the equation that an oscillator lacks.
        let gain = gain.filter(|_| self.own_parameters().is_none());
        let Some(gain) = gain.filter(|gain| gain.is_finite() && *gain != 0.0) else { return };
        if (gain - 1.0).abs() < 0.02 {
            return;
        }
        let gain = rounded(gain);
        if let Some(input) = self.scenario.record.as_mut().and_then(|mapping| mapping.input.as_mut()) {
            input.gain *= gain;
            record.change_input(|value| value * gain);
            self.reasons.push(format!(
                "gain of the input: {} m/s² for one unit of its column, from the same fit; the filters estimate the rest",
                input.gain
            ));
        } else {
            self.reasons.push(format!("gain of the input: {gain}, from the same fit"));
        }
        let is_mapped = self.scenario.record.is_some();
        for filter in self.filters() {
            let mean = if is_mapped { 1.0 } else { gain };
            if !is_mapped && filter.augment.contains(&Channel::INPUT_OFFSET) {
                // The offset belongs to the true input; its gain is not yet known well.
                let offset = mean * filter.initial_mean[Channel::INPUT_OFFSET];
                filter.initial_mean[Channel::INPUT_OFFSET] = offset;
                filter.initial_std[Channel::INPUT_OFFSET] = rounded(0.2 * offset.abs());
            }
            augment(filter, Channel::INPUT_GAIN, (mean, rounded(0.2 * mean.abs())));
        }
    }

    pub(super) fn own_parameters(&self) -> Option<(&Equation, Vec<Channel>)> {
        let kind = self.scenario.filters.first()?.plant.as_ref().unwrap_or(&self.scenario.plant.kind);
        let equation = kind.own_equation()?;
        kind.parameters()
            .any(|channel| !FROM_SPECTRA.contains(&channel))
            .then(|| (equation, kind.parameters().collect()))
    }

    /// Lets every filter expect a motion of some masses of the size that a quantity shows. Returns that of the displacement \[m\].
    pub(super) fn expect_motion(&mut self, record: &Record, quantity: Quantity, wn: f64, masses: usize) -> f64 {
        let (_, size) = moments(record.measured_quantity(quantity).unwrap_or_default());
        let displacement = size / libm::pow(wn, f64::from(order(quantity)));
        for filter in self.filters() {
            for mass in 0..masses {
                let first = record.measured_quantity(Quantity::new(Aspect::DISPLACEMENT, mass));
                let first = first.and_then(|all| all.iter().copied().find(|value| !value.is_nan()));
                let (x, v) = (Channel::displacement(mass), Channel::velocity(mass));
                (filter.initial_mean[x], filter.initial_mean[v]) = (rounded(first.unwrap_or(0.0)), 0.0);
                filter.initial_std[x] = rounded(displacement.max(f64::MIN_POSITIVE));
                filter.initial_std[v] = rounded((displacement * wn).max(f64::MIN_POSITIVE));
            }
        }
        displacement
    }
}

/// Share of the load that the spring keeps after yielding, to begin with.
const POST_YIELD: (f64, f64) = (0.5, 0.25);

/// Lets a Bouc-Wen spring yield at twice the root mean square `displacement` \[m\]. Returns false for another plant.
fn start_yielding(filter: &mut FilterSettings, truth: &PlantKind, input: InputKind, displacement: f64) -> bool {
    let model = filter.model(truth, input);
    let shapes = [
        (Channel::YIELD_BETA, Channel::YIELD_GAMMA, 1.0 / (2.0 * displacement)),
        (Channel::HYSTERESIS_BETA, Channel::HYSTERESIS_GAMMA, 1.0 / (4.0 * displacement * displacement)),
    ];
    let Some((beta, gamma, shape)) = shapes.into_iter().find(|(beta, ..)| model.place(*beta).is_some()) else {
        return false;
    };
    if !(shape.is_finite() && shape > 0.0) {
        return false;
    }
    let (ratio, spread) = POST_YIELD;
    for (channel, mean, std) in [
        // As large as the motion: with a tenth of it, the first innovations of a record in motion are twice as large.
        (Channel::HYSTERETIC_DISPLACEMENT, 0.0, displacement),
        (Channel::POST_YIELD_RATIO, ratio, spread),
        (beta, 0.5 * shape, shape),
        (gamma, 0.0, shape),
    ] {
        begin_with(filter, channel, (rounded(mean), rounded(std)));
    }
    true
}

/// The points for each parameter, and for all of them at most.
const POINTS: (usize, usize) = (10, 48);

const SPRINGS: usize = 8;

/// Limits the spread that a filter begins with behind a search, in standard deviations of its end: the readings count again.
const WITHIN: f64 = 10.0;

const AGAIN: usize = 4;

/// The motion's process noise per step in a trial, as a share of its size: a parameter that is wrong must not stop the filter.
const SHARE: f64 = 1e-3;

const FROM_SPECTRA: [Channel; 2] = [Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO];

/// Prime numbers; their square roots spread points evenly in as many dimensions.
const PRIMES: [f64; 12] = [2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0, 23.0, 29.0, 31.0, 37.0];

pub(super) struct Search {
    kind: PlantKind,
    channels: Vec<Channel>,
    ranges: Vec<(f64, f64, f64)>,
    points: usize,
    ends: Likeliest<(Vec<(f64, f64)>, u32)>,
}

impl Search {
    /// Searches for parameters that spectra cannot give, or for each exponent of a Bouc-Wen spring, that of the scenario first.
    pub(super) fn all(suggestion: &Suggestion) -> Vec<Self> {
        let Scenario { plant, filters, .. } = &suggestion.scenario;
        let mut kinds = [PlantKind::BOUC_WEN, PlantKind::BOUC_WEN_1];
        let is_asked = kinds.contains(&plant.kind) && filters.iter().all(|filter| filter.plant.is_none());
        let Some(filter) = filters.first().filter(|_| is_asked) else {
            return Self::of(suggestion).into_iter().collect();
        };
        sort_items(&mut kinds, |a, b| (*a != plant.kind).cmp(&(*b != plant.kind)));
        let gain = filter.augment.contains(&Channel::INPUT_GAIN).then_some(Channel::INPUT_GAIN);
        let of = |kind: PlantKind| {
            let channels: Vec<Channel> = kind.parameters().chain(gain).collect();
            let mut search = Self { kind, channels, ranges: Vec::new(), points: SPRINGS, ends: Likeliest::new() };
            let mut scenario = suggestion.scenario.clone();
            search.set_kind(&mut scenario);
            let filter = &scenario.filters[0];
            let range = |channel: &Channel| {
                let (mean, std) = (filter.initial_mean[*channel], filter.initial_std[*channel]);
                let is_kept = FROM_SPECTRA.contains(channel) || gain == Some(*channel);
                let other = if mean == 0.0 { 0.5 } else { 0.0 };
                if is_kept { (0.0, 0.0, 0.0) } else { (0.25 * std.max(mean), 4.0 * std, other) }
            };
            search.ranges = mapped(&search.channels, &range);
            search
        };
        kinds.map(of).into()
    }

    fn of(suggestion: &Suggestion) -> Option<Self> {
        let (equation, channels) = suggestion.own_parameters()?;
        let filter = suggestion.scenario.filters.first()?;
        let kind = filter.plant.as_ref().unwrap_or(&suggestion.scenario.plant.kind);
        let settings = equation.settings();
        let range = |channel: &Channel| {
            let usual = channel.usual();
            if FROM_SPECTRA.contains(channel) && suggestion.problem.is_none() {
                let mean = filter.initial_mean[*channel];
                return (mean / 4.0, 4.0 * mean, 0.0);
            }
            let size = if usual.mean == 0.0 { usual.std } else { usual.mean.abs() }.max(f64::MIN_POSITIVE);
            let is_any = matches!(channel.role(), Role::Parameter(Sign::Any));
            let Some([low, high]) = settings.parameter(channel.key()).and_then(|one| one.range) else {
                return (size / 50.0, 50.0 * size, if is_any { 0.25 } else { 0.0 });
            };
            let most = low.abs().max(high.abs());
            (most / 200.0, most, if is_any && low < 0.0 && high > 0.0 { 0.25 } else { 0.0 })
        };
        let points = (POINTS.0 * channels.len()).min(POINTS.1);
        let ranges = mapped(&channels, &range);
        Some(Self { kind: kind.clone(), channels, ranges, points, ends: Likeliest::new() })
    }

    pub(super) async fn run(&mut self, of: &Scenario, record: &Record, samples: usize, progress: impl Fn(f64)) {
        while self.ends.trials < self.points + if self.ends.best.is_some() { AGAIN } else { 0 } {
            progress(self.ends.trials as f64 / (self.points + AGAIN) as f64);
            let run = tried(&self.scenario(of), record, samples).await;
            let found = run.and_then(|run| Some((self.ends_of(&run)?, likelihood_over(&run, 1..run.samples())?)));
            let (point, likelihood) =
                found.map(|(ends, (likelihood, readings))| ((ends, readings), likelihood)).unzip();
            self.ends.take(point.unwrap_or_default(), likelihood, 0.0);
        }
    }

    fn scenario(&self, of: &Scenario) -> Scenario {
        let mut scenario = first_alone(of);
        self.set_kind(&mut scenario);
        for filter in &mut scenario.filters {
            filter.kind = FilterKind::EKF;
            for (place, &channel) in self.channels.iter().enumerate() {
                let guess = (filter.initial_mean[channel], filter.initial_std[channel]);
                begin_with(filter, channel, self.start(place, guess));
            }
        }
        set_share(&mut scenario, SHARE);
        scenario
    }

    fn set_kind(&self, scenario: &mut Scenario) {
        if self.kind.own_equation().is_some() || scenario.plant.kind == self.kind {
            return;
        }
        scenario.set_plant(self.kind.clone());
        for filter in &mut scenario.filters {
            start_yielding(filter, &self.kind, scenario.input, filter.initial_std[Channel::DISPLACEMENT]);
        }
    }

    fn start(&self, place: usize, guess: (f64, f64)) -> (f64, f64) {
        let (low, high, other) = self.ranges[place];
        if let Some(((ends, _), _)) = self.ends.best.as_ref().filter(|_| self.ends.trials >= self.points) {
            let (mean, std) = ends[place];
            return (mean, (0.3 * mean.abs()).max(2.0 * std).max(1e-3 * low));
        }
        if self.ends.trials == 0 || high == 0.0 {
            return guess;
        }
        let root = libm::sqrt(PRIMES[place % PRIMES.len()]);
        let along = (0.5 + self.ends.trials as f64 * root).fract();
        let is_other = along < other;
        let along = if is_other { along / other } else { (along - other) / (1.0 - other) };
        let size = low * libm::pow(high / low, along);
        let is_negative = (guess.0 < 0.0) != is_other;
        (if is_negative { -size } else { size }, 0.5 * size)
    }

    fn ends_of(&self, run: &Run) -> Option<Vec<(f64, f64)>> {
        let estimates = run.estimates().first()?;
        let last = estimates.len().checked_sub(1)?;
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
        self.channels.iter().map(end).collect()
    }

    pub(super) fn give_up(self, suggestion: &mut Suggestion) {
        suggestion.reasons.push(format!(
            "{} begin with the guesses of the equation: without an input no start values of its parameters are searched",
            self.names()
        ));
    }

    fn names(&self) -> String {
        mapped(&self.channels, &|channel| channel.symbol()).join(", ")
    }

    pub(super) fn choose(mut searches: Vec<Self>, suggestion: &mut Suggestion) {
        let of = |search: &Self| search.ends.best.as_ref().map(|((_, readings), likelihood)| (*readings, *likelihood));
        // Likelihoods of unlike numbers of readings say nothing about each other.
        let readings = searches.iter().find_map(of).map(|(readings, _)| readings);
        let likelihood = |search: &Self| of(search).filter(|(count, _)| Some(*count) == readings).map(|(_, now)| now);
        let size = |search: &Self| likelihood(search).unwrap_or(f64::NEG_INFINITY);
        sort_items(&mut searches, |a, b| size(b).total_cmp(&size(a)));
        if let [first, second] = searches.as_slice()
            && let (Some(one), Some(other)) = (likelihood(first), likelihood(second))
        {
            suggestion.reasons.push(format!(
                "the plant is `{}`, the likelier exponent of Bouc and Wen: by {:.0} in log likelihood before `{}`",
                first.kind.key(),
                one - other,
                second.kind.key()
            ));
        }
        searches.into_iter().take(1).for_each(|search| search.finish(suggestion));
    }

    fn finish(self, suggestion: &mut Suggestion) {
        let names = self.names();
        self.set_kind(&mut suggestion.scenario);
        let Self { channels, ends: Likeliest { best, trials }, points, .. } = self;
        let Some(((ends, _), _)) = best else {
            suggestion.reasons.push(format!(
                "no start values of {names} could be found: the filter fails from each of {points} points, and begins \
                 with the guesses of the equation"
            ));
            return;
        };
        let mut guesses = Vec::new();
        for (&channel, (mean, std)) in channels.iter().zip(ends) {
            let (mean, std) = (rounded(mean), rounded((0.2 * mean.abs()).min(WITHIN * std).max(3.0 * std)));
            let unit = suggestion.unit(channel.unit());
            guesses.push(format!("{} {mean} {unit}", channel.symbol()).trim_end().to_owned());
            suggestion.simulate_with(channel, mean);
            suggestion.filters().for_each(|filter| begin_with(filter, channel, (mean, std)));
        }
        suggestion.reasons.push(format!(
            "guess of the equation's parameters: {}, the end of the likeliest of {trials} runs of a filter; their \
             spread is a fifth of it, but from three to {WITHIN} of the filter's σ",
            guesses.join(", ")
        ));
    }
}
