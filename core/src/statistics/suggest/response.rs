//! Natural frequency, damping ratio and gain from spectra, and from a free decay.

use std::borrow::Cow;
use std::f64::consts::TAU;

use kalmanscope_filters::fourier::powers;
use kalmanscope_filters::least_squares::NormalEquations;
use kalmanscope_filters::lists::{median, numbers};
use kalmanscope_filters::{Aspect, Hold, Quantity};
use kalmanscope_records::Record;
use kalmanscope_records::mapping::Mapping;

use super::moments;
use super::spectra::{GapTreatment, LONG, Spectra, passed};
use crate::free_decay::{ModeFit, highest};

#[derive(Clone, Copy, Debug)]
pub(super) struct MeasuredResponse {
    /// ωₙ \[rad/s\]
    pub(super) natural_frequency: f64,
    /// ζ \[-\]
    pub(super) damping_ratio: f64,
    /// The true input over the recorded one, where the input is known.
    pub(super) gain: Option<f64>,
}

const HIGHEST: f64 = 0.8;
const ROUNDS: usize = 8;
/// The rounds in which the part of an acceleration that follows a held force at once is taken out.
const FEEDTHROUGH_ROUNDS: usize = 4;
/// The least mean coherence around the peak for which a response to the input is believed.
const COHERENT: f64 = 0.3;

pub(super) fn order(quantity: Quantity) -> i32 {
    let orders = [(Aspect::DISPLACEMENT, 0), (Aspect::DRIFT, 0), (Aspect::VELOCITY, 1)];
    orders.into_iter().find(|(aspect, _)| *aspect == quantity.aspect()).map_or(2, |(_, order)| order)
}

pub(super) fn relative(record: &Record, quantity: Quantity) -> Option<Cow<'_, [f64]>> {
    let measured = record.measured_quantity(quantity)?;
    if quantity != Quantity::TOTAL_ACCELERATION {
        return Some(measured.into());
    }
    // ẍ is what is measured less the ground's acceleration, which is minus the force.
    Some(measured.iter().enumerate().map(|(k, value)| value + record.force(k)).collect())
}

struct Point {
    /// ω \[rad/s\]
    frequency: f64,
    /// The response as that of a displacement, the hold taken out.
    response: (f64, f64),
    weight: f64,
    explained: f64,
    scale: f64,
}

fn power(h: (f64, f64)) -> f64 {
    h.0 * h.0 + h.1 * h.1
}

/// The response of a quantity to the input, fitted by
/// ```text
/// H(ω) = g w(ω) / (ωₙ² - ω² + 2iζωₙω)
/// ```
/// as a displacement, with w of the hold: `exp(-iωΔt/2) sinc(ωΔt/2)`, or `sinc²(ωΔt/2)` for an input that is linear over each of some
/// `steps`; `band` is in \[Hz\]. `None` if the input does not explain the measurements. Source: Levy (1959), Complex-curve fitting;
/// Sanathanan and Koerner (1963), Transfer function synthesis as a ratio of two complex polynomials.
pub(super) fn response(
    record: &Record,
    quantity: Quantity,
    band: Option<[f64; 2]>,
    steps: usize,
) -> Option<MeasuredResponse> {
    let measured = relative(record, quantity)?;
    let spectra = Spectra::new(record, &measured, LONG, GapTreatment::Fill)?;
    let dt = record.dt() / steps as f64;
    let points = points(&spectra, record, quantity, band, dt, 0.0);
    let peak = |of: fn(&Point) -> f64| Some(points.iter().max_by(|a, b| of(a).total_cmp(&of(b)))?.frequency);
    let spectrum = free_response(record, &measured, band).map(|found| found.natural_frequency);
    let peaks = [peak(|p| power(p.response)), peak(|p| p.explained), spectrum];
    let fits = peaks.into_iter().flatten().filter_map(|peak| fit(&points, peak));
    let mut found = fits.min_by(|a, b| misfit(&points, a).total_cmp(&misfit(&points, b)))?;
    if order(quantity) == 2 && record.hold() == Hold::Zero {
        for _ in 0..FEEDTHROUGH_ROUNDS {
            let points = self::points(&spectra, record, quantity, band, dt, found.gain.unwrap_or(0.0));
            let Some(better) = fit(&points, found.natural_frequency) else { break };
            found = better;
        }
    }
    Some(found)
}

