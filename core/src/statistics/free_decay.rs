//! Free decays of an accelerometer that was plucked, and in the sound of a thing that was struck; the sweep of a printer.

mod modes;
mod ring;
mod sweep;

use std::fmt::Write as _;

use kalmanscope_filters::lists::{mapped, numbers, sort_items};
use kalmanscope_filters::{Hold, InputKind, Quantity};
use kalmanscope_records::record::LiveRecord;
use kalmanscope_records::resample::{CLEAR, Steps, end_of_part, half_swing, mean, noise_of, side};
use thiserror::Error;

pub use modes::Mode;
pub(crate) use modes::{ModeFit, highest};
pub use ring::Ring;
pub use sweep::Sweep;

/// The free decay of an oscillator along one axis.
///
/// Gravity, the mean under a Hann window, is taken away; the axis is that of the largest variance. The decay begins half a swing
/// after the largest reading and ends in noise, or before it grows. Its file ([`Self::file`]) has readings at their own times.
///
/// Source: Clough and Penzien (2003), *Dynamics of Structures*, section 2.6 (free vibration); Jolliffe (2002), *Principal
/// Component Analysis*, chapter 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Decay {
    /// From the beginning of the decay on, at equal steps \[s\].
    pub times: Vec<f64>,
    /// Along the axis, without its mean \[m/s²\]; NaN where readings are missing for a while.
    pub acceleration: Vec<f64>,
    /// The axis in the device's directions, of length one.
    pub axis: [f64; 3],
    /// The constant part along the axis, which is taken away: gravity's share, and the sensor's offset \[m/s²\].
    pub gravity: f64,
    /// The standard deviation of the noise along the axis \[m/s²\].
    pub noise: f64,
    /// The time of the first reading that is kept, in the clock of the readings \[s\].
    pub begin: f64,
    /// Time after the beginning \[s\], and acceleration \[m/s²\].
    readings: Vec<[f64; 2]>,
    /// Whether it has come to rest and rests at the end of the readings: there is nothing more to learn.
    pub rests: bool,
}

/// The reason why readings have no free decay.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum NoDecay {
    /// There are too few readings: their number, the time that they take \[s\], and the time that they take at least \[s\].
    #[error("there are {0} readings over {1:.2} s, but at least {MOST_FEW} over {2:.2} s are needed")]
    TooFew(usize, f64, f64),
    /// Nothing moved: the largest reading over the noise, and the noise \[m/s²\].
    #[error("nothing moved: the largest reading is {0:.1} times the noise of {1:.3} m/s²")]
    Still(f64, f64),
    /// A hand or a force moved it during the swing: the length of the longest free decay, and the length that it has at least \[s\].
    #[error("the free motion lasted only {0:.2} s, but at least {1:.2} s are needed: pull it and let go")]
    Short(f64, f64),
}

/// Limits a decay from below: readings, seconds, or swings if these take less.
const MOST_FEW: usize = 60;
const SHORTEST: f64 = 2.0;
const SWINGS: f64 = 4.0;

/// Limits the swing \[s\] for which the lengths below hold; a faster one has shorter parts and rests, in proportion.
const SLOW: f64 = 1.0 / 3.0;

const FASTEST: f64 = 5.0;

const LARGE: f64 = 1.0 / 3.0;

/// Limits the parts that are searched for decays: each takes all its readings.
const MOST_PARTS: usize = 64;

const SWING: f64 = 8.0;

/// \[s\]
const PART: f64 = 0.5;

/// In standard deviations of the noise; a part that grows by more than this and the factor below is no free decay.
const QUIET: f64 = 4.0;
const GROWTH: f64 = 1.4;

/// A hand has stopped a part smaller than the one before by this factor, if the one before is as far above the noise.
const STOPPED: f64 = 6.0;

/// Time without a swing \[s\].
const REST: f64 = 2.0;

impl Decay {
    /// The longest free decay in readings of time \[s\] and three accelerations \[m/s²\], gravity among them, in any order.
    ///
    /// # Errors
    /// [`NoDecay`].
    pub fn of(readings: &[[f64; 4]]) -> Result<Self, NoDecay> {
        let longest = |a: &Self, b: &Self| a.seconds().total_cmp(&b.seconds());
        Self::all(readings)?.into_iter().max_by(longest).ok_or(NoDecay::Short(0.0, SHORTEST))
    }

