//! What a real sensor does to its readings beside white normal noise of one size.
//!
//! ```text
//! reading = acts(scale h(y) + σ acts(n)),  n standard normal
//! ```
//!
//! The families stand in the order in which they act. Each has its own random stream: without it other noise is the same.

use std::collections::{BTreeMap, VecDeque};
use std::sync::LazyLock;

use crate::document::Document;
use kalmanscope_filters::Quantity;
use kalmanscope_filters::lists::mapped;
use kalmanscope_filters::random::{Normal, Purpose};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

use super::row::{Allowed, by_key};
use super::{Scenario, values};

/// The description of a family of faults.
pub struct FaultInfo {
    /// The key in scenario files.
    pub key: &'static str,
    /// The number of its random stream, which never changes: its place may.
    stream: u64,
    /// The name in running text.
    pub name: &'static str,
    /// What it does, in a few words.
    pub description: &'static str,
    /// Its numbers.
    pub numbers: &'static [FaultNumber],
    /// A sentence, without its stop, in which `@` stands for the sensor's name and each `{}` for a number, in their order.
    pub sentence: &'static str,
    stage: FaultStage,
    change: fn([f64; MOST], Normal) -> Change,
}
by_key!(FaultInfo);

impl Scenario {
    /// The addresses of all numbers of its sensors' faults.
    pub fn fault_addresses(&self) -> Vec<String> {
        let faults = self.sensors.iter().flat_map(|one| one.faults.families().map(|fault| (one.measures, fault)));
        faults
            .flat_map(|(of, fault)| fault.info().numbers.iter().map(move |number| fault.address(of, number)))
            .collect()
    }
}

/// A number of a fault.
#[derive(Debug, PartialEq)]
pub struct FaultNumber {
    /// The key in scenario files.
    pub key: &'static str,
    /// The name in running text.
    pub name: &'static str,
    /// The kind of its unit.
    pub scale: Scale,
    /// The usual value on that scale.
    pub usual: f64,
    /// The limits of a slider on that scale.
    pub slider: (f64, f64),
    /// The values that it may have.
    pub allowed: Allowed,
}

/// The kind of unit of a fault's number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// A pure number.
    Pure,
    /// Standard deviations of the sensor's noise.
    Sigma,
    /// The unit of the sensor's quantity. Usual values and limits are in its usual noises.
    Unit,
    /// Seconds.
    Seconds,
}

const MOST: usize = 3;

#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum FaultStage {
    Exact,
    /// The noise, in standard deviations.
    Noise,
    /// NaN stands for no reading.
    Reading,
}

type Change = Box<dyn FnMut(f64, &Moment) -> f64 + Send + Sync>;

pub(crate) struct Act(FaultStage, Change);

impl Act {
    pub(crate) fn apply(&mut self, stage: FaultStage, value: f64, moment: &Moment) -> f64 {
        if stage == self.0 { (self.1)(value, moment) } else { value }
    }
}

pub(crate) struct Moment {
    /// \[s\]
    pub(crate) time: f64,
    /// \[s\]
    pub(crate) dt: f64,
    pub(crate) noise_std: f64,
}

/// A family of faults, identified by its key.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fault(&'static FaultInfo);

