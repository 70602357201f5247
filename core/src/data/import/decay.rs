//! The free decay in the readings of an accelerometer with three axes: what a phone tells that was plucked and let go.

use std::fmt::Write as _;

use thiserror::Error;

/// The free decay of an oscillator along one axis.
///
/// Gravity, and whatever else is constant, is the mean of the decay under a Hann window and is taken away. The axis is that
/// along which the readings vary most. The decay begins half a swing after the largest reading, when the hand is gone, and
/// ends where the readings are noise, or before they grow again. Its readings are carried from their own times to equal steps
/// by cubics through four of them: a phone's clock jitters, and a shift by a tenth of a step is as large as the noise.
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
    /// The standard deviation of the readings along the axis in the quietest second \[m/s²\].
    pub noise: f64,
    /// The time of the first reading that is kept, in the clock of the readings \[s\].
    pub begin: f64,
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

/// The readings and the seconds that a decay has at least.
const MOST_FEW: usize = 60;
const SHORTEST: f64 = 2.0;

/// The largest reading of a swing over the noise, at least.
const SWING: f64 = 8.0;

/// A part of this length has a largest reading \[s\].
const PART: f64 = 0.5;

/// Readings below this many standard deviations are noise; a part that grows by this factor, and by the noise, is no free decay.
const QUIET: f64 = 4.0;
const GROWTH: f64 = 1.4;

/// Readings are missing in an interval of this many steps.
const MISSING: f64 = 3.0;

/// It is at rest after this time without a swing \[s\].
const REST: f64 = 2.0;

impl Decay {
    /// The free decay in readings of time \[s\] and three accelerations \[m/s²\], gravity among them, in any order.
    ///
    /// # Errors
    /// [`NoDecay`].
    pub fn of(readings: &[[f64; 4]]) -> Result<Self, NoDecay> {
        let mut readings: Vec<[f64; 4]> =
            readings.iter().copied().filter(|reading| reading.iter().all(|x| x.is_finite())).collect();
        readings.sort_by(|a, b| a[0].total_cmp(&b[0]));
        readings.dedup_by(|later, before| later[0] <= before[0]);
        let seconds = readings.last().zip(readings.first()).map_or(0.0, |(last, first)| last[0] - first[0]);
        if readings.len() < MOST_FEW || seconds < SHORTEST {
            return Err(NoDecay::TooFew { readings: readings.len(), seconds });
        }
        let axis = main_axis(&readings);
        let times: Vec<f64> = readings.iter().map(|reading| reading[0]).collect();
        let along: Vec<f64> = readings.iter().map(|reading| (0..3).map(|i| axis[i] * reading[i + 1]).sum()).collect();
        let gravity = mean(&along);
        let along: Vec<f64> = along.iter().map(|x| x - gravity).collect();
        let noise = quietest(&times, &along);
        let peak = (0..along.len()).max_by(|&a, &b| along[a].abs().total_cmp(&along[b].abs())).unwrap_or(0);
        let ratio = along[peak].abs() / noise.max(f64::MIN_POSITIVE);
        if ratio < SWING {
            return Err(NoDecay::Still { ratio, noise });
        }
        let crossing = |from: usize| (from + 1..along.len()).find(|&k| along[k] * along[from] < 0.0);
        let begin = crossing(peak).and_then(crossing).unwrap_or(along.len() - 1);
        let (end, rests) = end(&times, &along, begin, noise);
        let is_quiet = |k: usize| along[k].abs() <= SWING * noise;
        let rests =
            rests && (end..along.len()).rev().take_while(|&k| times[k] >= times[times.len() - 1] - REST).all(is_quiet);
        let seconds = times[end - 1] - times[begin];
        if end - begin < MOST_FEW || seconds < SHORTEST {
            return Err(NoDecay::Short { seconds });
        }
        let rest = middle(&along[begin..end]);
        let along: Vec<f64> = along[begin..end].iter().map(|x| x - rest).collect();
        let (dt, acceleration) = even(&times[begin..end], &along);
        let times_of = (0..acceleration.len()).map(|k| dt * k as f64);
        let (times_of, gravity) = (times_of.collect(), gravity + rest);
        Ok(Self { times: times_of, acceleration, axis, gravity, noise, begin: times[begin], rests })
    }

    /// The decay as a CSV file that the importer reads: time and acceleration, with their units.
    pub fn csv(&self) -> String {
        let mut text = "t [s],acceleration [m/s²]\n".to_owned();
        for (time, acceleration) in self.times.iter().zip(&self.acceleration) {
            // A text takes whatever is written.
            let _ = match acceleration.is_nan() {
                true => writeln!(text, "{time:.6},"),
                false => writeln!(text, "{time:.6},{acceleration:.6}"),
            };
        }
        text
    }
}

