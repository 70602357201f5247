//! More samples, or fewer; readings that are carried to equal steps, and their noise; Butterworth filters run forward and backward.

use std::f64::consts::PI;

use kalmanscope_filters::Hold;
use kalmanscope_filters::least_squares::NormalEquations;
use kalmanscope_filters::lists::{mapped, median};

const REACH: isize = 32;
/// Side lobes below -80 dB.
const KAISER: f64 = 8.0;
/// As a share of the new Nyquist frequency.
pub(crate) const GUARD: f64 = 0.8;

/// All values must be finite.
pub fn anti_alias(values: &mut Vec<f64>, every: usize) {
    if every > 1 {
        band_pass(values, 0.0, GUARD * 0.5 / every as f64);
    }
}

pub fn keep_every(values: &mut Vec<f64>, every: usize) {
    *values = values.iter().step_by(every.max(1)).copied().collect();
}

/// A sinc under a Kaiser window; the original values stay; all must be finite. Source: Smith and Gossett (1984), A flexible
/// sampling-rate conversion method.
pub fn interpolate(values: &[f64], steps: usize) -> Vec<f64> {
    let n = values.len() as isize;
    if steps <= 1 || n < 2 {
        return values.to_vec();
    }
    let (first, last) = (values[0], values[values.len() - 1]);
    // Turned about the ends, so that value and slope continue.
    let at = |place: isize| match place {
        place if place < 0 => 2.0 * first - values[place.unsigned_abs().min(values.len() - 1)],
        place if place >= n => 2.0 * last - values[(2 * (n - 1) - place).max(0) as usize],
        place => values[place as usize],
    };
    let weights: Vec<Vec<f64>> = (1..steps).map(|step| kernel(step as f64 / steps as f64)).collect();
    let mut finer = Vec::with_capacity((values.len() - 1) * steps + 1);
    for k in 0..n - 1 {
        finer.push(values[k as usize]);
        for weights in &weights {
            let terms = weights.iter().zip(k - REACH + 1..).map(|(weight, place)| weight * at(place));
            finer.push(terms.sum());
        }
    }
    finer.push(last);
    finer
}

/// Lines through a swing have the share `sinc²(ωh/2) ≈ 1 - (ωh)²/12` of it: values between those of the file move outwards by as much.
pub fn finer_input(values: &[f64], steps: usize, hold: Hold) -> Vec<f64> {
    let curve = interpolate(values, steps);
    if steps <= 1 || hold == Hold::Zero {
        return curve;
    }
    let outwards = steps as f64 / (12.0 * (steps - 1) as f64);
    let mut finer = curve.clone();
    for (k, around) in curve.windows(3).enumerate().filter(|(k, _)| (k + 1) % steps != 0) {
        finer[k + 1] -= outwards * (around[2] - 2.0 * around[1] + around[0]);
    }
    finer
}

pub(crate) fn spread(values: &[f64], steps: usize) -> Vec<f64> {
    let mut finer = vec![f64::NAN; values.len().saturating_sub(1) * steps + values.len().min(1)];
    finer.iter_mut().step_by(steps).zip(values).for_each(|(fine, value)| *fine = *value);
    finer
}

fn kernel(share: f64) -> Vec<f64> {
    let weight = |place: isize| {
        let distance = share - place as f64;
        let window = distance / REACH as f64;
        let sinc = libm::sin(PI * distance) / (PI * distance);
        sinc * bessel(KAISER * libm::sqrt((1.0 - window * window).max(0.0))) / bessel(KAISER)
    };
    let weights: Vec<f64> = (1 - REACH..=REACH).map(weight).collect();
    let sum: f64 = weights.iter().sum();
    weights.into_iter().map(|weight| weight / sum).collect()
}

/// I₀, the modified Bessel function of the first kind.
fn bessel(x: f64) -> f64 {
    let (mut term, mut sum, mut k) = (1.0, 1.0, 0.0);
    while term > 1e-17 * sum {
        k += 1.0;
        term *= (0.5 * x / k) * (0.5 * x / k);
        sum += term;
    }
    sum
}

