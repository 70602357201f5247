//! The shapes of columns of numbers: counters, axes of which one moves most, the three axes of an accelerometer, and angles that wrap.

use std::f64::consts::{PI, TAU};

use kalmanscope_filters::lists::median;

use super::conditioning::is_still;
use super::header::{Dimension, STANDARD_GRAVITY, unit};
use super::{Column, Mapping, Table};
use crate::resample::mean;

pub(super) fn never_changes(values: &[f64]) -> bool {
    values.iter().filter(|value| !value.is_nan()).count() > 2 && is_still(values)
}

/// Steps are one, except at lost rows; a named counter may have others, or none within a packet.
pub(super) fn is_counter(values: &[f64], is_named: bool) -> bool {
    let steps: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| !step.is_nan()).collect();
    let Some(step) = median(steps.clone()) else { return false };
    let share = |is: &dyn Fn(f64) -> bool| steps.iter().filter(|step| is(**step)).count() * 10 / steps.len();
    let is_whole = values.iter().all(|value| value.is_nan() || value.fract() == 0.0);
    let rises = step == 1.0 && share(&|one| one == step) >= 6 && (is_named || steps.len() > 8);
    is_whole && (rises || (is_named && share(&|one| one >= 0.0) >= 9))
}

const ENDS: [f64; 11] =
    [100.0, 256.0, 1000.0, 1024.0, 4096.0, 10_000.0, 65_536.0, 1e5, 1e6, 16_777_216.0, 4_294_967_296.0];

/// A counter of samples without a meaning, at `rate` a second, with lost rows: its name, and the times of the rows \[s\].
pub(super) fn counted(table: &Table, mapping: &Mapping, rate: f64) -> Option<(String, Vec<f64>)> {
    let has_meaning = |name: &str| mapping.columns().any(|of| of.column == name);
    table.columns.iter().filter(|column| !has_meaning(&column.name)).find_map(|column| {
        let values = &column.values;
        let most = values.iter().fold(0.0, |a: f64, b| a.max(*b));
        let end = ENDS.into_iter().find(|end| (0.9 * end..*end).contains(&most)).unwrap_or(0.0);
        let risen = |pair: &[f64]| pair[1] - pair[0] + if pair[1] < pair[0] { end } else { 0.0 };
        let steps: Vec<f64> = values.windows(2).map(risen).collect();
        let step = median(steps.clone())?;
        let is_counter = step.fract() == 0.0 && steps.iter().all(|one| *one >= step && one % step == 0.0);
        let single = steps.iter().filter(|one| **one == step).count();
        if !(is_counter && step > 0.0 && single < steps.len() && 2 * single > steps.len()) {
            return None;
        }
        let later = steps.iter().scan(0.0, |sum, one| {
            *sum += one / step;
            Some(*sum / rate)
        });
        Some((column.name.clone(), std::iter::once(0.0).chain(later).collect()))
    })
}

pub(super) fn liveliness(values: &[f64]) -> f64 {
    let [_, one, two] = covariances(values);
    one.max(two.abs())
}

pub(super) fn is_noise(values: &[f64]) -> bool {
    let [own, one, two] = covariances(values);
    one.max(two.abs()) < 0.3 * own
}

fn covariances(values: &[f64]) -> [f64; 3] {
    let there: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    let count = there.len().max(1) as f64;
    let mean = there.iter().sum::<f64>() / count;
    let lag = |k: usize| there.windows(k + 1).map(|part| (part[0] - mean) * (part[k] - mean)).sum::<f64>() / count;
    [lag(0), lag(1), lag(2)]
}

/// `Acceleration x`, `accelY`, `az`, `z`, `acc[0]`, `acc 0`
pub(super) fn are_axes(one: &str, other: &str) -> bool {
    let [one, other] = [one, other].map(|name| name.to_lowercase().chars().collect::<Vec<char>>());
    let mut differ = (0..one.len()).filter(|&place| other.get(place) != Some(&one[place]));
    let Some(place) = differ.next().filter(|_| one.len() == other.len()) else { return false };
    let pair = [one[place], other[place]];
    let is_counted = place > 0 && (one[place - 1] == '[' || (" _.".contains(one[place - 1]) && pair.contains(&'0')));
    let is_index = is_counted && pair.iter().all(|c| ('0'..='2').contains(c));
    differ.next().is_none() && (is_index || pair.iter().all(|c| ('x'..='z').contains(c)))
}

