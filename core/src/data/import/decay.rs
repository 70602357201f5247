//! The free decay in the readings of an accelerometer with three axes: what a phone tells that was plucked and let go.

mod series;
mod several;

use thiserror::Error;

use crate::record::LiveRecord;
use crate::{Hold, InputKind, Quantity};

use series::{end_of_part, even, main_axis, mean, middle, noise_of, side};

/// The free decay of an oscillator along one axis.
///
/// Gravity, and whatever else is constant, is the mean of the decay under a Hann window and is taken away. The axis is that
/// along which the readings vary most. The decay begins half a swing after the largest reading, when the hand is gone, and
/// ends where the readings are noise, or before they grow again. A phone's clock jitters, and a shift by a tenth of a step is as
/// large as the noise: its file ([`Self::csv`]) has the readings at their own times, and its series are carried to equal steps.
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
    /// What is constant along the axis and taken away: gravity's share, and what the sensor adds \[m/s²\].
    pub gravity: f64,
    /// The standard deviation of the noise along the axis \[m/s²\].
    pub noise: f64,
    /// The time of the first reading that is kept, in the clock of the readings \[s\].
    pub begin: f64,
    /// Each reading at its own time: that after the beginning \[s\], and the acceleration \[m/s²\].
    readings: Vec<[f64; 2]>,
    /// Whether it has come to rest and rests at the end of the readings: there is nothing more to learn.
    pub rests: bool,
}

/// The reason why readings have no free decay.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum NoDecay {
    /// There are too few readings.
    #[error("there are {readings} readings over {seconds:.1} s, but at least {MOST_FEW} over {SHORTEST} s are needed")]
    TooFew {
        /// The number of readings.
        readings: usize,
        /// The time that they take \[s\].
        seconds: f64,
    },
    /// Nothing moved.
    #[error("nothing swung: the largest reading is {ratio:.1} times the noise, which is {noise:.3} m/s²")]
    Still {
        /// The largest reading over the noise.
        ratio: f64,
        /// The noise \[m/s²\].
        noise: f64,
    },
    /// What swung was not left alone.
    #[error("it swung freely for {seconds:.1} s only, but at least {SHORTEST} s are needed: pull it and let go")]
    Short {
        /// The length of the longest free decay \[s\].
        seconds: f64,
    },
}

impl NoDecay {
    /// The reason that tells more: something swung, and longer.
    fn or(self, other: Option<Self>) -> Self {
        let seconds = |reason: &Self| if let Self::Short { seconds } = reason { *seconds } else { -1.0 };
        match other {
            Some(other) if seconds(&other) >= seconds(&self) => other,
            _ => self,
        }
    }
}

/// The readings and the seconds that a decay has at least.
const MOST_FEW: usize = 60;
const SHORTEST: f64 = 2.0;

/// The parts in which decays are looked for: each takes a look at all its readings.
const MOST_PARTS: usize = 64;

/// The largest reading of a swing over the noise, at least.
const SWING: f64 = 8.0;

/// A part of this length has a largest reading \[s\].
const PART: f64 = 0.5;

/// Readings below this many standard deviations are noise; a part that grows by this factor, and by the noise, is no free decay.
const QUIET: f64 = 4.0;
const GROWTH: f64 = 1.4;

/// A part that is smaller than the one before by this factor was stopped by a hand, if the one before is so much above noise.
const STOPPED: f64 = 6.0;

/// It is at rest after this time without a swing \[s\].
const REST: f64 = 2.0;

impl Decay {
    /// The longest free decay in readings of time \[s\] and three accelerations \[m/s²\], gravity among them, in any order.
    ///
    /// # Errors
    /// [`NoDecay`].
    pub fn of(readings: &[[f64; 4]]) -> Result<Self, NoDecay> {
        let longest = |a: &Self, b: &Self| a.seconds().total_cmp(&b.seconds());
        Ok(Self::all(readings)?.into_iter().max_by(longest).expect("there is one, or the reason why there is none"))
    }

    /// Every free decay, in the order of time: each pluck has its own. They have their own axis and gravity, so that a device
    /// that is taken away at the end, or turned, spoils none. They are looked for at the largest reading, then before and after
    /// what was found, in 64 parts at most.
    ///
    /// # Errors
    /// [`NoDecay`] if there is none.
    pub fn all(readings: &[[f64; 4]]) -> Result<Vec<Self>, NoDecay> {
        let mut readings: Vec<[f64; 4]> =
            readings.iter().copied().filter(|reading| reading.iter().all(|x| x.is_finite())).collect();
        readings.sort_by(|a, b| a[0].total_cmp(&b[0]));
        readings.dedup_by(|later, before| later[0] <= before[0]);
        if is_too_short(&readings) {
            return Err(NoDecay::TooFew { readings: readings.len(), seconds: seconds(&readings) });
        }
        let (mut found, mut reason) = (Vec::new(), None);
        let mut parts = std::collections::VecDeque::from([&readings[..]]);
        for _ in 0..MOST_PARTS {
            let Some(part) = parts.pop_front() else { break };
            let (decay, [before, after]) = Self::around_the_peak(part);
            match decay {
                Ok(decay) => found.push(decay),
                Err(why) => reason = Some(why.or(reason)),
            }
            parts.extend([before, after].into_iter().filter(|part| !is_too_short(part)));
        }
        found.sort_by(|a, b| a.begin.total_cmp(&b.begin));
        match reason {
            Some(reason) if found.is_empty() => Err(reason),
            _ => Ok(found),
        }
    }

