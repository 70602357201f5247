//! The families of faults: their words and numbers, and what they do.

use std::collections::VecDeque;

use super::{Act, FaultInfo, FaultNumber, Moment, Scale};
use crate::data::setting::Allowed;
use crate::mathematics::random::Normal;

const fn number(
    key: &'static str,
    name: &'static str,
    scale: Scale,
    usual: f64,
    slider: (f64, f64),
    allowed: Allowed,
) -> FaultNumber {
    FaultNumber { key, name, scale, usual, slider, allowed }
}

pub(super) static SCALED: FaultInfo = FaultInfo {
    key: "scaled",
    stream: 0,
    name: "wrong scale",
    description: "reads so many times what it should; a negative factor is a wrong sign",
    numbers: &[number("factor", "factor", Scale::Pure, 1.2, (-2.0, 2.0), Allowed::Finite)],
    sentence: "The @ sensor reads {} times what it should",
    act: |numbers, _| Box::new(Scaled(numbers[0])),
};

struct Scaled(f64);

impl Act for Scaled {
    fn exact(&mut self, exact: f64) -> f64 {
        self.0 * exact
    }
}

/// Source: Student (1908), The probable error of a mean: a standard normal number over the root of χ²/ν.
pub(super) static STUDENT_T: FaultInfo = FaultInfo {
    key: "student_t",
    stream: 1,
    name: "Student's noise",
    description: "noise by Student's distribution, whose scale is noise_std: the fewer degrees of freedom, the more large errors",
    numbers: &[number("freedom", "degrees of freedom", Scale::Pure, 3.0, (1.0, 30.0), Allowed::Whole(1, 1000))],
    sentence: "The noise of the @ sensor is Student's, with {} degrees of freedom",
    act: |numbers, random| Box::new(StudentT { freedom: numbers[0], random }),
};

struct StudentT {
    freedom: f64,
    random: Normal,
}

impl Act for StudentT {
    fn noise(&mut self, noise: f64, _: &Moment) -> f64 {
        let squares: f64 = (0..libm::round(self.freedom) as usize).map(|_| self.random.sample()).map(|x| x * x).sum();
        noise / (squares / self.freedom).sqrt().max(f64::MIN_POSITIVE)
    }
}

/// A Gauss-Markov process: n ← a n + √(1 - a²) w, a = exp(-dt / τ). Source: Brown and Hwang (2012), *Introduction to Random
/// Signals and Applied Kalman Filtering*, section 2.7.
pub(super) static COLOURED: FaultInfo = FaultInfo {
    key: "coloured",
    stream: 2,
    name: "coloured noise",
    description: "noise of the same size that is correlated over a time (Gauss-Markov)",
    numbers: &[number("time", "correlation time", Scale::Seconds, 0.1, (0.001, 10.0), Allowed::Above(0.0))],
    sentence: "The noise of the @ sensor is correlated over {}",
    act: |numbers, _| Box::new(Coloured { time: numbers[0], last: None }),
};

struct Coloured {
    time: f64,
    last: Option<f64>,
}

impl Act for Coloured {
    fn noise(&mut self, noise: f64, moment: &Moment) -> f64 {
        let a = libm::exp(-moment.dt / self.time);
        let next = self.last.map_or(noise, |last| a * last + (1.0 - a * a).sqrt() * noise);
        self.last = Some(next);
        next
    }
}

pub(super) static CHANGING: FaultInfo = FaultInfo {
    key: "changing",
    stream: 3,
    name: "changing noise",
    description: "noise of another size from a time on",
    numbers: &[
        number("at", "time of the change", Scale::Seconds, 20.0, (0.0, 60.0), Allowed::Finite),
        number("factor", "factor on the noise", Scale::Pure, 5.0, (0.1, 30.0), Allowed::AtLeast(0.0)),
    ],
    sentence: "From {} on the noise of the @ sensor is {} times as large",
    act: |numbers, _| Box::new(Changing { at: numbers[0], factor: numbers[1] }),
};

struct Changing {
    at: f64,
    factor: f64,
}

impl Act for Changing {
    fn noise(&mut self, noise: f64, moment: &Moment) -> f64 {
        if moment.time >= self.at { self.factor * noise } else { noise }
    }
}

