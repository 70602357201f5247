//! Records without an input: an oscillator under a white force is fitted to the spectrum of one sensor.

use kalmanscope_filters::least_squares::{NormalEquations, descend};
use kalmanscope_filters::lists::{numbers, sort_numbers};
use kalmanscope_filters::{Channel, Hold, Quantity};
use kalmanscope_records::Record;

use super::likeliest::{MOST, climbed, likelihood, tried};
use super::response::{MeasuredResponse, free_response, is_within, order};
use super::spectra::{GapTreatment, LONG, Spectra};
use super::{Suggestion, augment, first_for_trial, moments, motion_sensor, rounded};
use crate::Scenario;

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sizes {
    /// s \[m/s²\]
    force: f64,
    noise: Vec<f64>,
    hold: Hold,
}

impl Sizes {
    fn times(&self, factors: &[f64]) -> Self {
        let noise = self.noise.iter().zip(&factors[1..]).map(|(noise, by)| rounded(noise * by)).collect();
        Self { force: rounded(self.force * factors[0]), noise, ..*self }
    }
}

pub(super) fn has_no_input(record: &Record) -> bool {
    record.forced().is_empty() && record.input().windows(2).all(|pair| pair[0] == pair[1])
}

pub(super) struct Ambient {
    pub(super) suggestion: Suggestion,
    sizes: Sizes,
    pub(super) left_out: Vec<Quantity>,
}

impl Ambient {
    pub(super) fn new(mut suggestion: Suggestion, record: &mut Record) -> Option<Self> {
        let left_out = suggestion.felt_twice();
        left_out.iter().for_each(|quantity| suggestion.scenario.remove_sensor(*quantity));
        let sizes = suggestion.ambient(record)?;
        suggestion.problem = None;
        suggestion.substeps(record.dt(), None);
        Some(Self { suggestion, sizes, left_out })
    }

    pub(super) async fn best(&self, record: &Record, samples: usize, progress: impl Fn(f64)) -> Option<(Sizes, f64)> {
        let mut trials = 0..MOST;
        let trial = |factors: Vec<f64>| {
            progress(trials.next().map_or(1.0, |trial| trial as f64 / MOST as f64));
            self.likelihood(self.sizes.times(&factors), record, samples)
        };
        let (factors, likelihood) = climbed(1 + self.suggestion.scenario.sensors.len(), trial).await.best?;
        let sizes = self.sizes.times(&factors);
        let held = Sizes { hold: Hold::Zero, ..sizes.clone() };
        let of_held = self.likelihood(held.clone(), record, samples).await.filter(|of_held| *of_held > likelihood);
        Some(of_held.map_or((sizes, likelihood), |of_held| (held, of_held)))
    }

    async fn likelihood(&self, sizes: Sizes, record: &Record, samples: usize) -> Option<f64> {
        let scenario = first_for_trial(&self.suggestion.with_white_force(&sizes));
        likelihood(&tried(&scenario, record, samples).await?)
    }
}

impl Suggestion {
    /// The accelerometers beside a displacement or a velocity: an error of the force's course, or a delay, would look like one of ζ.
    fn felt_twice(&mut self) -> Vec<Quantity> {
        let sensors = || self.scenario.sensors.iter().map(|sensor| sensor.measures);
        let is_other = sensors().any(|quantity| order(quantity) < 2);
        let left_out: Vec<Quantity> = sensors().filter(|quantity| is_other && order(*quantity) == 2).collect();
        for quantity in &left_out {
            self.reasons.push(format!(
                "the filters ignore the {}: without a recorded force it adds nothing to the other sensor, and the \
                 unknown force between samples would count as damping",
                quantity.name()
            ));
        }
        left_out
    }

