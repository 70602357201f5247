//! Records without an input: a white force moves the plant, and its size is one more thing to be found. An oscillator under such a force
//! is fitted to the spectrum of one sensor.

use super::likeliest::Climb;
use super::response::{Response, free_response, is_within, order};
use super::spectra::{Gaps, LONG, Spectra};
use super::{Suggestion, augment, first_for_trial, moments, motion_sensor, rounded};
use crate::data::sorting::sort_numbers;
use crate::mathematics::least_squares::{NormalEquations, descend};
use crate::{Channel, Hold, Quantity, Record, Scenario};

/// The white force of a record without an input, and the noise of the scenario's sensors, before they are tried.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sizes {
    /// s \[m/s²\]
    force: f64,
    /// In the sensors' order and units.
    noise: Vec<f64>,
    /// The course of the force from sample to sample.
    hold: Hold,
}

impl Sizes {
    /// These factors on the force and on the noise of each sensor.
    fn times(&self, factors: &[f64]) -> Self {
        let noise = self.noise.iter().zip(&factors[1..]).map(|(noise, by)| rounded(noise * by)).collect();
        Self { force: rounded(self.force * factors[0]), noise, ..*self }
    }

    /// The same with a force that is held from its sample to the next.
    fn held(&self) -> Self {
        Self { hold: Hold::Zero, ..self.clone() }
    }
}

/// Whether a record has no input: one that does not change moves nothing.
pub(super) fn has_no_input(record: &Record) -> bool {
    record.input().windows(2).all(|pair| pair[0] == pair[1])
}

/// The trials of a white force.
pub(super) struct Ambient {
    pub(super) suggestion: Suggestion,
    /// The sizes that factors of the climb multiply.
    sizes: Sizes,
    pub(super) climb: Climb,
    /// The sensors that its filters do without.
    left_out: Vec<Quantity>,
    /// The best of the climb with a force that is held: its log likelihood, if it has one. None before it was tried.
    held: Option<Option<f64>>,
}

impl Ambient {
    /// The start values for a record without an input, from a suggestion without noise. `None` if the spectrum shows no
    /// oscillator.
    pub(super) fn new(mut suggestion: Suggestion, record: &mut Record) -> Option<Self> {
        let left_out = suggestion.felt_twice();
        left_out.iter().for_each(|quantity| suggestion.scenario.remove_sensor(*quantity));
        let sizes = suggestion.ambient(record)?;
        suggestion.is_guessed = true;
        suggestion.substeps(record.dt());
        let climb = Climb::new(1 + suggestion.scenario.sensors.len());
        Some(Self { suggestion, sizes, climb, left_out, held: None })
    }

    /// Takes the sensors out of a scenario that filters of the white force do without: likelihoods compare on equal readings.
    pub(super) fn leave_out(&self, scenario: &mut Scenario) {
        self.left_out.iter().for_each(|quantity| scenario.remove_sensor(*quantity));
    }

    /// The sizes of the next trial: those of the climb, then its best with a force that is held.
    pub(super) fn next(&self) -> Option<Sizes> {
        let Self { sizes, climb, held, .. } = self;
        let of_climb = || climb.next().map(|factors| sizes.times(&factors));
        let last =
            || climb.found.best.as_ref().filter(|_| held.is_none()).map(|(factors, _)| sizes.times(factors).held());
        of_climb().or_else(last)
    }

    /// Takes in the log likelihood of the last trial, if there is one.
    pub(super) fn take(&mut self, likelihood: Option<f64>) {
        if self.climb.next().is_some() {
            self.climb.take(likelihood);
        } else {
            self.held = Some(likelihood);
        }
    }

    /// The best sizes and their log likelihood.
    pub(super) fn best(&self) -> Option<(Sizes, f64)> {
        let (factors, likelihood) = self.climb.found.best.as_ref()?;
        let sizes = self.sizes.times(factors);
        let held = self.held.flatten().filter(|held| held > likelihood);
        Some(held.map_or_else(|| (sizes.clone(), *likelihood), |held| (sizes.held(), held)))
    }
}

