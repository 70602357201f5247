//! Start values of filters from a record's data.
//!
//! ```text
//! spectra ──▶ R of each sensor, ωₙ, ζ and gain ──▶ initial belief ──likelihood──▶ Q
//! ```

mod conditioning;
mod response;
mod spectra;
mod trials;

use serde::{Deserialize, Serialize};

use crate::{
    Channel, FilterKind, FilterSettings, InSlices as _, InputKind, PlantKind, Quantity, Record, Scenario, Sensor,
    Signal,
};

use response::{Response, free_response, order, response};
use spectra::{Gaps, Spectra};
use trials::{SHARES, first_alone};

pub use trials::Suggest;

/// Settings for a record, with the reason of each.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Suggestion {
    /// The scenario with the suggested settings in every filter.
    pub scenario: Scenario,
    /// The reasons, one sentence each.
    pub reasons: Vec<String>,
    /// Whether a guess of the motion's frequency was found, where a filter wants one. Without it the guess is a default.
    pub is_guessed: bool,
}

/// A new scenario for a measured record: an EKF and a UKF that forget nothing, with a sensor for each of the record's.
pub fn scenario_for(record: &Record) -> Scenario {
    let sensors =
        record.sensors().iter().map(|&measures| Sensor { measures, noise_std: measures.aspect().info().usual_noise });
    let filter = |kind: FilterKind| FilterSettings {
        kind,
        name: kind.name().to_owned(),
        sensor_std: record.sensors().iter().map(|quantity| quantity.aspect().info().usual_noise).collect(),
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

/// A free run is better if its error is at most this share of the other's.
const BETTER: f64 = 0.8;

/// Suggests settings for a scenario's filters on a measured record, in one go: see [`Suggest`].
pub fn suggest(scenario: &Scenario, record: &Record) -> Suggestion {
    let mut suggest = Suggest::new(scenario, record.clone());
    while !suggest.advance(&mut || true) {}
    suggest.finish()
}

/// The beginning of the reason why there is no guess.
const NO_GUESS: &str = "no start values of ωₙ and ζ could be found, because";

impl Suggestion {
    /// Why no guess of the motion's frequency was found; `None` where there is one.
    pub fn why_no_guess(&self) -> Option<&str> {
        let reason = self.reasons.iter().find(|reason| reason.starts_with(NO_GUESS));
        reason.filter(|_| !self.is_guessed).map(String::as_str)
    }

    fn filters(&mut self) -> impl Iterator<Item = &mut FilterSettings> {
        self.scenario.filters.iter_mut()
    }

    /// R from the part of the spectrum at high frequencies that the input does not explain.
    fn sensor_noise(&mut self, record: &Record) {
        for (place, sensor) in self.scenario.sensors.clone().into_iter().enumerate() {
            let Some(measured) = record.measured_quantity(sensor.measures) else { continue };
            let Some(noise) =
                Spectra::new(record, measured, spectra::SHORT, Gaps::Avoid).and_then(|spectra| spectra.noise())
            else {
                continue;
            };
            let (_, std) = moments(measured);
            let noise = rounded(noise.max(1e-6 * std));
            if noise <= 0.0 {
                continue;
            }
            self.scenario.sensors[place].noise_std = noise;
            for filter in self.scenario.filters.iter_mut().filter(|filter| place < filter.sensor_std.len()) {
                filter.sensor_std[place] = noise;
            }
            let (name, unit) = (sensor.measures.name(), sensor.measures.unit());
            self.reasons.push(format!(
                "R of the {name}: {noise} {unit}, the noise at the highest frequencies, where the input explains nothing"
            ));
        }
    }

    /// Guess and spread of ωₙ, ζ and gain.
    fn motion(&mut self, record: &mut Record) {
        let has = |filter: &FilterSettings| {
            filter.model(self.scenario.plant.kind, self.scenario.input).place(Channel::NATURAL_FREQUENCY).is_some()
        };
        if !self.scenario.filters.iter().any(has) {
            return;
        }
        let wanted = [Quantity::DISPLACEMENT, Quantity::VELOCITY, Quantity::ACCELERATION, Quantity::TOTAL_ACCELERATION];
        let Some((quantity, measured)) = wanted.iter().find_map(|&q| Some((q, record.measured_quantity(q)?))) else {
            return;
        };
        let band = self.scenario.record.as_ref().and_then(|mapping| mapping.band);
        let driven = response(record, quantity, measured, band);
        let found = driven.clone().or_else(|| free_response(record, measured, band));
        let Some(Response { natural_frequency, damping_ratio, gain }) = found else {
            self.reasons.push(no_motion(quantity, measured));
            self.is_guessed = false;
            return;
        };
        let (wn, zeta) = (rounded(natural_frequency), rounded(damping_ratio));
        let reason = if driven.is_some() {
            "fitted to the response to the input over frequency"
        } else {
            "the peak of the spectrum and its width at half the power"
        };
        let hertz = rounded(wn / std::f64::consts::TAU);
        self.reasons.push(format!("guess of ωₙ: {wn} rad/s ({hertz} Hz) and of ζ: {zeta}, {reason}"));
        for (channel, value) in [(Channel::NATURAL_FREQUENCY, wn), (Channel::DAMPING_RATIO, zeta)] {
            // The truth of a measured record is not known: this is what a simulation in its place begins with.
            if self.scenario.plant.parameter(channel).is_some() {
                self.scenario.plant.set(channel, Signal::Constant(value));
            }
        }
        self.gain(record, gain);
        let measured = record.measured_quantity(quantity).unwrap_or_default();
        let (_, size) = moments(measured);
        let order = order(quantity);
        let displacement = size / libm::pow(natural_frequency, f64::from(order));
        let first = measured.iter().copied().find(|value| !value.is_nan()).filter(|_| order == 0).unwrap_or(0.0);
        for filter in self.filters() {
            let std = |value: f64| rounded(value.max(f64::MIN_POSITIVE));
            let mean = [
                (Channel::DISPLACEMENT, rounded(first)),
                (Channel::VELOCITY, 0.0),
                (Channel::NATURAL_FREQUENCY, wn),
                (Channel::DAMPING_RATIO, zeta),
                (Channel::CUBIC_STIFFNESS, 0.0),
            ];
            let spread = [
                (Channel::DISPLACEMENT, std(displacement)),
                (Channel::VELOCITY, std(displacement * natural_frequency)),
                (Channel::NATURAL_FREQUENCY, std(0.1 * natural_frequency)),
                (Channel::DAMPING_RATIO, std((0.5 * damping_ratio).max(0.01))),
                (Channel::CUBIC_STIFFNESS, std(cubic_scale(natural_frequency, measured, order))),
            ];
            for (channel, value) in mean {
                filter.initial_mean[channel] = value;
            }
            for (channel, value) in spread {
                filter.initial_std[channel] = value;
            }
            for (channel, _) in spread.iter().skip(2) {
                filter.process_std[*channel] = 0.0;
            }
        }
        self.reasons.push("initial spread: a tenth of ωₙ, half of ζ, and the size of the motion itself".to_owned());
    }

    /// A gain that is far from 1 goes into the mapping; the filters estimate what is left of it.
    fn gain(&mut self, record: &mut Record, gain: Option<f64>) {
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
            if !filter.augment.contains(&Channel::INPUT_GAIN) {
                filter.augment.push(Channel::INPUT_GAIN);
            }
            let mean = if is_mapped { 1.0 } else { gain };
            if !is_mapped && filter.augment.contains(&Channel::INPUT_OFFSET) {
                // The offset is that of the true input, whose gain is not yet known well.
                let offset = mean * filter.initial_mean[Channel::INPUT_OFFSET];
                filter.initial_mean[Channel::INPUT_OFFSET] = offset;
                filter.initial_std[Channel::INPUT_OFFSET] = rounded(0.2 * offset.abs());
            }
            filter.initial_mean[Channel::INPUT_GAIN] = mean;
            filter.initial_std[Channel::INPUT_GAIN] = rounded(0.2 * mean.abs());
            filter.process_std[Channel::INPUT_GAIN] = 0.0;
        }
    }

    /// A prediction over a large part of a period is divided, unless it is exact.
    fn substeps(&mut self, record: &Record) {
        /// The angle by which an oscillator should turn at most in one step \[rad\].
        const MOST: f64 = 0.2;
        let (kind, input) = (self.scenario.plant.kind, self.scenario.input);
        let mut most = 1;
        for filter in self.filters() {
            let model = filter.model(kind, input);
            if model.place(Channel::NATURAL_FREQUENCY).is_none() {
                continue;
            }
            let is_exact =
                model.is_linear() && [FilterKind::KF, FilterKind::EKF, FilterKind::IEKF].contains(&filter.kind);
            let turn = filter.initial_mean[Channel::NATURAL_FREQUENCY].abs() * record.dt();
            filter.substeps = if is_exact { 1 } else { libm::ceil(turn / MOST).clamp(1.0, 20.0) as usize };
            most = most.max(filter.substeps);
        }
        if most > 1 {
            self.reasons.push(format!("{most} steps a sample, because there are few samples in a period"));
        }
    }

    /// The first filter alone, with a share of the motion's size as its process noise per step.
    fn with_share(&self, share: f64) -> Scenario {
        let mut scenario = first_alone(&self.scenario);
        let (kind, input) = (scenario.plant.kind, scenario.input);
        for filter in &mut scenario.filters {
            set_share(filter, kind, input, share);
            if filter.kind.is_sampled() {
                filter.kind = FilterKind::EKF;
            }
        }
        scenario
    }

    /// Q of the motion, the most likely share of its size.
    fn process_noise(&mut self, share: f64) {
        let (kind, input) = (self.scenario.plant.kind, self.scenario.input);
        self.filters().for_each(|filter| set_share(filter, kind, input, share));
        self.reasons.push(format!(
            "Q of the motion: {} of its size a step, the most likely of {} that were tried",
            if share == 0.0 { "nothing".to_owned() } else { format!("{share:e}") },
            SHARES.len()
        ));
    }

    /// The scenario with R of the size of these errors, and no process noise of the motion.
    fn with_error(&self, errors: &[f64]) -> Scenario {
        let mut other = self.scenario.clone();
        let (kind, input) = (other.plant.kind, other.input);
        for filter in &mut other.filters {
            for (std, error) in filter.sensor_std.iter_mut().zip(errors) {
                *std = rounded(error.max(*std));
            }
            set_share(filter, kind, input, 0.0);
        }
        other
    }

    /// A model that is not quite right errs in ways that no noise does. If the free run is better for it, R takes the size of
    /// that error, and no single sample counts too much.
    fn model_error(&mut self, before: &[f64], after: &[f64], surprise: f64) {
        let ratio = |(after, before): (&f64, &f64)| if *before > 0.0 { after / before } else { 1.0 };
        let mean = after.iter().zip(before).map(ratio).sum::<f64>() / after.len().max(1) as f64;
        if mean > BETTER {
            return;
        }
        // The innovations then tell how large it is.
        let errors: Vec<f64> = before.iter().map(|error| surprise * error).collect();
        self.scenario = self.with_error(&errors);
        self.reasons.push(format!(
            "R as large as the innovations of a filter that takes the error of its free run for noise, and no Q of the motion: the model is not quite right, and its \
             free run then errs {:.0} % less",
            100.0 * (1.0 - mean)
        ));
    }
}

/// Makes the process noise of the motion a share of its size, which is that of the initial spread.
fn set_share(filter: &mut FilterSettings, kind: PlantKind, input: InputKind, share: f64) {
    let model = filter.model(kind, input);
    for &channel in &model.channels()[..model.motion()] {
        filter.process_std[channel] = rounded(share * filter.initial_std[channel].abs());
    }
}

/// Why there is no guess of frequency and damping.
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
    format!("{NO_GUESS} {why}: the guess is a default, please set it by hand")
}

/// A cubic stiffness that carries half of the load at the largest displacement.
fn cubic_scale(natural_frequency: f64, measured: &[f64], order: i32) -> f64 {
    let most = measured.iter().filter(|value| !value.is_nan()).fold(0.0_f64, |most, value| most.max(value.abs()));
    let displacement = most / libm::pow(natural_frequency, f64::from(order));
    if displacement > 0.0 { 0.5 * natural_frequency * natural_frequency / (displacement * displacement) } else { 1.0 }
}

/// Mean and standard deviation of the values that are there.
fn moments(values: &[f64]) -> (f64, f64) {
    let there = || values.iter().filter(|value| !value.is_nan());
    let count = there().count().max(1) as f64;
    let mean = there().sum::<f64>() / count;
    let variance = there().map(|value| (value - mean) * (value - mean)).sum::<f64>() / count;
    (mean, libm::sqrt(variance))
}

/// Rounded to three digits, as one would write it.
fn rounded(value: f64) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value;
    }
    let digits = libm::floor(libm::log10(value.abs())) - 3.0;
    let unit = libm::pow(10.0, digits.abs());
    if digits < 0.0 { libm::round(value * unit) / unit } else { libm::round(value / unit) * unit }
}