/// The frequencies at which the input explains the measurement beyond chance. An acceleration follows a held force at
/// once, by its gain g, while displacement and velocity follow its mean over a sample:
/// ```text
/// a = g f - (ωₙ² + 2iζωₙω) x,  x = g w f / D,  D = ωₙ² - ω² + 2iζωₙω  ⇒  a / f - g (1 - w) = -ω² g w / D
/// ```
fn points(
    spectra: &Spectra,
    record: &Record,
    quantity: Quantity,
    band: Option<[f64; 2]>,
    dt: f64,
    gain: f64,
) -> Vec<Point> {
    let last = (HIGHEST * spectra.len() as f64) as usize;
    let (least, coherent) = (spectra.least_input(), spectra.coherence_of_chance().max(COHERENT));
    let point = |place: usize| {
        let (input, frequency) = (spectra.input[place], spectra.frequency(place));
        let coherence = spectra.coherence(place);
        if input <= 0.0 || input < least || coherence <= coherent || !is_within(band, frequency) {
            return None;
        }
        let (re, im) = spectra.cross[place];
        let w = frequency;
        let x = 0.5 * w * dt;
        let sinc = if x > 0.0 { libm::sin(x) / x } else { 1.0 };
        let (sin, cos) = libm::sincos(x);
        let h = (re / input - gain * (1.0 - sinc * cos), im / input - gain * sinc * sin);
        let h = match order(quantity) {
            0 => h,
            1 => (h.1 / w, -h.0 / w),
            _ => (-h.0 / (w * w), -h.1 / (w * w)),
        };
        let response = match record.hold() {
            Hold::Zero => ((h.0 * cos - h.1 * sin) / sinc, (h.0 * sin + h.1 * cos) / sinc),
            Hold::First => (h.0 / (sinc * sinc), h.1 / (sinc * sinc)),
        };
        // The variance of a measured response goes with (1 - γ²) / γ² of its square.
        let weight = coherence / (1.0 - coherence).max(1e-3);
        let explained = spectra.output[place] * coherence;
        Some(Point { frequency, response, weight, explained, scale: explained / power(h).max(f64::MIN_POSITIVE) })
    };
    // The window smears the mean and what is slower than it over the first lines.
    (2..last).filter_map(point).collect()
}

pub(super) fn is_within(band: Option<[f64; 2]>, frequency: f64) -> bool {
    band.is_none_or(|[low, high]| (low..=high).contains(&(frequency / TAU)))
}

fn misfit(points: &[Point], found: &MeasuredResponse) -> f64 {
    let (wn, gain) = (found.natural_frequency, found.gain.unwrap_or(1.0));
    let error = |point: &Point| {
        let w = point.frequency;
        let (re, im) = (wn * wn - w * w, 2.0 * found.damping_ratio * wn * w);
        let scale = gain / power((re, im));
        power((point.response.0 - scale * re, point.response.1 + scale * im)) * point.scale
    };
    points.iter().map(error).sum()
}

