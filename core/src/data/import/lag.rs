//! How much later a second file's clock is, from what both files measured of one oscillator.
//!
//! ```text
//! input ──H(ω; ωₙ, ζ)──▶ prediction ┐
//! sensor ──(iω)ⁿ───────▶ prediction ┴─ correlation with the other file's sensor at each lag ──▶ the largest one
//! ```

use std::f64::consts::TAU;
use std::fmt;

use super::files::{Clock, Joined, apart, join, known};
use super::samples::fill;
use super::{ImportError, Mapping, Table};
use crate::Quantity;
use crate::mathematics::fourier::Transform;

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

/// The offset between two clocks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClockOffset {
    /// What is to be added to the times of the second file \[s\].
    pub seconds: f64,
    /// How well both files agree then: 1 if one predicts the other without an error.
    pub correlation: f64,
    /// Whether they have opposite signs.
    pub is_turned: bool,
}

/// How well two files agree, by the columns that do so best.
#[derive(Clone, Debug, PartialEq)]
pub struct Agreement {
    /// The offset between their clocks.
    pub offset: ClockOffset,
    /// The column of each file.
    pub columns: [String; 2],
}

impl Agreement {
    /// The agreement of two files. `meaning` tells what the columns of both mean, each by its name in a table that has all.
    ///
    /// # Errors
    /// [`ImportError`] where a file has no usable times, or where no two columns tell an offset.
    pub fn of(tables: [&Table; 2], meaning: impl FnOnce(&Table) -> Mapping) -> Result<Self, ImportError> {
        // What the columns mean does not depend on their times: begin both at the same one.
        let Joined { table, sources } = join(tables[0], tables[1], apart(tables)?)?;
        let mapping = meaning(&table);
        let source = |column: &str| sources.get(table.place(column)?.checked_sub(1)?);
        let told: Vec<(&(bool, String), Option<Quantity>)> = (mapping.input.iter().map(|input| (&input.column, None)))
            .chain(mapping.sensors.iter().map(|(quantity, sensor)| (&sensor.column, Some(*quantity))))
            .filter_map(|(column, measures)| Some((source(column)?, measures)))
            .collect();
        let of = |is_second: bool| {
            let table = tables[usize::from(is_second)];
            let own = told.iter().filter(move |((second, _), _)| *second == is_second);
            own.map(move |((_, column), measures)| Clocked { table, column, measures: *measures })
        };
        let mut best: Option<Self> = None;
        let mut reason = ImportError::NoCommonSignal;
        for (first, second) in of(false).flat_map(|first| of(true).map(move |second| (first, second))) {
            match ClockOffset::between(first, second) {
                Ok(offset) if best.as_ref().is_none_or(|best| offset.correlation > best.offset.correlation) => {
                    best = Some(Self { offset, columns: [first.column.to_owned(), second.column.to_owned()] });
                }
                Ok(_) => {}
                Err(error) => reason = error,
            }
        }
        best.ok_or(reason)
    }
}

impl fmt::Display for Agreement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { offset: ClockOffset { seconds, correlation, is_turned }, columns: [first, second] } = self;
        write!(
            f,
            "{seconds:.4} s are added to the times of the second file: then `{first}` and `{second}` agree best, with a correlation of {correlation:.2}"
        )?;
        if *is_turned { f.write_str(", with opposite signs: one of them is turned") } else { Ok(()) }
    }
}

/// Less than this correlation is no agreement.
const LEAST: f64 = 0.35;

/// The correlation at other lags, further away than a swing, that makes an answer doubtful, as a share of the largest one.
const DOUBTFUL: f64 = 0.97;

/// Limits the samples of each file that are looked at.
const MOST: usize = 1 << 16;

/// The band around the strongest swing in which two sensors are compared, in its frequencies.
const BAND: [f64; 2] = [0.3, 3.0];

/// The natural frequencies, in those of the strongest swing, and the damping ratios with which a search begins.
const FREQUENCIES: [f64; 7] = [0.85, 0.9, 0.95, 1.0, 1.05, 1.1, 1.15];
const DAMPINGS: [f64; 4] = [0.005, 0.02, 0.06, 0.15];

/// The search ends at steps of this share of a parameter.
const FINE: f64 = 2e-5;

