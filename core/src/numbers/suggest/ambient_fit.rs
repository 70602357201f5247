//! An oscillator under an unrecorded white force, fitted to the spectrum of one sensor.

use super::response::{free_response, is_within, order};
use super::spectra::{Gaps, LONG, Spectra};
use crate::mathematics::least_squares::NormalEquations;
use crate::{Quantity, Record};

/// An oscillator under a white force, as the spectrum of a sensor shows it.
#[derive(Clone, Copy, Debug)]
pub(super) struct AmbientFit {
    /// ωₙ \[rad/s\]
    pub(super) natural_frequency: f64,
    /// ζ \[-\]
    pub(super) damping_ratio: f64,
    /// s, the standard deviation of the force over mass at a sample \[m/s²\].
    pub(super) force: f64,
    /// The standard deviation of the sensor's noise, in its unit.
    pub(super) noise: f64,
    /// The standard errors of ωₙ and ζ, relative to them.
    pub(super) errors: [f64; 2],
    /// The frequency from which on an accelerometer has less power than a white force gives \[rad/s\].
    pub(super) edge: Option<f64>,
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
const LEAST: usize = 16;
/// The most steps of the descent.
const STEPS: usize = 40;
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
pub(super) fn ambient_fit(
    record: &Record,
    quantity: Quantity,
    measured: &[f64],
    band: Option<[f64; 2]>,
) -> Option<AmbientFit> {
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
    let lines = Lines {
        first: first as f64,
        line: spectra.frequency(1),
        dt: spectra.dt(),
        order: order(quantity),
        powers: &spectra.output[first..=last],
    };
    if lines.powers.len() < LEAST {
        return None;
    }
    let mut sorted = lines.powers.to_vec();
    crate::data::sorting::sort_numbers(&mut sorted);
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
    (is_sound && force.is_finite() && force > 0.0 && noise.is_finite()).then_some(AmbientFit {
        natural_frequency,
        damping_ratio: damping_ratio.max(1e-3),
        force,
        noise,
        errors,
        edge,
    })
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
    fn model(&self, at: &[f64; 4], spectrum: &mut Vec<f64>) {
        let [wn, zeta, force, noise] = at.map(libm::exp);
        let reach = WINDOW.len() / 2;
        let fine = |i: usize| self.line * (self.first + 0.5 * (i as f64 - reach as f64)).abs();
        let responses: Vec<f64> =
            (0..2 * self.powers.len() + 2 * reach).map(|i| self.response(wn, zeta, fine(i))).collect();
        spectrum.clear();
        spectrum.extend((0..self.powers.len()).map(|line| {
            let smeared: f64 = WINDOW.iter().zip(&responses[2 * line..]).map(|(weight, g)| weight * g).sum();
            libm::log(force * smeared + noise)
        }));
    }

    /// Whittle's likelihood, negative.
    fn cost(&self, spectrum: &[f64]) -> f64 {
        spectrum.iter().zip(self.powers).map(|(ln, power)| ln + power * libm::exp(-ln)).sum()
    }

    /// The derivatives of the logarithm of S at each line, by the logarithms of ωₙ, ζ, s² and R.
    fn slopes(&self, at: &[f64; 4], spectrum: &[f64]) -> [Vec<f64>; 4] {
        /// The change of a logarithm for a derivative.
        const CHANGE: f64 = 1e-4;
        let mut other = Vec::new();
        std::array::from_fn(|i| {
            let mut near = *at;
            near[i] += CHANGE;
            self.model(&near, &mut other);
            other.iter().zip(spectrum).map(|(other, ln)| (other - ln) / CHANGE).collect()
        })
    }

    /// The standard errors of ωₙ and ζ, relative to them, from the mean of a number of independent spectra.
    fn errors(&self, at: &[f64; 4], spectra: f64) -> Option<[f64; 2]> {
        let mut spectrum = Vec::new();
        self.model(at, &mut spectrum);
        let slopes = self.slopes(at, &spectrum);
        let mut equations = NormalEquations::new();
        (0..spectrum.len()).for_each(|line| equations.add(slopes.each_ref().map(|slopes| slopes[line]), 0.0, spectra));
        // R that is not seen has no part in it.
        let errors = equations.damped(0.0, 1e-6).variances()?.map(libm::sqrt);
        errors.iter().all(|error| error.is_finite()).then_some([errors[0], errors[1]])
    }

    /// The least cost that scoring reaches from a point, and its place.
    fn descend(&self, begin: [f64; 4]) -> (f64, [f64; 4]) {
        let (mut at, mut spectrum, mut other) = (begin, Vec::new(), Vec::new());
        self.model(&at, &mut spectrum);
        let mut cost = self.cost(&spectrum);
        let mut damping = 1e-3;
        for _ in 0..STEPS {
            let slopes = self.slopes(&at, &spectrum);
            let mut equations = NormalEquations::new();
            for (line, (ln, power)) in spectrum.iter().zip(self.powers).enumerate() {
                equations.add(slopes.each_ref().map(|slopes| slopes[line]), 1.0 - power * libm::exp(-ln), 1.0);
            }
            let before = cost;
            while damping < 1e9 {
                let Some(step) = equations.damped(damping, 1e-9).solution() else { break };
                let next = std::array::from_fn(|i| at[i] - step[i].clamp(-1.0, 1.0));
                self.model(&next, &mut other);
                let next_cost = self.cost(&other);
                if next_cost < cost {
                    (at, cost) = (next, next_cost);
                    std::mem::swap(&mut spectrum, &mut other);
                    damping *= 0.1;
                    break;
                }
                damping = (10.0 * damping).max(1e-6);
            }
            if before - cost < 1e-6 * self.powers.len() as f64 {
                break;
            }
        }
        (cost, at)
    }
}