pub(super) static BIAS: FaultInfo = FaultInfo {
    key: "bias",
    stream: 4,
    name: "bias",
    description: "reads too much by a constant, as an accelerometer that feels gravity",
    numbers: &[number("offset", "bias", Scale::Unit, 5.0, (-30.0, 30.0), Allowed::Finite)],
    sentence: "The @ sensor reads {} too much",
    act: |numbers, _| Box::new(Bias(numbers[0])),
};

struct Bias(f64);

impl Act for Bias {
    fn reading(&mut self, reading: f64, _: &Moment) -> f64 {
        reading + self.0
    }
}

const MOST_SAMPLES: f64 = 100_000.0;

pub(super) static LATE: FaultInfo = FaultInfo {
    key: "late",
    stream: 5,
    name: "late readings",
    description: "each reading is that of so many seconds before, to the nearest sample",
    numbers: &[number("delay", "delay", Scale::Seconds, 0.05, (0.0, 1.0), Allowed::AtLeast(0.0))],
    sentence: "The readings of the @ sensor come {} late",
    act: |numbers, _| Box::new(Late { delay: numbers[0], waiting: VecDeque::new() }),
};

struct Late {
    delay: f64,
    waiting: VecDeque<f64>,
}

impl Act for Late {
    fn reading(&mut self, reading: f64, moment: &Moment) -> f64 {
        let samples = libm::round(self.delay / moment.dt).min(MOST_SAMPLES) as usize;
        self.waiting.push_back(reading);
        if self.waiting.len() > samples { self.waiting.pop_front().unwrap_or(f64::NAN) } else { f64::NAN }
    }
}

const OF_OUTLIERS: [FaultNumber; 3] = [
    number("share", "share of outliers", Scale::Pure, 0.1, (0.0, 0.5), Allowed::Within(0.0, 1.0)),
    number("from", "least outlier", Scale::Sigma, 10.0, (0.0, 100.0), Allowed::AtLeast(0.0)),
    number("to", "largest outlier", Scale::Sigma, 30.0, (0.0, 100.0), Allowed::AtLeast(0.0)),
];

pub(super) static OUTLIERS: FaultInfo = FaultInfo {
    key: "outliers",
    stream: 6,
    name: "outliers",
    description: "a share of the readings is off by some standard deviations, to either side",
    numbers: &OF_OUTLIERS,
    sentence: "A share of {} of the @ readings is off by {} to {}",
    act: |numbers, random| Box::new(Outliers { numbers: *numbers, is_one_sided: false, random }),
};

pub(super) static OUTLIERS_ABOVE: FaultInfo = FaultInfo {
    key: "outliers_above",
    stream: 7,
    name: "outliers upwards",
    description: "the same, to the positive side only",
    numbers: &OF_OUTLIERS,
    sentence: "A share of {} of the @ readings is too high by {} to {}",
    act: |numbers, random| Box::new(Outliers { numbers: *numbers, is_one_sided: true, random }),
};

struct Outliers {
    numbers: [f64; 3],
    is_one_sided: bool,
    random: Normal,
}

impl Act for Outliers {
    fn reading(&mut self, reading: f64, moment: &Moment) -> f64 {
        let [share, from, to] = self.numbers;
        // The same draws for every sample, so that a larger share has the outliers of a smaller one.
        let [chance, size, side] = [(); 3].map(|()| self.random.uniform());
        if chance > share {
            return reading;
        }
        let error = moment.noise_std * (from + (to - from) * size);
        if self.is_one_sided || side > 0.5 { reading + error } else { reading - error }
    }
}

pub(super) static CLIPPED: FaultInfo = FaultInfo {
    key: "clipped",
    stream: 8,
    name: "clipping",
    description: "readings beyond ± a limit are at the limit",
    numbers: &[number("limit", "limit", Scale::Unit, 10.0, (1.0, 100.0), Allowed::AtLeast(0.0))],
    sentence: "The @ sensor reads no more than ±{}",
    act: |numbers, _| Box::new(Clipped(numbers[0])),
};

struct Clipped(f64);

impl Act for Clipped {
    fn reading(&mut self, reading: f64, _: &Moment) -> f64 {
        // NaN stays.
        if reading.abs() > self.0 { libm::copysign(self.0, reading) } else { reading }
    }
}

pub(super) static QUANTISED: FaultInfo = FaultInfo {
    key: "quantised",
    stream: 9,
    name: "coarse steps",
    description: "readings are rounded to whole steps, as by a converter with few bits",
    numbers: &[number("step", "step", Scale::Unit, 5.0, (0.1, 50.0), Allowed::Above(0.0))],
    sentence: "The @ sensor reads in steps of {}",
    act: |numbers, _| Box::new(Quantised(numbers[0])),
};

