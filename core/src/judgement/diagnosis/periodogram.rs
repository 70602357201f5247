//! The power of series over frequency, by fast Fourier transforms.

use std::f64::consts::{PI, TAU};
use std::ops::Range;

use crate::mathematics::fourier::Transform;

/// Limits the length of a window from above: at 100 Hz about ten seconds.
const LONGEST: usize = 1024;

/// The least length of a window.
const SHORTEST: usize = 32;

/// The least number of windows in a record.
const WINDOWS: usize = 4;

/// The mean power of a series over windows that do not overlap, at frequencies from one cycle a window on.
///
/// ```text
/// I_j = mean of |Σ w_k ν_k exp(-2πi jk/L)|² / Σ w_k²,  w_k = sin²(π (k + ½) / L),  j = 2 … L/2 - 2
/// ```
///
/// White noise of variance 1 has the power 1 everywhere, and 2n times it over n windows is χ² with 2n degrees of freedom.
///
/// Source: Welch (1967), The use of fast Fourier transform for the estimation of power spectra.
#[derive(Clone, Debug, Default)]
pub(crate) struct Periodogram {
    /// Samples of a window.
    length: usize,
    windows: usize,
    power: Vec<f64>,
}

/// The least frequency, in cycles per window: below it the window's own shape dominates.
const FIRST: usize = 2;

impl Periodogram {
    /// The periodograms of several series of one length, of windows that have no sample outside some ranges in ascending
    /// order. Two series take one transform.
    pub(crate) fn of_all(series: &[&[f64]], kept: &[Range<usize>]) -> Vec<Self> {
        let samples = series.first().map_or(0, |one| one.len());
        let Some(mut windows) = WelchWindows::of(samples) else { return vec![Self::default(); series.len()] };
        let begins = window_begins(kept, windows.length);
        let mut all = vec![Self::empty(windows.length); series.len()];
        for (pair, of_pair) in series.chunks(2).zip(all.chunks_mut(2)) {
            for &begin in &begins {
                let window = begin..begin + windows.length;
                let first = &pair[0][window.clone()];
                let powers = windows.powers(first, pair.get(1).map(|second| &second[window]));
                for (of, one) in of_pair.iter_mut().enumerate() {
                    one.add(powers.iter().map(|both| both[of]));
                }
            }
        }
        all.into_iter().map(|one| one.averaged(&windows)).collect()
    }

    /// A sum over windows of `length` samples, none added yet.
    pub(crate) fn empty(length: usize) -> Self {
        Self { length, windows: 0, power: vec![0.0; length / 2 - 1 - FIRST] }
    }

    /// Adds the powers of a window ([`WelchWindows::powers`]).
    pub(crate) fn add(&mut self, powers: impl Iterator<Item = f64>) {
        self.windows += 1;
        for (sum, power) in self.power.iter_mut().zip(powers) {
            *sum += power;
        }
    }

    /// The mean of the added windows; empty if they are too few.
    pub(crate) fn averaged(mut self, windows: &WelchWindows) -> Self {
        if self.windows < WINDOWS / 2 {
            return Self::default();
        }
        for power in &mut self.power {
            *power = *power * windows.scale / self.windows as f64;
        }
        self
    }

    /// The samples of a window over this many samples. `None` if there are too few.
    pub(crate) fn window_of(samples: usize) -> Option<usize> {
        WelchWindows::length_for(samples)
    }

    /// The number of windows: half the degrees of freedom of each power.
    pub(crate) fn windows(&self) -> usize {
        self.windows
    }

    /// The mean of all powers; NaN where the series is too short.
    pub(crate) fn mean(&self) -> f64 {
        self.power.iter().sum::<f64>() / self.power.len() as f64
    }

    /// The number of frequencies.
    pub(crate) fn len(&self) -> usize {
        self.power.len()
    }

    /// The largest power and its frequency in radians a sample, between its neighbours by a parabola. `None` if the
    /// series is too short.
    pub(crate) fn peak(&self) -> Option<(f64, f64)> {
        let (place, &power) = self.power.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1))?;
        let at = |place: Option<usize>| place.and_then(|place| self.power.get(place)).copied().unwrap_or(power);
        let (below, above) = (at(place.checked_sub(1)), at(Some(place + 1)));
        let curve = below - 2.0 * power + above;
        let shift = if curve < 0.0 { 0.5 * (below - above) / curve } else { 0.0 };
        Some((power, TAU * ((place + FIRST) as f64 + shift) / self.length as f64))
    }
}