macro_rules! families {
    ($($(#[$doc:meta])* $name:ident: $key:literal, stream $stream:literal, $stage:ident {
        description: $what:literal,
        $($data:tt)*
    })*) => {
        impl Fault {
            $(#[doc = $what] $(#[$doc])* pub const $name: Self = {
                static INFO: FaultInfo =
                    FaultInfo { key: $key, stream: $stream, stage: FaultStage::$stage, description: $what, $($data)* };
                Self(&INFO)
            };)*

            /// Every family, in the order in which they act.
            pub const ALL: [Self; [$($stream),*].len()] = [$(Self::$name),*];
        }
    };
}
families! {
    SCALED: "scaled", stream 0, Exact {
        description: "multiplies each reading by a factor; a negative one is a wrong sign",
        name: "wrong scale",
        numbers: &[number("factor", "factor", Scale::Pure, 1.2, (-2.0, 2.0), Allowed::Finite)],
        sentence: "The @ sensor reads {} times what it should",
        change: |[factor, ..], _| Box::new(move |exact, _| factor * exact),
    }
    /// Source: Student (1908), The probable error of a mean: a standard normal number over the root of χ²/ν.
    STUDENT_T: "student_t", stream 1, Noise {
        description: "noise by Student's distribution, whose scale is noise_std: the fewer degrees of freedom, the more large errors",
        name: "Student's noise",
        numbers: &[number("freedom", "degrees of freedom", Scale::Pure, 3.0, (1.0, 30.0), Allowed::Whole(1, 1000))],
        sentence: "The noise of the @ sensor is Student's, with {} degrees of freedom",
        change: |[freedom, ..], mut random| Box::new(move |noise, _| {
            let squares: f64 = (0..libm::round(freedom) as usize).map(|_| random.sample()).map(|x| x * x).sum();
            noise / (squares / freedom).sqrt().max(f64::MIN_POSITIVE)
        }),
    }
    /// A Gauss-Markov process, n ← a n + √(1 - a²) w, a = exp(-dt / τ). Source: Brown and Hwang
    /// (2012), *Introduction to Random Signals and Applied Kalman Filtering*, section 2.7.
    COLOURED: "coloured", stream 2, Noise {
        description: "noise of the same size that is correlated over a time (Gauss-Markov)",
        name: "coloured noise",
        numbers: &[number("time", "correlation time", Scale::Seconds, 0.1, (0.001, 10.0), Allowed::Above(0.0))],
        sentence: "The noise of the @ sensor is correlated over {}",
        change: |[time, ..], _| {
            let mut last: Option<f64> = None;
            Box::new(move |noise, moment| {
                let a = libm::exp(-moment.dt / time);
                let next = last.map_or(noise, |last| a * last + (1.0 - a * a).sqrt() * noise);
                last = Some(next);
                next
            })
        },
    }
    CHANGING: "changing", stream 3, Noise {
        description: "noise of another size from a time on",
        name: "changing noise",
        numbers: &[
            number("at", "time of the change", Scale::Seconds, 20.0, (0.0, 60.0), Allowed::Finite),
            number("factor", "factor on the noise", Scale::Pure, 5.0, (0.1, 30.0), Allowed::AtLeast(0.0)),
        ],
        sentence: "From {} on the noise of the @ sensor is {} times as large",
        change: |[at, factor, _], _| {
            Box::new(move |noise, moment| if moment.time >= at { factor * noise } else { noise })
        },
    }
    BIAS: "bias", stream 4, Reading {
        description: "reads too much by a constant, as an accelerometer that feels gravity",
        name: "bias",
        numbers: &[number("offset", "bias", Scale::Unit, 5.0, (-30.0, 30.0), Allowed::Finite)],
        sentence: "The @ sensor reads {} too much",
        change: |[offset, ..], _| Box::new(move |reading, _| reading + offset),
    }
    LATE: "late", stream 5, Reading {
        description: "each reading comes late by this time, to the nearest sample",
        name: "late readings",
        numbers: &[number("delay", "delay", Scale::Seconds, 0.05, (0.0, 1.0), Allowed::AtLeast(0.0))],
        sentence: "The readings of the @ sensor come {} late",
        change: |[delay, ..], _| {
            let mut waiting = VecDeque::new();
            Box::new(move |reading, moment| {
                let samples = libm::round(delay / moment.dt).min(MOST_SAMPLES) as usize;
                waiting.push_back(reading);
                if waiting.len() > samples { waiting.pop_front().unwrap_or(f64::NAN) } else { f64::NAN }
            })
        },
    }
    OUTLIERS: "outliers", stream 6, Reading {
        description: "a share of the readings is off by some standard deviations, to either side",
        name: "outliers",
        numbers: &OF_OUTLIERS,
        sentence: "A share of {} of the @ readings is off by {} to {}",
        change: |numbers, random| outliers(numbers, false, random),
    }
    OUTLIERS_ABOVE: "outliers_above", stream 7, Reading {
        description: "the same, to the positive side only",
        name: "outliers upwards",
        numbers: &OF_OUTLIERS,
        sentence: "A share of {} of the @ readings is too high by {} to {}",
        change: |numbers, random| outliers(numbers, true, random),
    }
    CLIPPED: "clipped", stream 8, Reading {
        description: "readings beyond ± a limit are at the limit",
        name: "clipping",
        numbers: &[number("limit", "limit", Scale::Unit, 10.0, (1.0, 100.0), Allowed::AtLeast(0.0))],
        sentence: "The @ sensor reads no more than ±{}",
        change: |[limit, ..], _| {
            Box::new(move |reading, _| if reading.abs() > limit { libm::copysign(limit, reading) } else { reading })
        },
    }
    QUANTISED: "quantised", stream 9, Reading {
        description: "readings are rounded to whole steps, as by a converter with few bits",
        name: "coarse steps",
        numbers: &[number("step", "step", Scale::Unit, 5.0, (0.1, 50.0), Allowed::Above(0.0))],
        sentence: "The @ sensor reads in steps of {}",
        change: |[step, ..], _| Box::new(move |reading, _| {
            let steps = libm::round(reading / step);
            // A step that is small beyond measure changes nothing.
            if steps.is_infinite() { reading } else { steps * step }
        }),
    }
    STUCK: "stuck", stream 10, Reading {
        description: "for a share of the time the sensor repeats its last reading, in spells of a mean length",
        name: "sticking",
        numbers: &OF_SPELLS,
        sentence: "For a share of {} of the time the @ sensor sticks, for {} on average",
        change: |[share, length, _], random| {
            let (mut spells, mut last) = (Spells { share, length, is_in: None, random }, f64::NAN);
            Box::new(move |reading, moment| {
                if !spells.next(moment.dt) || last.is_nan() {
                    last = reading;
                }
                last
            })
        },
    }
    DROPOUTS: "dropouts", stream 11, Reading {
        description: "a share of the readings is missing, in spells of a mean length; 0 s makes each independent of the others",
        name: "dropouts",
        numbers: &OF_SPELLS,
        sentence: "A share of {} of the @ readings is missing, for {} on average",
        change: |[share, length, _], random| {
            let mut spells = Spells { share, length, is_in: None, random };
            Box::new(move |reading, moment| if spells.next(moment.dt) { f64::NAN } else { reading })
        },
    }
    JITTER: "jitter", stream 12, Exact {
        description: "the true time of each reading differs from the stated one by up to this many steps, uniformly, \
                      along a parabola through the last three values",
        name: "jitter",
        numbers: &[number("spread", "spread in steps", Scale::Pure, 0.5, (0.0, 1.0), Allowed::Within(0.0, 1.0))],
        sentence: "The @ sensor reads up to {} steps before or after the time that it states",
        change: |[spread, ..], mut random| {
            let mut both: [Option<f64>; 2] = [None; 2];
            Box::new(move |exact, _| {
                let shift = spread * (2.0 * random.uniform() - 1.0);
                let [before, last] = both;
                both = [last, Some(exact)];
                let slope = last.map_or(0.0, |last| exact - last);
                let curvature = last.zip(before).map_or(0.0, |(last, before)| exact - 2.0 * last + before);
                exact + shift * slope + 0.5 * shift * (shift + 1.0) * curvature
            })
        },
    }
}

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