impl Suggestion {
    /// The accelerometers beside a displacement or a velocity. One sensor gives ωₙ and ζ of an oscillator under an
    /// unknown force as well as both do. Together they also show the force's course between samples, which no filter
    /// can model exactly: an error of that course, or of the accelerometer's delay, then looks like an error of ζ.
    fn felt_twice(&mut self) -> Vec<Quantity> {
        let sensors = || self.scenario.sensors.iter().map(|sensor| sensor.measures);
        let is_other = sensors().any(|quantity| order(quantity) < 2);
        let left_out: Vec<Quantity> = sensors().filter(|quantity| is_other && order(*quantity) == 2).collect();
        for quantity in &left_out {
            self.reasons.push(format!(
                "the filters do without the {}: without a recorded force it tells nothing of ωₙ and ζ that the other sensor does \
                 not, and the course of the force between samples, which is not known, would count as damping",
                quantity.name()
            ));
        }
        left_out
    }

    /// The start values of filters that assume a white force as the input, and the first guess of its size. `None` if
    /// no filter has a frequency, or the spectrum shows none.
    fn ambient(&mut self, record: &mut Record) -> Option<Sizes> {
        if !self.has_frequency() {
            return None;
        }
        let (quantity, _) = motion_sensor(record)?;
        let band = self.scenario.record.as_ref().and_then(|mapping| mapping.band);
        let fit = ambient_fit(record, quantity, band)?;
        let AmbientFit { natural_frequency, damping_ratio, force, noise, edge, .. } = fit;
        let noises = self.scenario.sensors.iter().enumerate().map(|(place, sensor)| {
            let measured = record.measured_quantity(sensor.measures)?;
            let (_, std) = moments(measured);
            // At high frequencies an accelerometer reads the force; all other sensors read only noise.
            let own = || if sensor.measures == quantity { Some(noise) } else { None };
            let fitted = || own().or_else(|| Some(ambient_fit(record, sensor.measures, band)?.noise));
            let noise = if order(sensor.measures) < 2 { None } else { fitted() };
            Some(noise.unwrap_or(self.scenario.sensors[place].noise_std).max(1e-4 * std))
        });
        let noise = noises.collect::<Option<Vec<f64>>>()?;
        let found = Response { natural_frequency, damping_ratio, gain: None };
        self.begin_at(record, quantity, &found, "fitted to the spectrum as that of an oscillator under a white force");
        if order(quantity) == 2 {
            self.keep_to_spectrum(&fit);
        }
        if let Some(edge) = edge {
            self.reasons.push(format!(
                "above {} Hz the readings have less power than a white force gives, as behind a logger's low-pass filter: their \
                 innovations are correlated, so that the verdict is *overconfident*, but ωₙ and ζ of the spectrum below are right",
                rounded(edge / std::f64::consts::TAU)
            ));
        }
        // An unrecorded force acts on both sides of each sample.
        Some(Sizes { force, noise, hold: Hold::First })
    }

    /// Sets the initial σ of ωₙ and ζ to the errors of the spectrum's fit. An accelerometer also reads the unknown
    /// force, so that it hardly limits x: with a small error in R or in the force's course, ζ would go far wrong.
    fn keep_to_spectrum(&mut self, fit: &AmbientFit) {
        let AmbientFit { natural_frequency, damping_ratio, errors, .. } = *fit;
        for filter in self.filters() {
            filter.initial_std[Channel::NATURAL_FREQUENCY] = rounded(natural_frequency * errors[0]);
            filter.initial_std[Channel::DAMPING_RATIO] = rounded(damping_ratio * errors[1]);
        }
        self.reasons.push(
            "σ of ωₙ and ζ begin as small as the spectrum tells them, because an accelerometer alone tells an unknown force from \
             the motion only if both are known well"
                .to_owned(),
        );
    }

