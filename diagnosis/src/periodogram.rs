//! The power of series over frequency, by fast Fourier transforms.

use std::f64::consts::{PI, TAU};
use std::ops::Range;

use kalmanscope_core::internals::{Transform, numbers};

/// Limits the length of a window from above: at 100 Hz about ten seconds.
const LONGEST: usize = 1024;

const SHORTEST: usize = 32;

const WINDOWS: usize = 4;

/// The mean power over windows that do not overlap; white noise of variance 1 has the power 1 everywhere:
/// ```text
/// I_j = mean of |Σ w_k ν_k exp(-2πi jk/L)|² / Σ w_k²,  w_k = sin²(π (k + ½) / L),  j = 2 … L/2 - 2
/// ```
/// Source: Welch (1967), The use of fast Fourier transform for the estimation of power spectra.
#[derive(Clone, Debug, Default)]
pub struct Periodogram {
    length: usize,
    pub(crate) windows: usize,
    pub(crate) power: Vec<f64>,
}

/// The least frequency, in cycles per window: below it the window's own shape dominates.
const FIRST: usize = 2;

impl Periodogram {
    /// Of several series of one length, over windows with no sample outside some ranges, of which no two are adjacent.
    pub fn of_all(series: &[Vec<f64>], kept: &[Range<usize>]) -> Vec<Self> {
        let samples = series.first().map_or(0, Vec::len);
        let lengths = (0..).map(|i| LONGEST >> i).take_while(|length| *length >= SHORTEST);
        let fits = |length: &usize| length * WINDOWS <= samples;
        let Some(length) = lengths.into_iter().find(fits) else { return vec![Self::default(); series.len()] };
        let weights = numbers(length, &|k| libm::sin(PI * (k as f64 + 0.5) / length as f64).powi(2));
        let scale = 1.0 / weights.iter().map(|w| w * w).sum::<f64>();
        let transform = Transform::new(length);
        let begins = kept.iter().flat_map(|run| run.clone().step_by(length).take(run.len() / length));
        let mut all = vec![Self { length, windows: 0, power: vec![0.0; length / 2 - 1 - FIRST] }; series.len()];
        for begin in begins {
            let pairs = powers(&transform, &weights, series, begin);
            for (i, one) in all.iter_mut().enumerate() {
                one.windows += 1;
                for (sum, pair) in one.power.iter_mut().zip(&pairs[i / 2]) {
                    *sum += pair[i % 2];
                }
            }
        }
        let mean = |mut one: Self| {
            if one.windows < WINDOWS / 2 {
                return Self::default();
            }
            one.power.iter_mut().for_each(|power| *power = *power * scale / one.windows as f64);
            one
        };
        all.into_iter().map(mean).collect()
    }

    /// The mean over all frequencies.
    pub fn mean(&self) -> f64 {
        self.power.iter().sum::<f64>() / self.power.len() as f64
    }

    /// The largest power and its frequency in radians a sample, by a parabola. `None` if the series is too short.
    pub fn peak(&self) -> Option<(f64, f64)> {
        let (place, &power) = self.power.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1))?;
        let at = |place: Option<usize>| place.and_then(|place| self.power.get(place)).copied().unwrap_or(power);
        let (below, above) = (at(place.checked_sub(1)), at(Some(place + 1)));
        let curve = below - 2.0 * power + above;
        let shift = if curve < 0.0 { 0.5 * (below - above) / curve } else { 0.0 };
        Some((power, TAU * ((place + FIRST) as f64 + shift) / self.length as f64))
    }
}

/// Of the window that begins at one sample, not yet scaled: at each frequency those of two series, which take one transform.
fn powers(transform: &Transform, weights: &[f64], series: &[Vec<f64>], begin: usize) -> Vec<Vec<[f64; 2]>> {
    let length = weights.len();
    let mut buffer = vec![(0.0, 0.0); length];
    let of_pair = |pair: &[Vec<f64>]| {
        for (k, (slot, weight)) in (begin..).zip(buffer.iter_mut().zip(weights)) {
            *slot = (weight * pair[0][k], pair.get(1).map_or(0.0, |second| weight * second[k]));
        }
        transform.apply(&mut buffer);
        let power = |j: usize| {
            // The real series' transform is the even part, the imaginary one's the odd part.
            let ((re, im), (mirrored_re, mirrored_im)) = (buffer[j], buffer[length - j]);
            let (even_re, even_im) = (re + mirrored_re, im - mirrored_im);
            let (odd_re, odd_im) = (im + mirrored_im, re - mirrored_re);
            [0.25 * (even_re * even_re + even_im * even_im), 0.25 * (odd_re * odd_re + odd_im * odd_im)]
        };
        (FIRST..length / 2 - 1).map(power).collect()
    };
    series.chunks(2).map(of_pair).collect()
}