const MOST_SAMPLES: f64 = 100_000.0;

const OF_OUTLIERS: [FaultNumber; 3] = [
    number("share", "share of outliers", Scale::Pure, 0.1, (0.0, 0.5), Allowed::Within(0.0, 1.0)),
    number("from", "least outlier", Scale::Sigma, 10.0, (0.0, 100.0), Allowed::AtLeast(0.0)),
    number("to", "largest outlier", Scale::Sigma, 30.0, (0.0, 100.0), Allowed::AtLeast(0.0)),
];

fn outliers([share, from, to]: [f64; MOST], is_one_sided: bool, mut random: Normal) -> Change {
    Box::new(move |reading, moment| {
        // The same draws for every sample, so that a larger share has the outliers of a smaller one.
        let [chance, size, side] = [(); 3].map(|()| random.uniform());
        if chance > share {
            return reading;
        }
        let error = moment.noise_std * (from + (to - from) * size);
        if is_one_sided || side > 0.5 { reading + error } else { reading - error }
    })
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

impl Fault {
    /// Its description.
    pub const fn info(self) -> &'static FaultInfo {
        self.0
    }

    /// The family with a key.
    pub fn from_key(key: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|fault| fault.0.key == key)
    }

    /// The address of one of its numbers, of the sensor of a quantity.
    pub fn address(self, quantity: Quantity, number: &FaultNumber) -> String {
        format!("sensors.{}.faults.{}.{}", quantity.key(), self.0.key, number.key)
    }

    fn place(self) -> usize {
        Self::ALL.iter().position(|fault| *fault == self).unwrap_or(0)
    }
}