    /// The scenario with a white force in every filter, and noise of the sensors, of these sizes.
    fn with_white_force(&self, sizes: &Sizes) -> Scenario {
        let Sizes { force, noise, hold } = sizes;
        let (mut scenario, force) = (self.scenario.clone(), *force);
        let kind = scenario.plant.kind;
        scenario.hold = *hold;
        for (sensor, noise) in scenario.sensors.iter_mut().zip(noise) {
            sensor.noise_std = *noise;
        }
        for filter in &mut scenario.filters {
            for &channel in kind.channels().iter().filter(|channel| !channel.is_parameter()) {
                filter.process_std[channel] = 0.0;
            }
            augment(filter, Channel::WHITE_FORCE);
            filter.initial_mean[Channel::WHITE_FORCE] = 0.0;
            filter.initial_std[Channel::WHITE_FORCE] = force;
            filter.process_std[Channel::WHITE_FORCE] = force;
            filter.sensor_std.clone_from(noise);
        }
        scenario
    }

    /// The first filter of [`Self::with_white_force`] alone.
    pub(super) fn trial_of_white_force(&self, sizes: &Sizes) -> Scenario {
        first_for_trial(&self.with_white_force(sizes))
    }

    /// Takes these sizes for good.
    pub(super) fn take_white_force(&mut self, sizes: &Sizes) {
        self.scenario = self.with_white_force(sizes);
        let Some(filter) = self.scenario.filters.first() else { return };
        let force = sizes.force;
        let unit = self.unit("m/s²");
        let lasts = if sizes.hold == Hold::Zero { ", and that lasts until the next" } else { "" };
        self.reasons.push(format!(
            "there is no input: the filters take a white force for the cause of the motion, of {force} {unit} at a sample, which an \
             accelerometer feels too{lasts}"
        ));
        for (sensor, noise) in self.scenario.sensors.iter().zip(&filter.sensor_std) {
            let (name, unit) = (sensor.measures.name(), self.unit(sensor.measures.unit()));
            self.reasons.push(format!("R of the {name}: {noise} {unit}, the most likely together with that force"));
        }
    }
}

/// An oscillator under a white force, as the spectrum of a sensor shows it.
#[derive(Clone, Copy, Debug)]
struct AmbientFit {
    /// ωₙ \[rad/s\]
    natural_frequency: f64,
    /// ζ \[-\]
    damping_ratio: f64,
    /// s, the standard deviation of the force over mass at a sample \[m/s²\].
    force: f64,
    /// The standard deviation of the sensor's noise, in its unit.
    noise: f64,
    /// The standard errors of ωₙ and ζ, relative to them.
    errors: [f64; 2],
    /// The frequency from which on an accelerometer has less power than a white force gives \[rad/s\].
    edge: Option<f64>,
}

/// The frequencies of the fit, relative to that of the peak: other modes are left out.
const NEAR: std::ops::Range<f64> = 0.2..4.0;
/// Frequencies count up to this share of the Nyquist frequency, beyond which filters against aliases take the force away.
const HIGHEST: f64 = 0.8;
/// Frequencies up to this share of the Nyquist frequency are looked at for an edge.
const LAST: f64 = 0.97;
/// The number of parts of the spectrum that are looked at for an edge.
const PARTS: usize = 50;
/// Limits the share of a white force's power in each part beyond an edge; and the least number of these parts.
const LOW: (f64, usize) = (0.6, 3);
/// The frequencies at least.
const LEAST: usize = 10;
/// The most steps of the descent that are tried.
const STEPS: usize = 200;
/// The power of a Hann window half a line apart from each other, up to one and a half lines from its middle.
const WINDOW: [f64; 7] = [0.0096, 0.0834, 0.2403, 0.3334, 0.2403, 0.0834, 0.0096];

