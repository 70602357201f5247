//! An oscillator under the recorded input, fitted to the readings over time: of a record with few periods, spectra are too coarse.

use std::f64::consts::TAU;

use kalmanscope_filters::least_squares::{NormalEquations, descend};
use kalmanscope_filters::lists::{mapped, numbers, sort_items};
use kalmanscope_filters::{Hold, Quantity};
use kalmanscope_records::Record;

use super::moments;
use super::response::{MeasuredResponse, is_within, order, relative};
use super::spectra::stride;

const MOST: usize = 4096;
const FEWEST: usize = 48;
/// Of the periods in a record at least, and of the samples in a period: two are the Nyquist frequency.
const PERIODS: f64 = 3.0;
const SAMPLES: f64 = 2.2;
/// The frequencies of the first look are this far apart, and have these damping ratios: a broad resonance has no neighbours between.
const APART: f64 = 1.04;
const DAMPING: [f64; 2] = [0.05, 0.2];
const BEGINS: usize = 6;
const TRIES: usize = 30;
/// The largest share of the power that the fit leaves, and the least gain in its standard deviations.
const UNEXPLAINED: f64 = 0.5;
const CERTAIN: f64 = 6.0;

struct Readings {
    /// In units of their sizes.
    values: Vec<f64>,
    force: Vec<f64>,
    dt: f64,
    hold: Hold,
    order: i32,
}

type Complex = nalgebra::Complex<f64>;
type Place = [f64; 2];
/// The columns of a sample, and the parts that fit best: of the response to the input from rest, of a free decay, and constant.
type Parts = [f64; 4];

impl Readings {
    /// The columns of every sample, by the exact motion from sample to sample:
    /// ```text
    /// q' = λq + u,  λ = -ζωₙ + iω_d,  x = Im q / ω_d,  v = Im λq / ω_d,  a = Im λ²q / ω_d + u
    /// ```
    fn columns(&self, at: &Place) -> Vec<Parts> {
        let [wn, zeta] = at.map(libm::exp);
        let (rate, damped) = (zeta * wn, wn * libm::sqrt(1.0 - zeta * zeta));
        let pole = Complex::new(-rate, damped);
        let (sin, cos) = libm::sincos(damped * self.dt);
        let turn = Complex::new(cos, sin) * libm::exp(-rate * self.dt);
        let inverse = pole.conj() / (wn * wn);
        let held = (turn - 1.0) * inverse;
        let ramp = (held / self.dt - 1.0) * inverse;
        let read = [Complex::ONE, pole, pole * pole][self.order as usize];
        let (mut q, mut free, mut columns) = (Complex::ZERO, Complex::ONE, Vec::with_capacity(self.values.len()));
        for (k, &force) in self.force.iter().enumerate() {
            let felt = if self.order == 2 { force } else { 0.0 };
            columns.push([(read * q).im / damped + felt, free.re, free.im, 1.0]);
            let next = self.force.get(k + 1).filter(|_| self.hold == Hold::First).map_or(0.0, |next| next - force);
            q = turn * q + held * force + ramp * next;
            free = turn * free;
        }
        columns
    }

    fn rows<'a>(&'a self, columns: &'a [Parts]) -> impl Iterator<Item = (usize, &'a Parts, f64)> {
        let all = columns.iter().zip(&self.values).enumerate();
        all.filter(|(_, (_, value))| !value.is_nan()).map(|(k, (columns, value))| (k, columns, *value))
    }

    fn normal(&self, columns: &[Parts]) -> NormalEquations<4> {
        let mut equations = NormalEquations::zero();
        self.rows(columns).for_each(|(_, columns, value)| equations.add(*columns, value, 1.0));
        equations
    }

    fn fit(&self, at: &Place) -> (f64, (Vec<Parts>, Parts)) {
        let columns = self.columns(at);
        // A constant force has the column of the constant: a trace of damping keeps a solution.
        let Some(parts) = self.normal(&columns).damped(1e-12, 1e-12).solution() else {
            return (f64::INFINITY, (columns, [0.0; 4]));
        };
        let cost = self.rows(&columns).map(|(_, columns, value)| square(value - dot(columns, &parts))).sum();
        (cost, (columns, parts))
    }

    fn equations(&self, at: &Place, (columns, parts): &(Vec<Parts>, Parts)) -> NormalEquations<6> {
        const CHANGE: f64 = 1e-6;
        let near = [[at[0] + CHANGE, at[1]], [at[0], at[1] + CHANGE]].map(|near| self.columns(&near));
        let mut equations = NormalEquations::zero();
        for (k, columns, value) in self.rows(columns) {
            let model = dot(columns, parts);
            let [by_frequency, by_damping] = [&near[0], &near[1]].map(|near| (dot(&near[k], parts) - model) / CHANGE);
            let [input, re, im, one] = *columns;
            equations.add([by_frequency, by_damping, input, re, im, one], value - model, 1.0);
        }
        equations
    }

    fn descend(&self, begin: Place) -> (f64, Place) {
        let step = |at: &Place, by: [f64; 6]| {
            let zeta = (at[1] + by[1].clamp(-1.0, 1.0)).clamp(libm::log(1e-4), libm::log(0.9));
            Some([at[0] + by[0].clamp(-0.1, 0.1), zeta])
        };
        descend(begin, (TRIES, 1e-9), |cost| 1e-7 * cost, |at| self.fit(at), |at, k| self.equations(at, k), step)
    }

    fn begins(&self, low: f64, high: f64) -> Vec<Place> {
        let count = (libm::log(high / low) / libm::log(APART)).max(1.0) as usize;
        let mut found = Vec::new();
        for damping in DAMPING.map(libm::log) {
            let at = |i: usize| [libm::log(low) + i as f64 * libm::log(APART), damping];
            let costs: Vec<f64> = numbers(count + 1, &|i| self.fit(&at(i)).0);
            let is_least =
                |i: &usize| costs[i.saturating_sub(1)..(*i + 2).min(costs.len())].iter().all(|c| costs[*i] <= *c);
            found.extend((0..=count).filter(is_least).map(|i| (costs[i], at(i))));
        }
        sort_items(&mut found, |a, b| a.0.total_cmp(&b.0));
        found.into_iter().take(BEGINS).map(|(_, at)| at).collect()
    }
}