pub(super) fn plain(name: &str) -> String {
    name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

/// The unit \[m/s²\] in which the mean has the length of gravity.
pub(super) fn gravity(columns: &[Column], axes: [usize; 3], units: [f64; 2]) -> Option<f64> {
    let length = axes.map(|axis| mean(&columns[axis].values)).iter().map(|mean| mean * mean).sum::<f64>().sqrt();
    units.into_iter().find(|unit| (0.85..1.15).contains(&(unit * length / STANDARD_GRAVITY)))
}

/// Turns in degrees, radians, gon and their parts, and counts of encoders.
const RANGES: [f64; 16] = [
    TAU, 360.0, 180.0, PI, 1.0, 400.0, 3600.0, 36_000.0, 500.0, 1000.0, 2000.0, 2400.0, 2500.0, 4000.0, 5000.0,
    10_000.0,
];

/// `None` where no angle wraps.
pub(super) fn unwrapped(table: &Table, mapping: &Mapping, remarks: &mut Vec<String>) -> Option<Table> {
    let mut changed: Option<Table> = None;
    for mapped in mapping.sensors.values() {
        let is_other = !matches!(unit(&mapped.unit), None | Some((Dimension::Angle, _)));
        let Some(place) = table.place(&mapped.column).filter(|_| !is_other) else { continue };
        let rows: Vec<(usize, f64)> = table.columns[place].values.iter().copied().enumerate().collect();
        let is_there = |(_, value): &(usize, f64)| value.is_finite() && Some(*value) != mapped.missing;
        let (rows, values): (Vec<usize>, Vec<f64>) = rows.into_iter().filter(is_there).unzip();
        let powers = (8..=32).map(|bits| f64::from(bits).exp2());
        let of = |range: f64| Some((range, run_on(&values, range)?));
        let all = RANGES.into_iter().chain(powers).filter_map(of);
        let Some((range, (whole, jumps, _))) = all.min_by(|(_, (.., a)), (_, (.., b))| a.total_cmp(b)) else {
            continue;
        };
        let new = changed.get_or_insert_with(|| table.clone());
        rows.iter().zip(whole).for_each(|(row, value)| new.columns[place].values[*row] = value);
        let (name, line) = (&mapped.column, table.line(rows[jumps[0]]));
        let range = if range.fract() == 0.0 { range.to_string() } else { format!("{range:.4}") };
        let jumps = format!("`{name}` jumps by {range} {} time(s), the first in line {line}", jumps.len());
        remarks.push(jumps + ", and moves on evenly otherwise: an angle that wraps; it is unwrapped");
    }
    changed
}

/// Returns also the places of the jumps, and the largest change of the step at one.
fn run_on(values: &[f64], range: f64) -> Option<(Vec<f64>, Vec<usize>, f64)> {
    let ends = |values: &[f64]| values.iter().fold([f64::INFINITY, -f64::INFINITY], |[a, b], x| [a.min(*x), b.max(*x)]);
    let [low, high] = ends(values);
    // Rounding may reach the end.
    let within = 1.001 * range;
    let fits = (low >= 0.0 && high <= within) || (low >= -0.5 * within && high <= 0.5 * within);
    if !fits || high - low < 0.75 * range {
        return None;
    }
    let (mut turns, mut jumps, mut whole) = (0.0, Vec::new(), values.to_vec());
    for (place, pair) in values.windows(2).enumerate() {
        let turn = libm::round((pair[0] - pair[1]) / range);
        if turn != 0.0 {
            turns += turn;
            jumps.push(place + 1);
        }
        whole[place + 1] += turns * range;
    }
    let step = |place: usize| whole.get(place).map_or(0.0, |x| x - whole[place - 1]);
    let most = (1..whole.len()).map(|place| step(place).abs()).fold(0.0, f64::max);
    let change = |place: &usize| (step(*place) - 0.5 * (step((place - 1).max(1)) + step(place + 1))).abs();
    let worst = jumps.iter().map(change).fold(0.0, f64::max);
    // A square wave with noise jumps too, but does not move between its jumps.
    let [low, high] = ends(&whole);
    (!jumps.is_empty() && most < range / 3.0 && most < 0.5 * (high - low)).then_some((whole, jumps, worst))
}
