//! The correlation of two files' columns at each lag.

use std::f64::consts::TAU;

use super::files::{Clock, known};
use super::samples::{fill, mean};
use super::{ImportError, Table};
use crate::Quantity;
use crate::mathematics::fourier::Transform;

/// The band around the strongest swing in which two sensors are compared, in its frequencies.
const BAND: [f64; 2] = [0.3, 3.0];

/// A column of a file that tells of the oscillator.
#[derive(Clone, Copy, Debug)]
pub struct Clocked<'a> {
    /// The file.
    pub table: &'a Table,
    /// The column's name.
    pub column: &'a str,
    /// What its sensor measures; `None` for the input.
    pub measures: Option<Quantity>,
}

/// A complex number.
pub(super) type Complex = (f64, f64);

pub(super) fn times((a, b): Complex, (c, d): Complex) -> Complex {
    (a * c - b * d, a * d + b * c)
}

/// The largest correlation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Peak {
    /// The other column comes so many steps later than its prediction.
    pub(super) lag: f64,
    pub(super) correlation: f64,
    /// The largest size at lags further away than a swing.
    pub(super) others: f64,
}

/// The spectra of both columns.
pub(super) struct Spectra {
    transform: Transform,
    both: [Vec<Complex>; 2],
    dt: f64,
    /// The angular frequency of the strongest swing \[rad/s\].
    pub(super) swing: f64,
}

impl Spectra {
    pub(super) fn new(columns: [(&Clock<'_>, Clocked<'_>); 2], dt: f64) -> Result<Self, ImportError> {
        let mut signals = Vec::new();
        for (clock, Clocked { table, column, .. }) in columns {
            let place = table.place(column).ok_or_else(|| ImportError::Column {
                missing: column.to_owned(),
                found: table.columns.iter().map(|column| column.name.as_str()).collect::<Vec<_>>().join(", "),
            })?;
            signals.push(even(clock, &table.columns[place].values, dt));
        }
        let length = (signals[0].len() + signals[1].len()).next_power_of_two();
        let transform = Transform::new(length);
        let spectrum = |signal: &Vec<f64>| {
            let mut values: Vec<Complex> = signal.iter().map(|value| (*value, 0.0)).collect();
            values.resize(length, (0.0, 0.0));
            transform.apply(&mut values);
            values
        };
        let both = [spectrum(&signals[0]), spectrum(&signals[1])];
        // A slow drift is no swing: at least three of them are in a file.
        let shortest = signals.iter().map(Vec::len).min().unwrap_or(1);
        let first = 3 * length / shortest.max(1);
        let product = |k: usize| {
            let size = |(re, im): Complex| libm::hypot(re, im);
            size(both[0][k]) * size(both[1][k])
        };
        let strongest = (first.max(1)..length / 2).max_by(|&a, &b| product(a).total_cmp(&product(b))).unwrap_or(1);
        let swing = TAU * strongest as f64 / (length as f64 * dt);
        Ok(Self { transform, both, dt, swing })
    }

    /// The angular frequency of a line \[rad/s\].
    fn frequency(&self, line: usize) -> f64 {
        let length = self.both[0].len();
        let place = if line <= length / 2 { line as f64 } else { line as f64 - length as f64 };
        TAU * place / (length as f64 * self.dt)
    }

    /// The derivative of some order, or the integral of a negative one.
    pub(super) fn differentiated(order: i32, w: f64) -> Complex {
        let size = if w == 0.0 { 0.0 } else { w.abs().powi(order) };
        let turn = [(1.0, 0.0), (0.0, w.signum()), (-1.0, 0.0), (0.0, -w.signum())][order.rem_euclid(4) as usize];
        (size * turn.0, size * turn.1)
    }

    /// The largest correlation of the other column with what is predicted from that at a place by a response. Two sensors are
    /// compared in a band around the swing.
    pub(super) fn best(&self, from: usize, response: &dyn Fn(f64) -> Complex, in_a_band: bool) -> Option<Peak> {
        let [input, output] = [&self.both[from], &self.both[1 - from]];
        let length = input.len();
        let (mut squares, mut product) = ([0.0; 2], Vec::with_capacity(length));
        for k in 0..length {
            let w = self.frequency(k);
            let is_out = in_a_band && !(BAND[0] * self.swing..=BAND[1] * self.swing).contains(&w.abs());
            if k == 0 || is_out {
                product.push((0.0, 0.0));
                continue;
            }
            let predicted = times(input[k], response(w));
            squares[0] += predicted.0 * predicted.0 + predicted.1 * predicted.1;
            squares[1] += output[k].0 * output[k].0 + output[k].1 * output[k].1;
            // The transform of the conjugate is the inverse one.
            let (re, im) = times(output[k], (predicted.0, -predicted.1));
            product.push((re, -im));
        }
        let size = libm::sqrt(squares[0] * squares[1]);
        if !(size > 0.0 && size.is_finite()) {
            return None;
        }
        self.transform.apply(&mut product);
        let at = |lag: isize| product[lag.rem_euclid(length as isize) as usize].0 / size;
        let half = (length / 2) as isize;
        let largest = (-half..half).max_by(|&a, &b| at(a).abs().total_cmp(&at(b).abs()))?;
        let [before, peak, after] = [-1, 0, 1].map(|by| at(largest + by));
        let bend = before - 2.0 * peak + after;
        let shift = if bend == 0.0 { 0.0 } else { (0.5 * (before - after) / bend).clamp(-0.5, 0.5) };
        let swing = (TAU / (self.swing * self.dt)) as isize;
        let others = (-half..half).filter(|lag| (lag - largest).abs() > swing / 4 && at(*lag) * peak > 0.0);
        let others = others.map(|lag| at(lag).abs()).fold(0.0, f64::max);
        Some(Peak { lag: largest as f64 + shift, correlation: peak - 0.25 * (before - after) * shift, others })
    }
}

/// The values at even steps from the first time on, without their mean. Steps that are longer than the file's have the mean of
/// what is in them.
fn even(clock: &Clock<'_>, values: &[f64], dt: f64) -> Vec<f64> {
    let (times, values) = known(&clock.times, values, 0.0);
    let [first, last] = clock.ends();
    let count = libm::floor((last - first) / dt) as usize + 1;
    let mut even = if dt > 1.5 * clock.timing.dt {
        let (mut sums, mut counts) = (vec![0.0; count], vec![0.0; count]);
        for (time, value) in times.iter().zip(&values) {
            let place = (libm::round((time - first) / dt) as usize).min(count - 1);
            sums[place] += value;
            counts[place] += 1.0;
        }
        sums.iter().zip(&counts).map(|(sum, count)| sum / count).collect()
    } else {
        let mut row = 0;
        let at = |k: usize| {
            let time = first + dt * k as f64;
            while row + 2 < times.len() && times[row + 1] <= time {
                row += 1;
            }
            let [a, b] = [row, (row + 1).min(times.len() - 1)];
            let share = if b > a { ((time - times[a]) / (times[b] - times[a])).clamp(0.0, 1.0) } else { 0.0 };
            values[a] + share * (values[b] - values[a])
        };
        if times.is_empty() { vec![0.0; count] } else { (0..count).map(at).collect::<Vec<f64>>() }
    };
    fill(&mut even);
    let mean = mean(&even);
    even.iter_mut().for_each(|value| *value -= mean);
    even
}