struct Quantised(f64);

impl Act for Quantised {
    fn reading(&mut self, reading: f64, _: &Moment) -> f64 {
        let steps = libm::round(reading / self.0);
        // A step that is small beyond measure changes nothing.
        if steps.is_infinite() { reading } else { steps * self.0 }
    }
}

const OF_SPELLS: [FaultNumber; 2] = [
    number("share", "share of the samples", Scale::Pure, 0.1, (0.0, 0.9), Allowed::Within(0.0, 1.0)),
    number("length", "mean length", Scale::Seconds, 0.2, (0.0, 5.0), Allowed::AtLeast(0.0)),
];

/// Spells whose lengths are distributed geometrically. A mean length of a sample or less makes them independent.
struct Spells {
    share: f64,
    length: f64,
    is_in: Option<bool>,
    random: Normal,
}

impl Spells {
    fn new(share: f64, length: f64, random: Normal) -> Self {
        Self { share, length, is_in: None, random }
    }

    fn next(&mut self, dt: f64) -> bool {
        let ends = (dt / self.length).min(1.0);
        // Spells begin so often that a sample is in one with the probability of the share.
        let begins = match self.share {
            share if share < 1.0 => share * ends / (1.0 - share + share * ends),
            _ => 1.0,
        };
        let [stay, begin] = [(); 2].map(|()| self.random.uniform());
        let is_in = match self.is_in {
            Some(is_in) => is_in && stay > ends || begin <= begins,
            None => begin <= self.share,
        };
        self.is_in = Some(is_in);
        is_in
    }
}

pub(super) static STUCK: FaultInfo = FaultInfo {
    key: "stuck",
    stream: 10,
    name: "sticking",
    description: "for a share of the time the sensor tells its last reading again, in spells of a mean length",
    numbers: &OF_SPELLS,
    sentence: "For a share of {} of the time the @ sensor sticks, for {} on average",
    act: |numbers, random| Box::new(Stuck { spells: Spells::new(numbers[0], numbers[1], random), last: f64::NAN }),
};

struct Stuck {
    spells: Spells,
    last: f64,
}

impl Act for Stuck {
    fn reading(&mut self, reading: f64, moment: &Moment) -> f64 {
        if !self.spells.next(moment.dt) || self.last.is_nan() {
            self.last = reading;
        }
        self.last
    }
}

pub(super) static DROPOUTS: FaultInfo = FaultInfo {
    key: "dropouts",
    stream: 11,
    name: "dropouts",
    description: "a share of the readings is missing, in spells of a mean length; 0 s makes each independent of the others",
    numbers: &OF_SPELLS,
    sentence: "A share of {} of the @ readings is missing, for {} on average",
    act: |numbers, random| Box::new(Dropouts(Spells::new(numbers[0], numbers[1], random))),
};

struct Dropouts(Spells);

impl Act for Dropouts {
    fn reading(&mut self, reading: f64, moment: &Moment) -> f64 {
        if self.0.next(moment.dt) { f64::NAN } else { reading }
    }
}

pub(super) static JITTER: FaultInfo = FaultInfo {
    key: "jitter",
    stream: 12,
    name: "jitter",
    description: "each reading is taken at another time than is told: up to so many steps before or after, uniformly, along a \
                  parabola through the last three values",
    numbers: &[number("spread", "spread in steps", Scale::Pure, 0.5, (0.0, 1.0), Allowed::Within(0.0, 1.0))],
    sentence: "The @ sensor reads up to {} steps before or after the time that it tells",
    act: |numbers, random| Box::new(Jitter { spread: numbers[0], random, last: [None; 2] }),
};

struct Jitter {
    spread: f64,
    random: Normal,
    last: [Option<f64>; 2],
}

impl Act for Jitter {
    fn exact(&mut self, exact: f64) -> f64 {
        let shift = self.spread * (2.0 * self.random.uniform() - 1.0);
        let [before, last] = self.last;
        self.last = [last, Some(exact)];
        let slope = last.map_or(0.0, |last| exact - last);
        let curvature = last.zip(before).map_or(0.0, |(last, before)| exact - 2.0 * last + before);
        exact + shift * slope + 0.5 * shift * (shift + 1.0) * curvature
    }
}
