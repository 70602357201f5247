//! Start values of filters from a record's data.
//!
//! ```text
//! spectra ──▶ R of each sensor, ωₙ, ζ and gain ──▶ initial belief ──likelihood──▶ Q
//! ```

mod ambient;
mod conditioning;
mod forced;
mod initial;
mod likeliest;
mod response;
mod spectra;
mod trials;

use kalmanscope_filters::channel::MAX_MASSES;
use kalmanscope_filters::lists::mapped;
use kalmanscope_filters::{Channel, FilterKind, Propagation, Quantity};
use kalmanscope_records::length::Length;
use kalmanscope_records::{Record, Task as _};
use serde::{Deserialize, Serialize};

use crate::scenario::cost::steps_over;
use crate::{FilterSettings, Scenario, Sensor, Signal};
use ambient::has_no_input;
use conditioning::LostReadings;
use forced::forced;
use likeliest::first_alone;
use response::{DecayFit, decay, free_response, response};
use spectra::{GapTreatment, Spectra, noise};
use trials::SHARES;

pub use trials::begin;

/// Settings for a record, with the reason of each.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Suggestion {
    /// The scenario with the suggested settings in every filter.
    pub scenario: Scenario,
    /// The reasons, one sentence each.
    pub reasons: Vec<String>,
    /// Why no guess of the motion's frequency was found, where a filter wants one: the guess is a default then.
    pub problem: Option<String>,
    #[serde(skip)]
    replaceable: Vec<String>,
}

/// A new scenario for a measured record: an EKF and a UKF that forget nothing, with a sensor for each of the record's.
pub fn scenario_for(record: &Record) -> Scenario {
    let sensors = record.sensors().iter().map(|&measures| Sensor::new(measures, measures.aspect().info().usual_noise));
    let filter = |kind: FilterKind| FilterSettings {
        kind,
        name: kind.name().to_owned(),
        sensor_std: mapped(record.sensors(), &|quantity| quantity.aspect().info().usual_noise),
        ..FilterSettings::default()
    };
    let mut scenario = Scenario {
        dt: record.dt(),
        duration: record.dt() * record.len().saturating_sub(1).max(1) as f64,
        input: record.input_kind(),
        hold: record.hold(),
        sensors: sensors.collect(),
        filters: vec![filter(FilterKind::EKF), filter(FilterKind::UKF)],
        ..Scenario::default()
    };
    scenario.number_filters();
    scenario
}

/// An import that lets this share of the frequencies through has no filter.
const WHOLE: f64 = 0.99;

/// A free run is better if its error is at most this share of the other's.
const BETTER: f64 = 0.8;

/// With fewer periods in a record, the windows of its spectra have too few each: the readings themselves are fitted.
const COARSE: f64 = 60.0;

/// Suggests settings for a scenario's filters on a measured record, in one go: see [`begin`].
pub fn suggest(scenario: &Scenario, record: &Record) -> Suggestion {
    begin(scenario, record.clone()).run()
}

impl Suggestion {
    fn simulate_with(&mut self, channel: Channel, value: f64) {
        if self.scenario.plant.parameter(channel).is_some() {
            self.scenario.plant.set(channel, Signal::Constant(value));
        }
    }