impl ClockOffset {
    /// The offset with which the sensor of one file is best predicted from the sensor or the input of the other.
    ///
    /// # Errors
    /// [`ImportError`] where a file has no usable times or lacks the column, or where nothing is predicted.
    pub fn between(first: Clocked<'_>, second: Clocked<'_>) -> Result<Self, ImportError> {
        let none = || ImportError::NoOffset { first: first.column.to_owned(), second: second.column.to_owned() };
        let clocks = [Clock::of(first.table, &mut Vec::new())?, Clock::of(second.table, &mut Vec::new())?];
        let dt = clocks.iter().map(|clock| clock.timing.dt).fold(f64::INFINITY, f64::min);
        let longest = clocks.iter().map(|clock| clock.ends()[1] - clock.ends()[0]).fold(0.0, f64::max);
        let dt = dt.max(longest / MOST as f64);
        let spectra = Spectra::new([(&clocks[0], first), (&clocks[1], second)], dt)?;
        let starts = [clocks[0].ends()[0], clocks[1].ends()[0]];
        // Predicts the second column from the first one, or the first one from the second if that is the input.
        let from_second = second.measures.is_none();
        let order = |of: Clocked<'_>| of.measures.and_then(order);
        let peak = match (order(first), order(second)) {
            (Some(a), Some(b)) => spectra.best(0, &spectra.differentiated(b - a), true),
            (None, Some(order)) => spectra.search(0, order),
            (Some(order), None) => spectra.search(1, order),
            (None, None) => None,
        };
        let Peak { lag, correlation, others } = peak.ok_or_else(none)?;
        if correlation.abs() < LEAST || others > DOUBTFUL * correlation.abs() {
            return Err(none());
        }
        let later = lag * dt * if from_second { -1.0 } else { 1.0 };
        Ok(Self {
            seconds: starts[0] - starts[1] - later,
            correlation: correlation.abs(),
            is_turned: correlation < 0.0,
        })
    }
}

/// How often what a sensor measures is a derivative of the displacement; `None` for an angle and the like.
fn order(measures: Quantity) -> Option<i32> {
    [Quantity::DISPLACEMENT, Quantity::VELOCITY, Quantity::ACCELERATION]
        .iter()
        .position(|quantity| *quantity == measures)
        .map(|place| place as i32)
}

/// A complex number.
type Complex = (f64, f64);

fn times((a, b): Complex, (c, d): Complex) -> Complex {
    (a * c - b * d, a * d + b * c)
}

/// The largest correlation.
#[derive(Clone, Copy, Debug)]
struct Peak {
    /// By how many steps the predicted one comes later.
    lag: f64,
    correlation: f64,
    /// The largest size at lags further away than a swing.
    others: f64,
}

/// The spectra of both columns.
struct Spectra {
    transform: Transform,
    both: [Vec<Complex>; 2],
    dt: f64,
    /// The angular frequency of the strongest swing \[rad/s\].
    swing: f64,
}

impl Spectra {
    fn new(columns: [(&Clock<'_>, Clocked<'_>); 2], dt: f64) -> Result<Self, ImportError> {
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
    fn differentiated(&self, order: i32) -> impl Fn(f64) -> Complex {
        move |w: f64| {
            let size = if w == 0.0 { 0.0 } else { w.abs().powi(order) };
            let turn = [(1.0, 0.0), (0.0, w.signum()), (-1.0, 0.0), (0.0, -w.signum())][order.rem_euclid(4) as usize];
            (size * turn.0, size * turn.1)
        }
    }

    /// The largest correlation of the other column with what is predicted from that at a place by a response. Two sensors are
    /// compared in a band around the swing.
    fn best(&self, from: usize, response: &dyn Fn(f64) -> Complex, in_a_band: bool) -> Option<Peak> {
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

    /// The largest correlation with the response of an oscillator to the input at a place, over its frequency and damping.
    fn search(&self, input: usize, order: i32) -> Option<Peak> {
        let derivative = self.differentiated(order);
        let look = |frequency: f64, damping: f64| {
            let response = |w: f64| {
                // 1 / (ωₙ² - ω² + 2iζωₙω)
                let (re, im) = (frequency * frequency - w * w, 2.0 * damping * frequency * w);
                let square = re * re + im * im;
                times(derivative(w), (re / square, -im / square))
            };
            self.best(input, &response, false).filter(|peak| peak.correlation.is_finite())
        };
        let size = |peak: &Peak| peak.correlation.abs();
        let pairs = FREQUENCIES.iter().flat_map(|share| DAMPINGS.map(|damping| (share * self.swing, damping)));
        let begins = pairs.filter_map(|(frequency, damping)| Some((look(frequency, damping)?, [frequency, damping])));
        let (mut best, mut at) = begins.max_by(|(a, _), (b, _)| size(a).total_cmp(&size(b)))?;
        let mut steps = [0.03, 0.5];
        while steps[0] > FINE {
            let mut is_better = false;
            for axis in 0..2 {
                for sign in [1.0, -1.0] {
                    let mut next = at;
                    next[axis] *= libm::exp(sign * steps[axis]);
                    if let Some(peak) = look(next[0], next[1]).filter(|peak| size(peak) > size(&best)) {
                        (best, at, is_better) = (peak, next, true);
                    }
                }
            }
            if !is_better {
                steps = steps.map(|step| 0.5 * step);
            }
        }
        Some(best)
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
    let mean = super::samples::mean(&even);
    even.iter_mut().for_each(|value| *value -= mean);
    even
}