const ORDER: usize = 4;

#[derive(Clone, Copy, Debug)]
pub struct Section {
    pub b: [f64; 3],
    pub a: [f64; 2],
}

/// `cut` is a share of the sample rate below ½. Source: Oppenheim and Schafer (2010), *Discrete-Time Signal Processing*, section 7.2.
pub fn sections(is_low: bool, cut: f64) -> [Section; ORDER / 2] {
    let warped = libm::tan(PI * cut);
    std::array::from_fn(|k| {
        let damping = 2.0 * libm::sin(PI * (2 * k + 1) as f64 / (2 * ORDER) as f64);
        let (w, ww) = (damping * warped, warped * warped);
        let scale = 1.0 / (1.0 + w + ww);
        let b = if is_low { [ww * scale, 2.0 * ww * scale, ww * scale] } else { [scale, -2.0 * scale, scale] };
        Section { b, a: [2.0 * (ww - 1.0) * scale, (1.0 - w + ww) * scale] }
    })
}

impl Section {
    fn run(self, values: &mut [f64]) {
        let Self { b, a } = self;
        let Some(&first) = values.first() else { return };
        let steady = first * b.iter().sum::<f64>() / (1.0 + a[0] + a[1]);
        let mut second = b[2] * first - a[1] * steady;
        let mut one = b[1] * first - a[0] * steady + second;
        for value in values {
            let x = *value;
            let y = b[0] * x + one;
            one = b[1] * x - a[0] * y + second;
            second = b[2] * x - a[1] * y;
            *value = y;
        }
    }
}

/// Passes `low` (0: a low-pass) to `high` (½: a high-pass), shares of the sample rate, without a shift. All values must be finite.
pub fn band_pass(values: &mut Vec<f64>, low: f64, high: f64) {
    let high_pass = (low > 0.0).then(|| sections(false, low.min(0.499)));
    let all: Vec<Section> = high_pass.into_iter().chain((high < 0.5).then(|| sections(true, high))).flatten().collect();
    let slowest = [low, high].into_iter().filter(|&cut| cut > 0.0).fold(0.5, f64::min);
    let margin = (libm::ceil(3.0 / slowest) as usize).min(values.len().saturating_sub(1));
    if all.is_empty() || values.len() < 2 {
        return;
    }
    let end = values.len() - 1;
    let turned = |part: &[f64], about: f64| part.iter().rev().map(|value| 2.0 * about - value).collect::<Vec<f64>>();
    let (front, back) = (turned(&values[1..=margin], values[0]), turned(&values[end - margin..end], values[end]));
    let mut extended = [&front, &values[..], &back].concat();
    for _ in 0..2 {
        all.iter().for_each(|section| section.run(&mut extended));
        extended.reverse();
    }
    values.clear();
    values.extend_from_slice(&extended[margin..extended.len() - margin]);
}

/// Start and step in \[s\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steps {
    pub start: f64,
    pub dt: f64,
    pub count: usize,
}

impl Steps {
    pub(crate) fn seconds(self) -> f64 {
        self.count.saturating_sub(1) as f64 * self.dt
    }

    /// NaN at a step without a reading. `place` rounds times, in steps; the nearest reading counts, shifted by [`change`] with `side`.
    pub fn of(self, times: &[f64], values: &[f64], side: usize, place: impl Fn(f64) -> f64) -> Vec<f64> {
        let Self { start, dt, count } = self;
        let n = times.len();
        let side = side.min(n.saturating_sub(1) / 2);
        let mut nearest = vec![None; count];
        for (k, time) in times.iter().enumerate() {
            let steps = (time - start) / dt;
            let place = place(steps);
            if !(0.0..count as f64).contains(&place) {
                continue;
            }
            let (place, distance) = (place as usize, (steps - place).abs());
            if nearest[place].is_none_or(|(_, other)| distance < other) {
                nearest[place] = Some((k, distance));
            }
        }
        let at = |(place, reading): (usize, Option<(usize, f64)>)| {
            let Some((k, _)) = reading else { return f64::NAN };
            let first = k.saturating_sub(side).min(n - 1 - 2 * side);
            let around = first..=first + 2 * side;
            let shift = start + dt * place as f64 - times[k];
            let size = 0.5 * (times[first + 2 * side] - times[first]);
            let readings = times[around.clone()].iter().zip(&values[around]);
            values[k] + change(readings, times[k], shift, size)
        };
        nearest.into_iter().enumerate().map(at).collect()
    }
}