/// The fit to the lines around the highest peak of the spectrum, by Whittle's likelihood:
///
/// ```text
/// S(ω) = s² |G(ω)|² + R,  minimal Σ ln S + P / S
/// X = sinc(ω dt / 2) / (ωₙ² - ω² + 2iζωₙω),  G = X, iωX or 1 - ωₙ² X - 2ζωₙ iωX
/// ```
///
/// with the measured power P, for displacement, velocity and acceleration, smeared by the window as P is. `None` if
/// there is no such peak.
///
/// Source: Whittle (1953), Estimation and information in stationary time series; Brincker and Ventura (2015), *Introduction
/// to Operational Modal Analysis*.
fn ambient_fit(record: &Record, quantity: Quantity, band: Option<[f64; 2]>) -> Option<AmbientFit> {
    let measured = record.measured_quantity(quantity)?;
    let start = free_response(record, measured, band)?;
    let spectra = Spectra::new(record, measured, LONG, Gaps::Fill)?;
    let peak = start.natural_frequency;
    let last = (HIGHEST * spectra.len() as f64) as usize;
    let is_near = |place: &usize| {
        let frequency = spectra.frequency(*place);
        NEAR.contains(&(frequency / peak)) && is_within(band, frequency)
    };
    let places: Vec<usize> = (2..last).filter(is_near).collect();
    let (first, last) = (*places.first()?, *places.last()?);
    let powers = &spectra.output[first..=last];
    let (line, order) = (spectra.frequency(1), order(quantity));
    let lines = Lines { first: first as f64, line, dt: spectra.dt, order, powers };
    if powers.len() < LEAST {
        return None;
    }
    let mut sorted = powers.to_vec();
    sort_numbers(&mut sorted);
    let (low, high) = (sorted[sorted.len() / 10], sorted[sorted.len() - 1]);
    if !(low > 0.0 && high.is_finite()) {
        return None;
    }
    let size = |damping: f64| high / lines.response(peak, damping, peak).max(f64::MIN_POSITIVE);
    let begin = |damping: f64| [peak, damping, size(damping), 0.5 * low].map(libm::log);
    // A peak that is hardly wider than a line says little about its damping: another start is tried too.
    let found = [start.damping_ratio, 0.02].into_iter().map(|damping| lines.descend(begin(damping)));
    let (_, found) = found.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let [natural_frequency, damping_ratio, force, noise] = found.map(libm::exp);
    let is_sound = (0.5 * peak..2.0 * peak).contains(&natural_frequency) && damping_ratio < 0.7;
    let edge = lines.edge(&spectra, found);
    let errors = lines.errors(&found, spectra.independent())?;
    let (force, noise) = (libm::sqrt(force), libm::sqrt(noise));
    let is_sound = is_sound && force.is_finite() && force > 0.0 && noise.is_finite();
    let damping_ratio = damping_ratio.max(1e-3);
    is_sound.then_some(AmbientFit { natural_frequency, damping_ratio, force, noise, errors, edge })
}

/// Lines of a spectrum next to each other.
struct Lines<'a> {
    /// The number of the first line.
    first: f64,
    /// From a line to the next \[rad/s\].
    line: f64,
    /// Time between samples \[s\].
    dt: f64,
    /// The number of times that a displacement is differentiated to give the measured quantity.
    order: i32,
    powers: &'a [f64],
}