    /// Every free decay, in the order of time, with its own axis and gravity; looked for in 64 parts at most.
    ///
    /// # Errors
    /// [`NoDecay`] if there is none.
    pub fn all(readings: &[[f64; 4]]) -> Result<Vec<Self>, NoDecay> {
        let readings = in_order(readings);
        let pace = Pace::of(&readings);
        if pace.is_too_short(&readings) {
            return Err(NoDecay::TooFew(readings.len(), seconds(&readings), pace.shortest));
        }
        let (mut found, mut reasons) = (Vec::new(), Vec::new());
        let mut parts = std::collections::VecDeque::from([&readings[..]]);
        for _ in 0..MOST_PARTS {
            let Some(part) = parts.pop_front() else { break };
            let (decay, [before, after]) = Self::around_the_peak(part);
            match decay {
                Ok(decay) => found.push(decay),
                Err(reason) => reasons.push(reason),
            }
            parts.extend([before, after].into_iter().filter(|part| !Pace::of(part).is_too_short(part)));
        }
        sort_items(&mut found, |a, b| a.begin.total_cmp(&b.begin));
        let seconds = |reason: &NoDecay| if let NoDecay::Short(seconds, _) = reason { *seconds } else { -1.0 };
        match reasons.into_iter().rev().max_by(|a, b| seconds(a).total_cmp(&seconds(b))) {
            Some(reason) if found.is_empty() => Err(reason),
            _ => Ok(found),
        }
    }

    fn around_the_peak(readings: &[[f64; 4]]) -> (Result<Self, NoDecay>, [&[[f64; 4]]; 2]) {
        let Along { axis, times, gravity, along } = Along::of(readings);
        let pace = Pace::along(&times, &along);
        let noise = noise_of(&times, &along, pace.share);
        let peak = (0..along.len()).max_by(|&a, &b| along[a].abs().total_cmp(&along[b].abs())).unwrap_or(0);
        let ratio = along[peak].abs() / noise.max(f64::MIN_POSITIVE);
        if ratio < SWING {
            return (Err(NoDecay::Still(ratio, noise)), [&[], &[]]);
        }
        let crossing = |from: usize| (from + 1..along.len()).find(|&k| along[k] * along[from] < 0.0);
        // At the largest reading a hand may still be there.
        let begin = crossing(peak).and_then(crossing).unwrap_or(along.len() - 1);
        let (end, rests) = end(&times, &along, begin, noise, pace.share);
        let before = times.partition_point(|time| *time < times[peak] - PART * pace.share);
        let others = [&readings[..before], &readings[end.max(peak + 1)..]];
        let last = end.max(times.partition_point(|time| *time < times[times.len() - 1] - REST * pace.share));
        let rests = rests && along[last..].iter().all(|x| x.abs() <= SWING * noise);
        let kept = &readings[begin..end.max(begin)];
        if pace.is_too_short(kept) {
            return (Err(NoDecay::Short(seconds(kept), pace.shortest)), others);
        }
        let rest = middle(&along[begin..end]);
        let along: Vec<f64> = mapped(&along[begin..end], &|x| x - rest);
        let (measured, count) = (&times[begin..end], end - begin);
        let (begin, dt) = (measured[0], (measured[count - 1] - measured[0]) / (count - 1) as f64);
        let steps = Steps { start: begin, dt, count };
        // Along cubics: a jitter of a tenth of a step makes errors as large as the noise.
        let acceleration = steps.of(measured, &along, side(&along, noise), libm::round);
        let times = numbers(count, &|k| dt * k as f64);
        let readings = measured.iter().zip(&along).map(|(time, x)| [time - begin, *x]).collect();
        (Ok(Self { times, acceleration, axis, gravity: gravity + rest, noise, begin, readings, rests }), others)
    }

    /// How long it lasts \[s\].
    pub fn seconds(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }

    /// A reading of time \[s\] and three accelerations along the axis, without what is constant \[m/s²\].
    pub fn along(&self, [_, x, y, z]: [f64; 4]) -> f64 {
        self.axis[0] * x + self.axis[1] * y + self.axis[2] * z - self.gravity
    }