/// Change of the least-squares cubic through readings until `shift` later \[s\], or 0; `size` is about their time \[s\]. Noise stays white.
/// Source: Savitzky and Golay (1964), Smoothing and differentiation of data by simplified least squares procedures.
pub(crate) fn change<'a>(readings: impl Iterator<Item = (&'a f64, &'a f64)>, from: f64, shift: f64, size: f64) -> f64 {
    let mut equations = NormalEquations::<4>::zero();
    for (time, value) in readings {
        let u = (time - from) / size;
        equations.add([1.0, u, u * u, u * u * u], *value, 1.0);
    }
    let u = shift / size;
    equations.solution().map_or(0.0, |[_, first, second, third]| u * (first + u * (second + u * third)))
}

/// Share of half a swing, to either side, that a cubic follows; the fewest and the most readings there.
const FOLLOWED: f64 = 1.0 / 3.0;
const FEWEST: usize = 3;
const MOST: usize = 12;

/// In standard deviations of the noise: smaller readings have no sign.
pub const CLEAR: f64 = 3.0;

/// The readings to either side that a cubic through them needs.
pub(crate) fn side_of(times: &[f64], values: &[f64]) -> usize {
    let middle = mean(values);
    let around = mapped(values, &|value| value - middle);
    side(&around, noise_of(times, &around, 1.0))
}

pub fn side(values: &[f64], noise: f64) -> usize {
    ((FOLLOWED * half_swing(values, noise)) as usize).clamp(FEWEST, MOST)
}

pub fn half_swing(values: &[f64], noise: f64) -> f64 {
    let clear = values.iter().enumerate().filter(|(_, x)| x.abs() > CLEAR * noise);
    let mut turns: Vec<(usize, f64)> = clear.map(|(k, x)| (k, x.signum())).collect();
    turns.dedup_by_key(|(_, side)| *side);
    median(turns.windows(2).map(|pair| (pair[1].0 - pair[0].0) as f64).collect()).unwrap_or(0.0)
}

/// A part has at least one reading: above 2⁵³ s, adding a second changes nothing.
pub fn end_of_part(times: &[f64], place: usize, seconds: f64) -> usize {
    (place + 1..times.len()).find(|&k| times[k] >= times[place] + seconds).unwrap_or(times.len())
}

/// A slow swing has next to no third differences. Source: Hamming (1973), *Numerical Methods*, chapter 10.
pub fn noise_of(times: &[f64], along: &[f64], pace: f64) -> f64 {
    let (mut least, mut differences) = (f64::INFINITY, Vec::new());
    let mut place = 0;
    while place < times.len() {
        let next = end_of_part(times, place, pace);
        if next - place >= 10 && times[next - 1] - times[place] > 0.5 * pace {
            let values = &along[place..next];
            let middle = mean(values);
            let square = values.iter().map(|x| (x - middle) * (x - middle)).sum::<f64>();
            least = least.min(square / (values.len() - 1) as f64);
            let third = |x: &[f64]| (x[3] - 3.0 * x[2] + 3.0 * x[1] - x[0]).powi(2);
            // The squares of 1, 3, 3 and 1 add up to 20.
            differences.push(values.windows(4).map(third).sum::<f64>() / (20 * (values.len() - 3)) as f64);
        }
        place = next;
    }
    let least = least.min(median(differences).unwrap_or(f64::INFINITY));
    if least.is_finite() { least.sqrt() } else { 0.0 }
}

/// Of the values that are there.
pub fn mean(values: &[f64]) -> f64 {
    let there = values.iter().filter(|value| !value.is_nan());
    there.clone().fold(0.0, |sum, value| sum + value) / there.count().max(1) as f64
}