fn square(x: f64) -> f64 {
    x * x
}

fn dot(a: &Parts, b: &Parts) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The oscillator that explains most of the readings, by least squares, from the motion at the record's beginning and the input:
/// ```text
/// y = g (h * u) + exp(-ζωₙt) (a cos ω_d t + b sin ω_d t) + c
/// ```
/// `band` is in \[Hz\]. `None` if the input does not explain the readings.
/// Source: Golub and Pereyra (1973), The differentiation of pseudo-inverses and nonlinear least squares problems whose variables
/// separate; Ljung (1999), *System Identification*, section 4.3 (output error).
pub(super) fn forced(
    record: &Record,
    quantity: Quantity,
    band: Option<[f64; 2]>,
    guess: Option<&MeasuredResponse>,
) -> Option<MeasuredResponse> {
    let measured = relative(record, quantity)?;
    let every = stride(&measured);
    // Where the frequency is about known and low, means over some samples do as well.
    let block = if guess.is_some() { measured.len().div_ceil(MOST) } else { 1 };
    let (samples, dt) = ((measured.len() / block).min(MOST), record.dt() * block as f64);
    let mean = |of: &dyn Fn(usize) -> f64, k: usize| {
        let there = (k * block..(k + 1) * block).map(of).filter(|value| !value.is_nan());
        let (sum, count) = there.fold((0.0, 0_u32), |(sum, count), value| (sum + value, count + 1));
        sum / f64::from(count)
    };
    let measured: Vec<f64> = numbers(samples, &|k| mean(&|i| measured[i], k));
    let force: Vec<f64> = numbers(samples, &|k| mean(&|i| record.force(i), k));
    let ((mean, size), (middle, strength)) = (moments(&measured), moments(&force));
    let there = measured.iter().filter(|value| !value.is_nan()).count();
    if there < FEWEST || !(size > 0.0 && strength > 0.0) {
        return None;
    }
    let readings = Readings {
        values: mapped(&measured, &|value| (value - mean) / size),
        force: mapped(&force, &|value| (value - middle) / strength),
        dt,
        hold: if block == 1 { record.hold() } else { Hold::First },
        order: order(quantity),
    };
    let (low, high) = (PERIODS / (dt * samples as f64), 1.0 / (SAMPLES * every as f64 * dt));
    let [low, high] = band.map_or([low, high], |[from, to]| [low.max(from), high.min(to)]).map(|hertz| TAU * hertz);
    let begins = if low < high { readings.begins(low, high) } else { Vec::new() };
    let guess = guess.map(|guess| [guess.natural_frequency, guess.damping_ratio.clamp(1e-3, 0.8)].map(libm::log));
    let found = begins.into_iter().chain(guess).map(|begin| readings.descend(begin));
    let (cost, at) = found.filter(|(cost, _)| cost.is_finite()).min_by(|a, b| a.0.total_cmp(&b.0))?;
    let (_, (columns, parts)) = readings.fit(&at);
    let [wn, zeta] = at.map(libm::exp);
    let variance = cost / there.saturating_sub(6).max(1) as f64;
    let [of_gain, ..] = readings.normal(&columns).variances()?;
    let is_certain = square(parts[0]) > square(CERTAIN) * variance * of_gain;
    let is_sound = cost < UNEXPLAINED * there as f64 && zeta < 0.8 && is_within(band, wn);
    let gain = Some(parts[0] * size / strength);
    (is_certain && is_sound).then_some(MeasuredResponse { natural_frequency: wn, damping_ratio: zeta.max(1e-3), gain })
}