    /// An empty record for a decay that continues, with the same steps, for readings along the axis from [`Self::begin`] on.
    pub fn live(&self) -> LiveRecord {
        let n = self.times.len();
        let dt = self.seconds() / n.saturating_sub(1).max(1) as f64;
        let side = side(&self.acceleration, self.noise).min(n.saturating_sub(1) / 2);
        LiveRecord::new(dt, InputKind::Force, Hold::First, vec![Quantity::ACCELERATION]).smoothing(side)
    }

    /// The longest free decay in readings ([`Self::of`]), and all others along its axis that swing as fast, in the order of time.
    ///
    /// # Errors
    /// [`NoDecay`].
    pub fn alike(readings: &[[f64; 4]]) -> Result<Vec<Self>, NoDecay> {
        Ok(Self::groups(readings)?.remove(0))
    }

    /// All free decays, those that are alike together ([`Self::alike`]): the group of the longest one first. There is one group at least.
    ///
    /// # Errors
    /// [`NoDecay`].
    pub fn groups(readings: &[[f64; 4]]) -> Result<Vec<Vec<Self>>, NoDecay> {
        let (mut decays, mut groups) = (Self::all(readings)?, Vec::new());
        while let Some(longest) = decays.iter().max_by(|a, b| a.seconds().total_cmp(&b.seconds())).cloned() {
            let (alike, others) = decays.into_iter().partition(|decay| *decay == longest || decay.is_like(&longest));
            groups.push(alike);
            decays = others;
        }
        Ok(groups)
    }

    /// The cosine between its axis and that of another decay.
    pub fn cos(&self, other: &Self) -> f64 {
        self.axis.iter().zip(&other.axis).map(|(a, b)| a * b).sum()
    }

    fn is_like(&self, longest: &Self) -> bool {
        let (own, other) = (self.swings(), longest.swings());
        let apart = (own / self.seconds() - other / longest.seconds()).abs();
        self.cos(longest).abs() >= SAME_AXIS && apart <= SAME_RATE * other / longest.seconds() + 1.0 / self.seconds()
    }

    fn swings(&self) -> f64 {
        let (mut sign, mut changes) = (0.0, 0);
        for x in self.acceleration.iter().filter(|x| x.abs() > 2.0 * self.noise) {
            changes += u32::from(sign * x < 0.0);
            sign = x.signum();
        }
        0.5 * f64::from(changes)
    }

    /// Decays of one oscillator as a CSV file that the importer reads, each reading with its time after the first one's beginning.
    pub fn file(decays: &[Self]) -> String {
        let mut text = "t [s],acceleration [m/s²]\n".to_owned();
        let Some(first) = decays.first() else { return text };
        for decay in decays {
            // An axis has no sign.
            let (sign, since) = (decay.cos(first).signum(), decay.begin - first.begin);
            for [time, acceleration] in &decay.readings {
                // Writing to a text cannot fail.
                let _ = writeln!(text, "{:.6},{:.6}", since + time, sign * acceleration);
            }
        }
        text
    }
}

fn seconds(readings: &[[f64; 4]]) -> f64 {
    readings.last().zip(readings.first()).map_or(0.0, |(last, first)| last[0] - first[0])
}

fn in_order(readings: &[[f64; 4]]) -> Vec<[f64; 4]> {
    let is_whole = |reading: &[f64; 4]| reading.iter().all(|x| x.is_finite());
    let mut readings: Vec<[f64; 4]> = readings.iter().copied().filter(is_whole).collect();
    sort_items(&mut readings, |a, b| a[0].total_cmp(&b[0]));
    readings.dedup_by(|later, before| later[0] <= before[0]);
    readings
}

struct Along {
    axis: [f64; 3],
    times: Vec<f64>,
    gravity: f64,
    along: Vec<f64>,
}

impl Along {
    fn of(readings: &[[f64; 4]]) -> Self {
        let axis = main_axis(readings);
        let times = mapped(readings, &|reading| reading[0]);
        let along = numbers(readings.len(), &|k| (0..3).map(|i| axis[i] * readings[k][i + 1]).sum());
        let gravity = mean(&along);
        Self { axis, times, gravity, along: mapped(&along, &|x| x - gravity) }
    }
}