/// The end of the free decay that begins at a place: where nothing swings any more, which is said, or before it swings more.
fn end(times: &[f64], along: &[f64], begin: usize, noise: f64) -> (usize, bool) {
    let (mut least, mut swung, mut place) = (f64::INFINITY, times[begin], begin);
    while place < times.len() {
        let next = (place..times.len()).find(|&k| times[k] >= times[place] + PART).unwrap_or(times.len());
        let largest = along[place..next].iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        if largest > GROWTH * least + QUIET * noise {
            return (place, false);
        }
        least = least.min(largest);
        if largest > QUIET * noise {
            swung = times[next - 1];
        } else if times[next - 1] - swung > REST {
            return (next, true);
        }
        place = next;
    }
    (times.len(), false)
}

/// The mean step of some times \[s\], and the values at equal steps: on a cubic through the four readings around each.
fn even(times: &[f64], values: &[f64]) -> (f64, Vec<f64>) {
    let n = times.len();
    let dt = (times[n - 1] - times[0]) / (n - 1) as f64;
    let mut next = 1;
    let at = |k: usize| {
        let time = times[0] + dt * k as f64;
        while next < n - 1 && times[next] < time {
            next += 1;
        }
        if times[next] - times[next - 1] > MISSING * dt {
            return f64::NAN;
        }
        let first = next.saturating_sub(2).min(n - 4);
        let basis = |i: usize| {
            let others = (first..first + 4).filter(|&j| j != i);
            others.map(|j| (time - times[j]) / (times[i] - times[j])).product::<f64>()
        };
        (first..first + 4).map(|i| values[i] * basis(i)).sum()
    };
    (dt, (0..n).map(at).collect())
}

/// The standard deviation in the quietest second.
fn quietest(times: &[f64], along: &[f64]) -> f64 {
    let mut least = f64::INFINITY;
    let mut place = 0;
    while place < times.len() {
        let next = (place..times.len()).find(|&k| times[k] >= times[place] + 1.0).unwrap_or(times.len());
        if next - place >= 10 {
            let middle = mean(&along[place..next]);
            let square = along[place..next].iter().map(|x| (x - middle) * (x - middle)).sum::<f64>();
            least = least.min(square / (next - place - 1) as f64);
        }
        place = next;
    }
    if least.is_finite() { least.sqrt() } else { 0.0 }
}

/// The direction in which three accelerations vary most: the first eigenvector of their covariance, by repeated products. Its
/// largest component is positive.
fn main_axis(readings: &[[f64; 4]]) -> [f64; 3] {
    let count = readings.len() as f64;
    let middle: [f64; 3] = std::array::from_fn(|i| readings.iter().map(|reading| reading[i + 1]).sum::<f64>() / count);
    let mut cov = [[0.0; 3]; 3];
    for reading in readings {
        for i in 0..3 {
            for j in 0..3 {
                cov[i][j] += (reading[i + 1] - middle[i]) * (reading[j + 1] - middle[j]) / count;
            }
        }
    }
    let largest = |axis: &[f64; 3]| (0..3).max_by(|&a, &b| axis[a].abs().total_cmp(&axis[b].abs())).unwrap_or(0);
    let variances: [f64; 3] = std::array::from_fn(|i| cov[i][i]);
    let mut axis: [f64; 3] = std::array::from_fn(|i| cov[i][largest(&variances)]);
    for _ in 0..100 {
        let next: [f64; 3] = std::array::from_fn(|i| (0..3).map(|j| cov[i][j] * axis[j]).sum());
        let length = next.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length == 0.0 {
            return [0.0, 0.0, 1.0];
        }
        axis = next.map(|x| x / length);
    }
    let sign = axis[largest(&axis)].signum();
    axis.map(|x| sign * x)
}

/// The mean of readings that swing, under a Hann window: the part of a swing at either end counts little.
fn middle(values: &[f64]) -> f64 {
    let turn = std::f64::consts::TAU / values.len().max(1) as f64;
    let weight = |k: usize| 1.0 - libm::cos(turn * (k as f64 + 0.5));
    let (sum, weights) = values.iter().enumerate().fold((0.0, 0.0), |(sum, weights), (k, x)| {
        let weight = weight(k);
        (sum + weight * x, weights + weight)
    });
    sum / weights
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}