fn fit(points: &[Point], peak: f64) -> Option<MeasuredResponse> {
    let near: Vec<&Point> = points.iter().filter(|p| (0.4 * peak..2.0 * peak).contains(&p.frequency)).collect();
    if near.len() < 4 {
        return None;
    }
    let mut found: Option<[f64; 3]> = None;
    for _ in 0..ROUNDS {
        let mut equations = NormalEquations::zero();
        for point in &near {
            // H (b + iωa - ω²) = g, with b = ωₙ² and a = 2ζωₙ, in units of the peak.
            let (h, scaled) = (point.response, point.frequency / peak);
            let weight = match found {
                // Levy's equations are errors times the denominator: the one of the last round undoes that.
                Some([b, a, _]) => {
                    point.weight / (power(h) * power((b - scaled * scaled, a * scaled))).max(f64::MIN_POSITIVE)
                }
                None => point.weight,
            };
            equations.add([h.0, -scaled * h.1, -1.0], scaled * scaled * h.0, weight);
            equations.add([h.1, scaled * h.0, 0.0], scaled * scaled * h.1, weight);
        }
        let [b, a, g] = equations.solution()?;
        if !(b > 0.0 && a.is_finite() && g.is_finite()) {
            break;
        }
        found = Some([b, a, g]);
    }
    let [b, a, g] = found?;
    let natural_frequency = peak * libm::sqrt(b);
    let damping_ratio = a / (2.0 * libm::sqrt(b));
    let is_sound = (0.2 * peak..5.0 * peak).contains(&natural_frequency) && damping_ratio < 1.0;
    let damping_ratio = damping_ratio.max(1e-3);
    is_sound.then_some(MeasuredResponse { natural_frequency, damping_ratio, gain: Some(g * peak * peak) })
}

/// The highest peak of a measurement's spectrum, and its width at half the power.
/// Source: Bendat and Piersol (2010), *Random Data*, section 5.2 (half-power bandwidth).
pub(super) fn free_response(record: &Record, measured: &[f64], band: Option<[f64; 2]>) -> Option<MeasuredResponse> {
    let spectra = Spectra::new(record, measured, LONG, GapTreatment::Fill)?;
    let power = |place: usize| spectra.output[place];
    let within = (2..spectra.len()).filter(|&place| is_within(band, spectra.frequency(place)));
    let peak = within.max_by(|&a, &b| power(a).total_cmp(&power(b)))?;
    let half = 0.5 * power(peak);
    let edge = |mut places: Box<dyn Iterator<Item = usize>>| {
        let beyond = places.find(|&place| power(place) < half)?;
        let within = if beyond > peak { beyond - 1 } else { beyond + 1 };
        let share = (power(within) - half) / (power(within) - power(beyond));
        Some(within as f64 + share * (beyond as f64 - within as f64))
    };
    let upper = edge(Box::new(peak + 1..spectra.len()))?;
    let lower = edge(Box::new((1..peak).rev()))?;
    let step = spectra.frequency(1);
    let natural_frequency = 0.5 * (lower + upper) * step;
    // A window's own line is about one and a half steps wide.
    let width = libm::sqrt(((upper - lower) * (upper - lower) - 2.0).max(0.05)) * step;
    let damping_ratio = (0.5 * width / natural_frequency).clamp(1e-3, 0.5);
    Some(MeasuredResponse { natural_frequency, damping_ratio, gain: None })
}

#[derive(Clone, Copy)]
pub(super) struct DecayFit {
    pub(super) found: MeasuredResponse,
    /// The standard deviation of what it leaves, in the sensor's unit; and those of ωₙ and ζ, if that is white.
    pub(super) rest: f64,
    /// The power of that about the decay's frequency, over its mean power.
    pub(super) nearby: f64,
    pub(super) spread: [f64; 2],
    /// The amplitude of the readings where they are largest, in the sensor's unit.
    pub(super) amplitude: f64,
    pub(super) is_all: bool,
}

const MOST: usize = 16_384;
const SHORTEST: usize = 64;
/// The largest share of the power in the first time constants that a decay leaves unexplained.
const UNEXPLAINED: f64 = 0.5;
const LASTS: f64 = 3.0;
/// The frequencies about that of the decay, relative to it, in which a force would leave its response.
const NEAR: std::ops::Range<f64> = 0.8..1.25;
/// The mean power of noise near the decay's frequency is at most this often the median of all.
const LOUD: f64 = 6.0;