#[derive(Clone, Copy, Debug)]
struct Pace {
    share: f64,
    shortest: f64,
}

impl Pace {
    fn of(readings: &[[f64; 4]]) -> Self {
        let Along { times, along, .. } = Along::of(readings);
        Self::along(&times, &along)
    }

    /// By the large readings: a small mode beside it turns these less.
    fn along(times: &[f64], along: &[f64]) -> Self {
        let largest = along.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        let step = times.last().zip(times.first()).map_or(0.0, |(last, first)| last - first)
            / times.len().saturating_sub(1).max(1) as f64;
        let swing = 2.0 * step * half_swing(along, LARGE / CLEAR * largest);
        let share = if swing > FASTEST * step { (swing / SLOW).min(1.0) } else { 1.0 };
        Self { share, shortest: if share < 1.0 { SHORTEST.min(SWINGS * swing) } else { SHORTEST } }
    }

    fn is_too_short(self, readings: &[[f64; 4]]) -> bool {
        readings.len() < MOST_FEW || seconds(readings) < self.shortest
    }
}

fn end(times: &[f64], along: &[f64], begin: usize, noise: f64, pace: f64) -> (usize, bool) {
    let (mut least, mut swung, mut place) = (f64::INFINITY, times[begin], begin);
    let mut before = (begin, 0.0);
    while place < times.len() {
        let next = end_of_part(times, place, PART * pace);
        let largest = along[place..next].iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        if largest > GROWTH * least + QUIET * noise {
            return (place, false);
        }
        let is_whole = next < times.len();
        if is_whole && (STOPPED * largest).max(STOPPED * QUIET * noise) < before.1 {
            return (before.0, false);
        }
        (before, least) = ((place, largest), least.min(largest));
        if largest > QUIET * noise {
            swung = times[next - 1];
        } else if times[next - 1] - swung > REST * pace {
            return (next, true);
        }
        place = next;
    }
    (times.len(), false)
}

/// Its largest component is positive: an axis has no sign, and parts of one record must agree on it.
fn main_axis(readings: &[[f64; 4]]) -> [f64; 3] {
    fn three<T>(of: &dyn Fn(usize) -> T) -> [T; 3] {
        [of(0), of(1), of(2)]
    }
    let count = readings.len() as f64;
    let middle = three(&|i| readings.iter().map(|reading| reading[i + 1]).sum::<f64>() / count);
    let off = |reading: &[f64; 4], i: usize| reading[i + 1] - middle[i];
    let cov = |i, j| readings.iter().map(|reading| off(reading, i) * off(reading, j) / count).sum::<f64>();
    let cov = three(&|i| three(&|j| cov(i, j)));
    let largest = |axis: &[f64; 3]| (0..3).max_by(|&a, &b| axis[a].abs().total_cmp(&axis[b].abs())).unwrap_or(0);
    let variances = three(&|i| cov[i][i]);
    // A fixed direction could be at a right angle to the axis, and would never turn to it.
    let mut axis = three(&|i| cov[i][largest(&variances)]);
    for _ in 0..100 {
        let next = three(&|i| (0..3).map(|j| cov[i][j] * axis[j]).sum::<f64>());
        let length = next.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length == 0.0 {
            return [0.0, 0.0, 1.0];
        }
        axis = three(&|i| next[i] / length);
    }
    let sign = axis[largest(&axis)].signum();
    three(&|i| sign * axis[i])
}

/// The mean under a Hann window, in which the part of a swing at either end counts little.
fn middle(values: &[f64]) -> f64 {
    let turn = std::f64::consts::TAU / values.len().max(1) as f64;
    let weights = || (0..values.len()).map(|k| 1.0 - libm::cos(turn * (k as f64 + 0.5)));
    weights().zip(values).map(|(weight, x)| weight * x).sum::<f64>() / weights().sum::<f64>()
}

/// Limits from below the cosine between the axes of two decays of one device.
const SAME_AXIS: f64 = 0.95;

/// Limits the difference of their swings in a second, as a share, beside one swing over the length of the shorter.
const SAME_RATE: f64 = 0.03;