    fn unit(&self, unit: &'static str) -> &'static str {
        Length::of(self.scenario.record.as_ref()).in_place_of(unit)
    }

    fn filters(&mut self) -> impl Iterator<Item = &mut FilterSettings> {
        self.scenario.filters.iter_mut()
    }

    fn sensor_noise(&mut self, record: &Record, lost: Option<&LostReadings>) {
        for place in 0..self.scenario.sensors.len() {
            let measures = self.scenario.sensors[place].measures;
            let Some(column) = measures.place_in(record.sensors()) else { continue };
            let measured = record.measured(column);
            let spectra = Spectra::new(record, measured, spectra::SHORT, GapTreatment::Avoid);
            let floor = spectra.and_then(|spectra| spectra.noise(self.scenario.record.as_ref()));
            // A filled reading adds no noise.
            let floor =
                floor.map(|noise| noise / libm::sqrt(lost.map_or(1.0, |lost| lost.there(column, record.len()))));
            // Where readings were moved to samples, so was a part of the motion: what is less is the sensor's.
            let own = record.clocks().and_then(|clocks| noise(&clocks.readings[column]));
            let own = own.filter(|own| floor.is_none_or(|floor| *own < floor));
            let why = if own.is_some() {
                "from differences of successive readings, in which the motion nearly cancels"
            } else {
                "the noise at the highest frequencies, where the input explains nothing"
            };
            let noise = own.or(floor).map(|noise| noise.max(1e-6 * moments(measured).1));
            noise.filter(|noise| *noise > 0.0).into_iter().for_each(|noise| self.set_noise(place, rounded(noise), why));
        }
    }

    fn set_noise(&mut self, place: usize, noise: f64, why: &str) {
        let sensor = &mut self.scenario.sensors[place];
        sensor.noise_std = noise;
        let measures = sensor.measures;
        self.filters().filter_map(|filter| filter.sensor_std.get_mut(place)).for_each(|std| *std = noise);
        let unit = self.unit(measures.unit());
        self.replaceable[place] = format!("R of the {}: {noise} {unit}, {why}", measures.name());
    }

    fn resize_noise(&mut self, sizes: &[f64]) {
        let why = "the size of the innovations, likelier than the noise at the highest frequencies";
        for (place, size) in sizes.iter().enumerate().take(self.scenario.sensors.len()) {
            self.set_noise(place, rounded(size * self.scenario.sensors[place].noise_std), why);
        }
    }

    /// Guess and spread of ωₙ, ζ and gain, of an input that has some steps in place of each of the record's. Returns whether noise is all that a decay leaves; `None` if the motion is no decay.
    fn motion(&mut self, record: &mut Record, steps: usize) -> Option<bool> {
        let (quantity, measured) = motion_sensor(record)?;
        let mapping = self.scenario.record.as_ref();
        let band = mapping.and_then(|mapping| mapping.band);
        if !self.has_frequency() {
            let found = free_response(record, measured, band).filter(|_| self.own_parameters().is_some())?;
            self.expect_motion(record, quantity, found.natural_frequency, MAX_MASSES);
            return None;
        }
        let by_spectra = response(record, quantity, band, steps);
        let mut best = (by_spectra, "fitted to the response to the input over frequency");
        let span = record.dt() * record.len() as f64 / std::f64::consts::TAU;
        let mut free = None;
        if has_no_input(record) {
            // A decay that is over before the window is leaves a peak whose width says little of ζ.
            free = decay(record, measured, mapping);
            best = (free.map(|free| free.found), "fitted to the readings as a free decay");
        } else if by_spectra.is_none_or(|found| found.natural_frequency * span < COARSE) {
            let finer = if steps > 1 { record.finer(steps) } else { None };
            if let found @ Some(_) = forced(finer.as_ref().unwrap_or(record), quantity, band, by_spectra.as_ref()) {
                best = (found, "fitted to the readings over time as a motion that the input causes");
            }
        }
        if best.0.is_none() {
            best = (free_response(record, measured, band), "the peak of the spectrum and its width at half the power");
        }
        let (Some(found), reason) = best else {
            self.problem = Some(no_motion(quantity, measured));
            return None;
        };
        self.begin_at(record, quantity, &found, reason);
        if let Some(free) = &free {
            self.begin_as_large(quantity, free);
            self.noise_beside(quantity, free, record.dt());
        }
        free.map(|free| free.is_all)
    }

    fn noise_beside(&mut self, quantity: Quantity, decay: &DecayFit, dt: f64) {
        let place = self.scenario.sensor_place(quantity);
        let Some(place) = place.filter(|_| decay.is_all && decay.rest > 0.0) else { return };
        let [low, high] = spectra::passed(self.scenario.record.as_ref(), dt);
        let (share, mut nearby, mut why) = (high - low, 1.0, "the rest beside the free decay".to_owned());
        if share <= WHOLE {
            // Where a filter of the import has been, noise has colours, and its density about the decay counts.
            nearby = decay.nearby.max(1.0);
            why = format!(
                "{why}, with its density in the band; innovations have {:.0} % of its power, which is harmless",
                100.0 * share / nearby
            );
        }
        self.set_noise(place, rounded(decay.rest * libm::sqrt(nearby / share)), &why);
    }

    fn has_frequency(&self) -> bool {
        let Scenario { plant, input, filters, .. } = &self.scenario;
        filters.iter().any(|filter| filter.model(&plant.kind, *input).place(Channel::NATURAL_FREQUENCY).is_some())
    }

    /// Divides predictions over a large part of a period: local linearisation takes the Jacobian for constant over a step.
    fn substeps(&mut self, dt: f64, expected: Option<f64>) {
        let (kind, input) = (self.scenario.plant.kind.clone(), self.scenario.input);
        let mut most = 1;
        for filter in self.filters() {
            let model = filter.model(&kind, input);
            if model.place(Channel::NATURAL_FREQUENCY).is_none() {
                continue;
            }
            let is_exact = model.is_linear()
                && filter.kind.info().has_propagation
                && filter.propagation_for(&kind) == Propagation::LocalLinearisation;
            let frequency = filter.initial_mean[Channel::NATURAL_FREQUENCY].abs();
            let guess = filter.initial_std[Channel::NATURAL_FREQUENCY] / (initial::LOOSE * frequency);
            let knows_all = guess == 0.0 && filter.process_std[Channel::NATURAL_FREQUENCY] == 0.0;
            let expected = expected.unwrap_or(guess);
            let swing = frequency * dt;
            let turn = if model.is_linear() { swing } else { swing.max(filter.turn(&model, dt)) };
            let steps = steps_over(turn, Some(expected).filter(|expected| *expected > 0.0 && !is_exact));
            filter.substeps = if is_exact && knows_all || steps == 1 { 0 } else { steps };
            most = most.max(filter.steps(&kind, input, dt));
        }
        if let Some(last) = self.replaceable.last_mut() {
            let why = "substeps per sample, because there are few samples in a period";
            *last = if most > 1 { format!("{most} {why}") } else { String::new() };
        }
    }

    fn with_share(&self, share: f64) -> Scenario {
        let mut scenario = first_for_trial(&self.scenario);
        set_share(&mut scenario, share);
        scenario
    }

    fn process_noise(&mut self, share: f64) {
        set_share(&mut self.scenario, share);
        let (part, trials) = (if share == 0.0 { "nothing".to_owned() } else { format!("{share:e}") }, SHARES.len());
        self.reasons.push(format!("Q of the motion: {part} of its size a step, the likeliest of {trials} trials"));
    }

    /// Once nothing moves any more, rounding makes a covariance without process noise singular.
    fn keep_from_rounding(&mut self) {
        let (kind, input) = (self.scenario.plant.kind.clone(), self.scenario.input);
        let is_without = |filter: &FilterSettings| {
            let model = filter.model(&kind, input);
            model.channels()[..model.motion()].iter().all(|channel| filter.process_std[*channel] == 0.0)
        };
        let share = SHARES[1];
        if self.scenario.filters.first().is_some_and(is_without) {
            set_share(&mut self.scenario, share);
            self.reasons.push(format!(
                "Q of the motion: {share:e} of its size a step after all, because the filter stops by rounding without any"
            ));
        }
    }

    fn with_error(&self, errors: &[f64]) -> Scenario {
        let mut other = self.scenario.clone();
        for filter in &mut other.filters {
            for (std, error) in filter.sensor_std.iter_mut().zip(errors) {
                *std = rounded(error.max(*std));
            }
        }
        set_share(&mut other, 0.0);
        other
    }

    /// R takes the size of the model's error if the free run is better with it, and no single sample counts too much.
    fn model_error(&mut self, before: &[f64], after: &[f64], surprise: f64) {
        let ratio = |(after, before): (&f64, &f64)| if *before > 0.0 { after / before } else { 1.0 };
        let mean = after.iter().zip(before).map(ratio).sum::<f64>() / after.len().max(1) as f64;
        if mean > BETTER {
            return;
        }
        let errors: Vec<f64> = mapped(before, &|error| surprise * error);
        self.scenario = self.with_error(&errors);
        self.reasons.push(format!(
            "R as large as the errors of a free run, and no Q of the motion: the model is not quite right, and the \
             error of its free run is {:.0} % smaller then",
            100.0 * (1.0 - mean)
        ));
    }
}

fn set_share(scenario: &mut Scenario, share: f64) {
    for filter in &mut scenario.filters {
        let model = filter.model(&scenario.plant.kind, scenario.input);
        for &channel in &model.channels()[..model.motion()] {
            filter.process_std[channel] = rounded(share * filter.initial_std[channel].abs());
        }
    }
}

fn augment(filter: &mut FilterSettings, channel: Channel, start: (f64, f64)) {
    if !filter.augment.contains(&channel) {
        filter.augment.push(channel);
    }
    begin_with(filter, channel, start);
}

fn begin_with(filter: &mut FilterSettings, channel: Channel, (mean, std): (f64, f64)) {
    (filter.initial_mean[channel], filter.initial_std[channel], filter.process_std[channel]) = (mean, std, 0.0);
}

/// An EKF in place of a filter that draws samples, whose likelihood varies by chance: trials are compared by it.
fn first_for_trial(scenario: &Scenario) -> Scenario {
    let mut scenario = first_alone(scenario);
    for filter in scenario.filters.iter_mut().filter(|filter| filter.kind.is_sampled()) {
        filter.kind = FilterKind::EKF;
    }
    scenario
}

fn motion_sensor(record: &Record) -> Option<(Quantity, &[f64])> {
    let wanted = [Quantity::DISPLACEMENT, Quantity::VELOCITY, Quantity::ACCELERATION, Quantity::TOTAL_ACCELERATION];
    wanted.iter().find_map(|&quantity| Some((quantity, record.measured_quantity(quantity)?)))
}

fn no_motion(quantity: Quantity, measured: &[f64]) -> String {
    let name = quantity.name();
    let there = measured.iter().filter(|value| !value.is_nan()).count();
    let why = if there < spectra::LEAST {
        format!("{there} readings of the {name} are too few")
    } else if 4 * there < 3 * measured.len() {
        format!("too many readings of the {name} are missing: {} of {}", measured.len() - there, measured.len())
    } else {
        format!("the spectrum of the {name} has no peak")
    };
    format!("no start values of ωₙ and ζ could be found, because {why}: the guess is a default, please set it by hand")
}

fn moments(values: &[f64]) -> (f64, f64) {
    let there = || values.iter().filter(|value| !value.is_nan());
    let count = there().count().max(1) as f64;
    let mean = there().sum::<f64>() / count;
    let variance = there().map(|value| (value - mean) * (value - mean)).sum::<f64>() / count;
    (mean, libm::sqrt(variance))
}

fn rounded(value: f64) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value;
    }
    let digits = libm::floor(libm::log10(value.abs())) - 3.0;
    let unit = libm::pow(10.0, digits.abs());
    // Divided by a power of ten, which is exact: times 0.001 or the like would leave digits of rounding.
    if digits < 0.0 { libm::round(value * unit) / unit } else { libm::round(value / unit) * unit }
}