    /// The decay that begins at the largest reading, and the readings before and after it.
    fn around_the_peak(readings: &[[f64; 4]]) -> (Result<Self, NoDecay>, [&[[f64; 4]]; 2]) {
        let axis = main_axis(readings);
        let times: Vec<f64> = readings.iter().map(|reading| reading[0]).collect();
        let along: Vec<f64> = readings.iter().map(|reading| (0..3).map(|i| axis[i] * reading[i + 1]).sum()).collect();
        let gravity = mean(&along);
        let along: Vec<f64> = along.iter().map(|x| x - gravity).collect();
        let noise = noise_of(&times, &along);
        let peak = (0..along.len()).max_by(|&a, &b| along[a].abs().total_cmp(&along[b].abs())).unwrap_or(0);
        let ratio = along[peak].abs() / noise.max(f64::MIN_POSITIVE);
        if ratio < SWING {
            return (Err(NoDecay::Still { ratio, noise }), [&[], &[]]);
        }
        let crossing = |from: usize| (from + 1..along.len()).find(|&k| along[k] * along[from] < 0.0);
        let begin = crossing(peak).and_then(crossing).unwrap_or(along.len() - 1);
        let (end, rests) = end(&times, &along, begin, noise);
        let before = times.partition_point(|time| *time < times[peak] - PART);
        let others = [&readings[..before], &readings[end.max(peak + 1)..]];
        let is_quiet = |k: usize| along[k].abs() <= SWING * noise;
        let rests =
            rests && (end..along.len()).rev().take_while(|&k| times[k] >= times[times.len() - 1] - REST).all(is_quiet);
        let kept = &readings[begin..end.max(begin)];
        if is_too_short(kept) {
            return (Err(NoDecay::Short { seconds: seconds(kept) }), others);
        }
        let rest = middle(&along[begin..end]);
        let along: Vec<f64> = along[begin..end].iter().map(|x| x - rest).collect();
        let (dt, acceleration) = even(&times[begin..end], &along, noise);
        let times_of = (0..acceleration.len()).map(|k| dt * k as f64);
        let (times_of, gravity) = (times_of.collect(), gravity + rest);
        let readings = times[begin..end].iter().zip(&along).map(|(time, x)| [time - times[begin], *x]).collect();
        let begin = times[begin];
        (Ok(Self { times: times_of, acceleration, axis, gravity, noise, begin, readings, rests }), others)
    }

    /// How long it lasts \[s\].
    pub fn seconds(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }

    /// A reading of time \[s\] and three accelerations along the axis, without what is constant \[m/s²\].
    pub fn along(&self, [_, x, y, z]: [f64; 4]) -> f64 {
        self.axis[0] * x + self.axis[1] * y + self.axis[2] * z - self.gravity
    }

    /// An empty record for a decay that goes on, with the same steps. It takes its readings from [`Self::begin`] on, along the
    /// axis, and no input.
    pub fn live(&self) -> LiveRecord {
        let n = self.times.len();
        let dt = self.seconds() / n.saturating_sub(1).max(1) as f64;
        let side = side(&self.acceleration, self.noise).min(n.saturating_sub(1) / 2);
        LiveRecord::new(dt, InputKind::Force, Hold::First, vec![Quantity::ACCELERATION]).smoothing(side)
    }

    /// The decay as a CSV file that the importer reads: each reading with its own time, with their units.
    pub fn csv(&self) -> String {
        Self::file(std::slice::from_ref(self))
    }
}

/// The readings to either side of one that a cubic follows, for readings whose mean may be anything.
pub(super) fn side_of(times: &[f64], values: &[f64]) -> usize {
    let middle = mean(values);
    let around: Vec<f64> = values.iter().map(|value| value - middle).collect();
    side(&around, noise_of(times, &around))
}

fn seconds(readings: &[[f64; 4]]) -> f64 {
    readings.last().zip(readings.first()).map_or(0.0, |(last, first)| last[0] - first[0])
}

fn is_too_short(readings: &[[f64; 4]]) -> bool {
    readings.len() < MOST_FEW || seconds(readings) < SHORTEST
}

/// The end of the free decay that begins at a place: where nothing swings any more, which is said, or before it swings more, or before a
/// hand stops it.
fn end(times: &[f64], along: &[f64], begin: usize, noise: f64) -> (usize, bool) {
    let (mut least, mut swung, mut place) = (f64::INFINITY, times[begin], begin);
    // Where the part before begins, and its largest reading.
    let mut before = (begin, 0.0);
    while place < times.len() {
        let next = end_of_part(times, place, PART);
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
        } else if times[next - 1] - swung > REST {
            return (next, true);
        }
        place = next;
    }
    (times.len(), false)
}