/// The free response that fits best to the readings from the largest one on, by least squares:
/// ```text
/// y = exp(-σt) (a cos ω_d t + b sin ω_d t) + c,  ωₙ² = ω_d² + σ²,  ζ = σ / ωₙ
/// ```
/// The descent begins in the first 64, 128, … samples: light damping shows in long parts and strong damping in short ones. `None` if no
/// decay explains the readings, for example because an unknown force still acts. Source: Levenberg (1944), A method for the solution of
/// certain non-linear problems in least squares; Ewins (2000), *Modal Testing*, section 4.4 (time domain).
pub(super) fn decay(record: &Record, measured: &[f64], mapping: Option<&Mapping>) -> Option<DecayFit> {
    let band = mapping.and_then(|mapping| mapping.band);
    let (mean, _) = moments(measured);
    let size = |value: f64| if value.is_nan() { 0.0 } else { (value - mean).abs() };
    let begin = (0..measured.len()).max_by(|&a, &b| size(measured[a]).total_cmp(&size(measured[b])))?;
    if 2 * begin > measured.len() {
        return None;
    }
    let times = (0..MOST).map(|k| k as f64 * record.dt());
    let readings = times.zip(&measured[begin..]).filter(|(_, value)| !value.is_nan());
    let readings: Vec<[f64; 2]> = readings.map(|(time, value)| [time, *value]).collect();
    let lengths = (0..).map(|i| SHORTEST << i).take_while(|length| *length <= readings.len());
    let fits = lengths.filter_map(|length| {
        let values = numbers(length, &|k| readings[k][1]);
        let frequency = highest(&readings[..length], &values, |frequency| is_within(band, frequency))?;
        Some(ModeFit::descend(&readings, [mean, frequency, 2.0 / (readings[length - 1][0] + record.dt()), 0.0, 0.0]))
    });
    let fit = fits.filter(|fit| fit.cost.is_finite()).min_by(|a, b| a.cost.total_cmp(&b.cost))?;
    let mode = *fit.modes(&readings)?.first()?;
    let (natural_frequency, damping_ratio) = (TAU * mode.frequency, mode.damping_ratio);
    let ([constant, frequency, rate, ..], rests) = (fit.numbers, fit.rests(&readings));
    let first = readings.partition_point(|[time, _]| time * rate < LASTS);
    let left = rests[..first].iter().map(|rest| rest * rest).sum::<f64>();
    let all = readings[..first].iter().map(|[_, value]| (value - constant) * (value - constant)).sum::<f64>();
    let is_sound = is_within(band, natural_frequency) && (1e-4..0.7).contains(&damping_ratio);
    let (is_all, nearby) = leaves_noise(&rests, frequency * record.dt(), passed(mapping, record.dt()));
    let found = DecayFit {
        found: MeasuredResponse { natural_frequency, damping_ratio, gain: None },
        rest: libm::sqrt(fit.cost / readings.len().saturating_sub(5).max(1) as f64),
        nearby,
        spread: [TAU * mode.std[0], mode.std[1]],
        amplitude: mode.amplitude,
        is_all,
    };
    (is_sound && left < UNEXPLAINED * all).then_some(found)
}

/// Whether the rest has no more power near `frequency` \[rad/sample\] than elsewhere, and its mean power there over that elsewhere.
fn leaves_noise(rests: &[f64], frequency: f64, passed: [f64; 2]) -> (bool, f64) {
    let length = 1 << rests.len().max(2).ilog2();
    let powers = powers(rests[..length].iter().copied(), length);
    let (last, line) = (powers.len(), TAU / length as f64);
    let [low, high] = [NEAR.start, NEAR.end].map(|edge| ((edge * frequency / line) as usize).clamp(1, last));
    let near = &powers[low..(high + 1).min(last)];
    let mean = near.iter().sum::<f64>() / near.len().max(1) as f64;
    let [low, high] = passed.map(|share| ((share * last as f64) as usize).min(last));
    let passed = &powers[low.min(high.saturating_sub(1))..high.max(1)];
    let all = passed.iter().sum::<f64>() / passed.len() as f64;
    let usual = median(passed.to_vec()).unwrap_or(0.0);
    (mean < LOUD * usual, if all > 0.0 { mean / all } else { 1.0 })
}