/// Windows of one length, and their transform.
#[derive(Debug)]
pub(crate) struct WelchWindows {
    length: usize,
    transform: Transform,
    weights: Vec<f64>,
    /// One over the sum of the squares of the weights.
    scale: f64,
    buffer: Vec<(f64, f64)>,
    powers: Vec<[f64; 2]>,
}

impl WelchWindows {
    /// The length of the windows of a record of this many samples. `None` if these are too few.
    pub(crate) fn length_for(samples: usize) -> Option<usize> {
        (0..).map(|i| LONGEST >> i).take_while(|l| *l >= SHORTEST).find(|l| l * WINDOWS <= samples)
    }

    /// The windows of a record of this many samples. `None` if these are too few.
    pub(crate) fn of(samples: usize) -> Option<Self> {
        let length = Self::length_for(samples)?;
        let weights: Vec<f64> = (0..length).map(|k| libm::sin(PI * (k as f64 + 0.5) / length as f64)).collect();
        let weights: Vec<f64> = weights.iter().map(|w| w * w).collect();
        let scale = 1.0 / weights.iter().map(|w| w * w).sum::<f64>();
        let (buffer, powers) = (vec![(0.0, 0.0); length], vec![[0.0; 2]; length / 2 - 1 - FIRST]);
        Some(Self { length, transform: Transform::new(length), weights, scale, buffer, powers })
    }

    /// The samples of a window.
    pub(crate) fn length(&self) -> usize {
        self.length
    }

    /// The powers of one window of one series or two at each frequency, not yet scaled.
    pub(crate) fn powers(&mut self, first: &[f64], second: Option<&[f64]>) -> &[[f64; 2]] {
        let Self { length, transform, weights, buffer, powers, .. } = self;
        for (k, (slot, weight)) in buffer.iter_mut().zip(&*weights).enumerate() {
            *slot = (weight * first[k], second.map_or(0.0, |second| weight * second[k]));
        }
        transform.apply(buffer);
        for (j, power) in (FIRST..).zip(powers.iter_mut()) {
            // The real series' transform is the even part, the imaginary one's the odd part.
            let ((re, im), (mirrored_re, mirrored_im)) = (buffer[j], buffer[*length - j]);
            let (even_re, even_im) = (re + mirrored_re, im - mirrored_im);
            let (odd_re, odd_im) = (im + mirrored_im, re - mirrored_re);
            power[0] = 0.25 * (even_re * even_re + even_im * even_im);
            power[1] = 0.25 * (odd_re * odd_re + odd_im * odd_im);
        }
        powers
    }
}

/// The first samples of as many windows as fit one after the other into ranges. Adjacent ranges count as one.
fn window_begins(kept: &[Range<usize>], length: usize) -> Vec<usize> {
    let mut begins = Vec::new();
    let mut run = 0..0;
    for range in kept {
        run = if range.start == run.end { run.start..range.end } else { range.clone() };
        while run.start + length <= run.end {
            begins.push(run.start);
            run.start += length;
        }
    }
    begins
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mathematics::random::Normal;

    #[test]
    fn white_noise_is_flat_and_a_wave_is_a_line() {
        let mut normal = Normal::from_seed(3);
        let noise: Vec<f64> = (0..8192).map(|_| normal.sample()).collect();
        let wave: Vec<f64> = (0..8192).map(|k| noise[k] + libm::sin(0.7 * k as f64)).collect();
        let [flat, line] = &Periodogram::of_all(&[&noise, &wave], &[0..3000, 3000..8192])[..] else { panic!() };
        assert!((flat.mean() - 1.0).abs() < 0.05 && flat.peak().unwrap().0 < 4.0, "{:?}", flat.peak());
        let (power, frequency) = line.peak().unwrap();
        assert!(power > 50.0 && (frequency - 0.7).abs() < 0.002, "{power} at {frequency}");
        let alone = &Periodogram::of_all(&[&wave], std::slice::from_ref(&(0..8192)))[0];
        assert!((alone.peak().unwrap().0 / power - 1.0).abs() < 1e-9);
        assert_eq!(Periodogram::of_all(&[&noise[..100]], std::slice::from_ref(&(0..100)))[0].peak(), None);
    }
}