    fn ambient(&mut self, record: &mut Record) -> Option<Sizes> {
        if !self.has_frequency() {
            return None;
        }
        let (quantity, _) = motion_sensor(record)?;
        let band = self.scenario.record.as_ref().and_then(|mapping| mapping.band);
        let AmbientFit { found, force, noise, errors, edge } = ambient_fit(record, quantity, band)?;
        let noises = self.scenario.sensors.iter().map(|sensor| {
            let (_, std) = moments(record.measured_quantity(sensor.measures)?);
            // At high frequencies an accelerometer reads the force; all other sensors read only noise.
            let fitted = match sensor.measures {
                other if order(other) < 2 => None,
                own if own == quantity => Some(noise),
                other => ambient_fit(record, other, band).map(|fit| fit.noise),
            };
            Some(fitted.unwrap_or(sensor.noise_std).max(1e-4 * std))
        });
        let noise = noises.collect::<Option<Vec<f64>>>()?;
        self.begin_at(record, quantity, &found, "fitted to the spectrum as that of an oscillator under a white force");
        if order(quantity) == 2 {
            // With a small error in R or in the force's course, ζ would go far wrong.
            for filter in self.filters() {
                filter.initial_std[Channel::NATURAL_FREQUENCY] = rounded(found.natural_frequency * errors[0]);
                filter.initial_std[Channel::DAMPING_RATIO] = rounded(found.damping_ratio * errors[1]);
            }
            self.reasons.push(
                "σ of ωₙ and ζ begin as small as the spectrum allows, because an accelerometer alone separates an \
                 unknown force from the motion only if both are known well"
                    .to_owned(),
            );
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

    pub(super) fn with_white_force(&self, sizes: &Sizes) -> Scenario {
        let &Sizes { force, ref noise, hold } = sizes;
        let mut scenario = Scenario { hold, ..self.scenario.clone() };
        for (sensor, noise) in scenario.sensors.iter_mut().zip(noise) {
            sensor.noise_std = *noise;
        }
        for filter in &mut scenario.filters {
            for &channel in scenario.plant.kind.channels().iter().filter(|channel| !channel.is_parameter()) {
                // The force takes the place of Q, of which equal shares for x and v make ωₙ 2 to 3 % wrong.
                filter.process_std[channel] = 0.0;
            }
            augment(filter, Channel::WHITE_FORCE, (0.0, force));
            filter.process_std[Channel::WHITE_FORCE] = force;
            filter.sensor_std.clone_from(noise);
        }
        scenario
    }

    pub(super) fn take_white_force(&mut self, sizes: &Sizes) {
        self.scenario = self.with_white_force(sizes);
        let (force, unit) = (sizes.force, self.unit("m/s²"));
        let lasts = if sizes.hold == Hold::Zero { ", and that lasts until the next" } else { "" };
        self.reasons.push(format!(
            "there is no input: the filters assume a white force as the cause of the motion, of {force} {unit} at a \
             sample, which an accelerometer reads too{lasts}"
        ));
        for (place, noise) in sizes.noise.iter().enumerate() {
            self.set_noise(place, *noise, "the most likely together with that force");
        }
    }
}

struct AmbientFit {
    found: MeasuredResponse,
    force: f64,
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
const PARTS: usize = 50;
/// Limits the share of a white force's power in each part beyond an edge; and the least number of these parts.
const LOW: (f64, usize) = (0.6, 3);
const LEAST: usize = 10;
const STEPS: usize = 200;
/// The power of a Hann window half a line apart from each other, up to one and a half lines from its middle.
const WINDOW: [f64; 7] = [0.0096, 0.0834, 0.2403, 0.3334, 0.2403, 0.0834, 0.0096];

/// The fit to the lines around the highest peak of the spectrum, by Whittle's likelihood:
/// ```text
/// S(ω) = s² |G(ω)|² + R,  minimal Σ ln S + P / S
/// X = sinc(ω dt / 2) / (ωₙ² - ω² + 2iζωₙω),  G = X, iωX or 1 - ωₙ² X - 2ζωₙ iωX
/// ```
/// with the measured power P, for displacement, velocity and acceleration, smeared by the window as P is. `None` without such a peak.
/// Source: Whittle (1953), Estimation and information in stationary time series; Brincker and Ventura (2015), *Introduction
/// to Operational Modal Analysis*.
fn ambient_fit(record: &Record, quantity: Quantity, band: Option<[f64; 2]>) -> Option<AmbientFit> {
    let measured = record.measured_quantity(quantity)?;
    let start = free_response(record, measured, band)?;
    let spectra = Spectra::new(record, measured, LONG, GapTreatment::Fill)?;
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
    let mut sorted = powers.to_vec();
    sort_numbers(&mut sorted);
    let (low, high) = (sorted[sorted.len() / 10], sorted[sorted.len() - 1]);
    if !(powers.len() >= LEAST && low > 0.0 && high.is_finite()) {
        return None;
    }
    let size = |damping: f64| high / lines.response(peak, damping, peak).max(f64::MIN_POSITIVE);
    let begin = |damping: f64| [peak, damping, size(damping), 0.5 * low].map(libm::log);
    // A peak that is hardly wider than a line says little about its damping: another start is tried too.
    let found = [start.damping_ratio, 0.02].into_iter().map(|damping| lines.descend(begin(damping)));
    let (_, found) = found.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let [natural_frequency, damping_ratio, force, noise] = found.map(libm::exp);
    let is_sound = (0.5 * peak..2.0 * peak).contains(&natural_frequency)
        && damping_ratio < 0.7
        && force.is_finite()
        && force > 0.0
        && noise.is_finite();
    // R that is not seen has no part in the errors.
    let variances = lines.equations(&found, &lines.model(&found)).damped(0.0, 1e-6).variances()?;
    let independent = 0.5 * (spectra.windows as f64 + 1.0);
    let [frequency, damping, ..] = variances.map(|variance| libm::sqrt(variance / independent));
    let fit = AmbientFit {
        found: MeasuredResponse { natural_frequency, damping_ratio: damping_ratio.max(1e-3), gain: None },
        force: libm::sqrt(force),
        noise: libm::sqrt(noise),
        errors: [frequency, damping],
        edge: lines.edge(&spectra, found),
    };
    (is_sound && frequency.is_finite() && damping.is_finite()).then_some(fit)
}

struct Lines<'a> {
    first: f64,
    line: f64,
    dt: f64,
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
        let (above_re, above_im) = match self.order {
            0 => (sinc, 0.0),
            1 => (sinc * w, 0.0),
            _ => (re - sinc * wn * wn, im - sinc * im),
        };
        (above_re * above_re + above_im * above_im) / (re * re + im * im).max(f64::MIN_POSITIVE)
    }

    /// The frequency from which the spectrum of an accelerometer falls off below the fit, as behind a low-pass filter \[rad/s\].
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

    fn model(&self, at: &[f64; 4]) -> Vec<f64> {
        let [wn, zeta, force, noise] = at.map(libm::exp);
        let reach = WINDOW.len() / 2;
        let fine = |i: usize| self.line * (self.first + 0.5 * (i as f64 - reach as f64)).abs();
        let responses: Vec<f64> = numbers(2 * self.powers.len() + 2 * reach, &|i| self.response(wn, zeta, fine(i)));
        let smeared = |line: usize| -> f64 { WINDOW.iter().zip(&responses[2 * line..]).map(|(w, g)| w * g).sum() };
        numbers(self.powers.len(), &|line| libm::log(force * smeared(line) + noise))
    }

    fn equations(&self, at: &[f64; 4], spectrum: &[f64]) -> NormalEquations<4> {
        const CHANGE: f64 = 1e-4;
        let near: [Vec<f64>; 4] =
            std::array::from_fn(|i| self.model(&std::array::from_fn(|j| at[j] + if i == j { CHANGE } else { 0.0 })));
        let mut equations = NormalEquations::zero();
        for (line, (ln, power)) in spectrum.iter().zip(self.powers).enumerate() {
            let slopes = near.each_ref().map(|near| (near[line] - ln) / CHANGE);
            equations.add(slopes, 1.0 - power * libm::exp(-ln), 1.0);
        }
        equations
    }

    fn descend(&self, begin: [f64; 4]) -> (f64, [f64; 4]) {
        let look = |at: &[f64; 4]| {
            let spectrum = self.model(at);
            let cost = spectrum.iter().zip(self.powers).map(|(ln, power)| ln + power * libm::exp(-ln)).sum();
            (cost, spectrum)
        };
        let equations = |at: &[f64; 4], spectrum: &Vec<f64>| self.equations(at, spectrum);
        let step = |at: &[f64; 4], by: [f64; 4]| Some(std::array::from_fn(|i| at[i] - by[i].clamp(-1.0, 1.0)));
        descend(begin, (STEPS, 1e-9), |_| 1e-6 * self.powers.len() as f64, look, equations, step)
    }
}