impl Lines<'_> {
    /// `|G(ω)|²` of the reading to a force that lasts for a sample.
    fn response(&self, natural_frequency: f64, damping_ratio: f64, frequency: f64) -> f64 {
        let (wn, w) = (natural_frequency, frequency);
        let (re, im) = (wn * wn - w * w, 2.0 * damping_ratio * wn * w);
        let half = 0.5 * w * self.dt;
        let sinc = if half > 0.0 { libm::sin(half) / half } else { 1.0 };
        let square = re * re + im * im;
        if self.order < 2 {
            let by = if self.order == 1 { w * w } else { 1.0 };
            return by * sinc * sinc / square.max(f64::MIN_POSITIVE);
        }
        // 1 - sinc (ωₙ² + 2iζωₙω) / D, with the conjugate of D above.
        let (above_re, above_im) = (wn * wn, im);
        let re = 1.0 - sinc * (above_re * re + above_im * im) / square.max(f64::MIN_POSITIVE);
        let im = -sinc * (above_im * (wn * wn - w * w) - above_re * im) / square.max(f64::MIN_POSITIVE);
        re * re + im * im
    }

    /// The frequency from which on the spectrum falls off below that of the logarithms of ωₙ, ζ, s² and R, as behind a low-pass
    /// filter. Only an accelerometer feels the force there.
    fn edge(&self, spectra: &Spectra, found: [f64; 4]) -> Option<f64> {
        let [wn, zeta, force, noise] = found.map(libm::exp);
        let (length, last) = (spectra.len() / PARTS, (LAST * spectra.len() as f64) as usize);
        let share = |first: usize| {
            let sum = |of: &dyn Fn(usize) -> f64| (first..first + length).map(of).sum::<f64>();
            let white = |place: usize| force * self.response(wn, zeta, spectra.frequency(place)) + noise;
            sum(&|place| spectra.output[place]) / sum(&white).max(f64::MIN_POSITIVE)
        };
        let parts = (1..=PARTS).map_while(|part| last.checked_sub(part * length)).filter(|_| length > 0);
        let beyond: Vec<usize> =
            parts.take_while(|first| spectra.frequency(*first) > 2.0 * wn && share(*first) < LOW.0).collect();
        let edge = beyond.last().filter(|_| self.order == 2 && beyond.len() >= LOW.1)?;
        Some(spectra.frequency(*edge))
    }

    /// The logarithm of S at each line, for the logarithms of ωₙ, ζ, s² and R.
    fn model(&self, at: &[f64; 4]) -> Vec<f64> {
        let [wn, zeta, force, noise] = at.map(libm::exp);
        let reach = WINDOW.len() / 2;
        let fine = |i: usize| self.line * (self.first + 0.5 * (i as f64 - reach as f64)).abs();
        let responses: Vec<f64> =
            (0..2 * self.powers.len() + 2 * reach).map(|i| self.response(wn, zeta, fine(i))).collect();
        let smeared = |line: usize| -> f64 { WINDOW.iter().zip(&responses[2 * line..]).map(|(w, g)| w * g).sum() };
        (0..self.powers.len()).map(|line| libm::log(force * smeared(line) + noise)).collect()
    }

    /// The derivatives of the logarithm of S at each line, by the logarithms of ωₙ, ζ, s² and R.
    fn slopes(&self, at: &[f64; 4], spectrum: &[f64]) -> [Vec<f64>; 4] {
        /// The change of a logarithm for a derivative.
        const CHANGE: f64 = 1e-4;
        std::array::from_fn(|i| {
            let mut near = *at;
            near[i] += CHANGE;
            self.model(&near).iter().zip(spectrum).map(|(other, ln)| (other - ln) / CHANGE).collect()
        })
    }

    /// The standard errors of ωₙ and ζ, relative to them, from the mean of a number of independent spectra.
    fn errors(&self, at: &[f64; 4], spectra: f64) -> Option<[f64; 2]> {
        let spectrum = self.model(at);
        let slopes = self.slopes(at, &spectrum);
        let mut equations = NormalEquations::new();
        (0..spectrum.len()).for_each(|line| equations.add(slopes.each_ref().map(|slopes| slopes[line]), 0.0, spectra));
        // R that is not seen has no part in it.
        let errors = equations.damped(0.0, 1e-6).variances()?.map(libm::sqrt);
        errors.iter().all(|error| error.is_finite()).then_some([errors[0], errors[1]])
    }

    /// The least of Whittle's likelihood, negative, that scoring reaches from a point, and its place.
    fn descend(&self, begin: [f64; 4]) -> (f64, [f64; 4]) {
        let look = |at: &[f64; 4]| {
            let spectrum = self.model(at);
            let cost = spectrum.iter().zip(self.powers).map(|(ln, power)| ln + power * libm::exp(-ln)).sum();
            (cost, spectrum)
        };
        let equations = |at: &[f64; 4], spectrum: &Vec<f64>| {
            let slopes = self.slopes(at, spectrum);
            let mut equations = NormalEquations::new();
            for (line, (ln, power)) in spectrum.iter().zip(self.powers).enumerate() {
                equations.add(slopes.each_ref().map(|slopes| slopes[line]), 1.0 - power * libm::exp(-ln), 1.0);
            }
            equations
        };
        let step = |at: &[f64; 4], by: [f64; 4]| Some(std::array::from_fn(|i| at[i] - by[i].clamp(-1.0, 1.0)));
        descend(begin, (STEPS, 1e-9), |_| 1e-6 * self.powers.len() as f64, look, equations, step)
    }
}