impl Scale {
    /// The unit of the scale in that of a quantity: its usual noise for [`Self::Unit`], else 1.
    pub fn size(self, quantity: Quantity) -> f64 {
        if self == Self::Unit { quantity.aspect().info().usual_noise } else { 1.0 }
    }

    /// The unit, for a sensor of a quantity.
    pub fn unit(self, quantity: Quantity) -> &'static str {
        match self {
            Self::Pure => "",
            Self::Sigma => "σ",
            Self::Unit => quantity.unit(),
            Self::Seconds => "s",
        }
    }
}

/// The faults of a sensor, with their numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Faults([Option<[f64; MOST]>; Fault::ALL.len()]);

impl Faults {
    /// No fault.
    pub const NONE: Self = Self([None; Fault::ALL.len()]);

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.0.iter().all(Option::is_none)
    }

    /// The faults that there are, in the order in which they act.
    pub fn families(&self) -> impl Iterator<Item = Fault> {
        Fault::ALL.into_iter().zip(self.0).filter_map(|(fault, numbers)| numbers.map(|_| fault))
    }

    /// The numbers of a fault, if there is it.
    pub fn numbers(&self, fault: Fault) -> Option<&[f64]> {
        self.0[fault.place()].as_ref().map(|numbers| &numbers[..fault.0.numbers.len()])
    }

    /// The same, to be set.
    pub fn numbers_mut(&mut self, fault: Fault) -> Option<&mut [f64]> {
        self.0[fault.place()].as_mut().map(|numbers| &mut numbers[..fault.0.numbers.len()])
    }

    /// Adds a fault with numbers that are usual for a sensor of a quantity.
    pub fn add(&mut self, fault: Fault, quantity: Quantity) {
        self.0[fault.place()].get_or_insert_with(|| {
            let mut numbers = [0.0; MOST];
            for (number, info) in numbers.iter_mut().zip(fault.0.numbers) {
                *number = info.usual * info.scale.size(quantity);
            }
            numbers
        });
    }

    /// Removes a fault.
    pub fn remove(&mut self, fault: Fault) {
        self.0[fault.place()] = None;
    }

    pub(crate) fn acts(&self, quantity: Quantity, seed: u64) -> Vec<Act> {
        let act = |(fault, numbers): (Fault, Option<[f64; MOST]>)| {
            let stream = Normal::new(seed, Purpose::Fault(quantity, fault.0.stream));
            numbers.map(|numbers| Act(fault.0.stage, (fault.0.change)(numbers, stream)))
        };
        Fault::ALL.into_iter().zip(self.0).filter_map(act).collect()
    }
}

impl Serialize for Faults {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let entries = self.families().map(|fault| {
            let numbers = self.numbers(fault).unwrap_or_default();
            let own =
                fault.0.numbers.iter().map(|info| info.key.to_owned()).zip(numbers.iter().map(|x| Document::from(*x)));
            (fault.0.key, Document::Object(own.collect()))
        });
        serializer.collect_map(entries)
    }
}

impl<'de> Deserialize<'de> for Faults {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        static KEYS: LazyLock<Vec<&'static str>> = LazyLock::new(|| mapped(&Fault::ALL, &|fault| fault.0.key));
        let mut faults = Self::NONE;
        for (key, own) in values::entries::<String, BTreeMap<String, f64>, _>(deserializer, "a map")? {
            let fault = Fault::from_key(&key).ok_or_else(|| de::Error::unknown_field(&key, &KEYS))?;
            let known = fault.0.numbers.iter().map(|info| info.key);
            if let Some(other) = own.keys().find(|key| !known.clone().any(|known| known == *key)) {
                let known = known.collect::<Vec<_>>().join("`, `");
                return Err(de::Error::custom(format_args!("unknown field `{other}`, expected `{known}`")));
            }
            let mut numbers = [0.0; MOST];
            for (number, info) in numbers.iter_mut().zip(fault.0.numbers) {
                *number = *own.get(info.key).ok_or_else(|| de::Error::missing_field(info.key))?;
            }
            faults.0[fault.place()] = Some(numbers);
        }
        Ok(faults)
    }
}
