//! What a real sensor does to its readings beside white normal noise of one size.
//!
//! ```text
//! reading = acts(scale h(y) + σ acts(n)),  n standard normal
//! ```
//!
//! The registry below lists the families in the order in which they act. Each draws from its own
//! random stream: with the same seed a record without it has the same noise otherwise.

mod families;

use std::fmt;
use std::marker::PhantomData;
use std::sync::LazyLock;

use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

use super::Scenario;
use crate::Quantity;
use crate::data::document::Document;
use crate::data::setting::Allowed;
use crate::mathematics::lists::mapped;
use crate::mathematics::random::{Normal, Purpose};

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
    act: fn(&[f64; MOST], Normal) -> Box<dyn Act>,
}

impl Scenario {
    /// The addresses of all numbers of its sensors' faults.
    pub fn fault_addresses(&self) -> Vec<String> {
        let mut all = Vec::new();
        for sensor in &self.sensors {
            for fault in sensor.faults.families() {
                all.extend(fault.info().numbers.iter().map(|number| fault.address(sensor.measures, number)));
            }
        }
        all
    }
}

/// A number of a fault.
#[derive(Debug, PartialEq)]
pub struct FaultNumber {
    /// The key in scenario files.
    pub key: &'static str,
    /// The name in running text.
    pub name: &'static str,
    /// What it is measured in.
    pub scale: Scale,
    /// The usual value on that scale.
    pub usual: f64,
    /// The limits of a slider on that scale.
    pub slider: (f64, f64),
    /// The values that it may have.
    pub allowed: Allowed,
}

/// What the number of a fault is measured in.
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

pub(crate) trait Act: Send + Sync {
    fn exact(&mut self, exact: f64) -> f64 {
        exact
    }

    /// Changes the noise, in standard deviations.
    fn noise(&mut self, noise: f64, _: &Moment) -> f64 {
        noise
    }

    /// Changes the reading; NaN is none.
    fn reading(&mut self, reading: f64, _: &Moment) -> f64 {
        reading
    }
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Moment {
    /// \[s\]
    pub(crate) time: f64,
    /// \[s\]
    pub(crate) dt: f64,
    pub(crate) noise_std: f64,
}

/// A family of faults, identified by its key.
#[derive(Clone, Copy)]
pub struct Fault(&'static FaultInfo);

/// The registry: a constant for each family, and the list of all of them in the order in which they act.
macro_rules! registry {
    ($($(#[$doc:meta])* $name:ident = $info:expr;)*) => {
        impl Fault {
            $($(#[$doc])* pub const $name: Self = Self(&$info);)*

            /// Every family, in the order in which they act.
            pub const ALL: [Self; FAMILIES] = [$(Self::$name),*];
        }

        const FAMILIES: usize = [$(stringify!($name)),*].len();
    };
}
registry! {
    /// Another scale, or sign.
    SCALED = families::SCALED;
    /// Student's distribution.
    STUDENT_T = families::STUDENT_T;
    /// Noise that is correlated over time.
    COLOURED = families::COLOURED;
    /// Noise whose size changes.
    CHANGING = families::CHANGING;
    /// A constant error.
    BIAS = families::BIAS;
    /// Readings that come late.
    LATE = families::LATE;
    /// Readings that are far off, to either side.
    OUTLIERS = families::OUTLIERS;
    /// Readings that are far off, upwards.
    OUTLIERS_ABOVE = families::OUTLIERS_ABOVE;
    /// Readings beyond a limit are at the limit.
    CLIPPED = families::CLIPPED;
    /// Readings are whole numbers of steps.
    QUANTISED = families::QUANTISED;
    /// A reading is told again and again.
    STUCK = families::STUCK;
    /// There is no reading.
    DROPOUTS = families::DROPOUTS;
    /// Readings at other times than those that are told.
    JITTER = families::JITTER;
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

    fn usual(self, quantity: Quantity) -> [f64; MOST] {
        let mut numbers = [0.0; MOST];
        for (number, info) in numbers.iter_mut().zip(self.0.numbers) {
            *number = info.usual * info.scale.size(quantity);
        }
        numbers
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

impl PartialEq for Fault {
    fn eq(&self, other: &Self) -> bool {
        self.0.key == other.0.key
    }
}

impl fmt::Debug for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0.key)
    }
}

/// The faults of a sensor, with their numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Faults([Option<[f64; MOST]>; FAMILIES]);

impl Faults {
    /// No fault.
    pub const NONE: Self = Self([None; FAMILIES]);

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
        self.0[fault.place()].get_or_insert_with(|| fault.usual(quantity));
    }

    /// Removes a fault.
    pub fn remove(&mut self, fault: Fault) {
        self.0[fault.place()] = None;
    }

    pub(crate) fn acts(&self, quantity: Quantity, seed: u64) -> Vec<Box<dyn Act>> {
        let act = |(fault, numbers): (Fault, Option<[f64; MOST]>)| {
            let stream = Normal::new(seed, Purpose::Fault(quantity, fault.0.stream));
            numbers.map(|numbers| (fault.0.act)(&numbers, stream))
        };
        Fault::ALL.into_iter().zip(self.0).filter_map(act).collect()
    }
}

struct Entries<T>(Vec<(String, T)>);

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Entries<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(OfEntries(PhantomData))
    }
}

struct OfEntries<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de>> de::Visitor<'de> for OfEntries<T> {
    type Value = Entries<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a map")
    }

    fn visit_map<A: de::MapAccess<'de>>(self, mut map: A) -> Result<Entries<T>, A::Error> {
        let mut entries = Vec::new();
        while let Some(entry) = map.next_entry()? {
            entries.push(entry);
        }
        Ok(Entries(entries))
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
        for (key, Entries(own)) in Entries::<Entries<f64>>::deserialize(deserializer)?.0 {
            let fault = Fault::from_key(&key).ok_or_else(|| de::Error::unknown_field(&key, &KEYS))?;
            let known = fault.0.numbers.iter().map(|info| info.key);
            if let Some(other) = own.iter().map(|(key, _)| key).find(|key| !known.clone().any(|known| known == *key)) {
                let known = known.collect::<Vec<_>>().join("`, `");
                return Err(de::Error::custom(format_args!("unknown field `{other}`, expected `{known}`")));
            }
            let mut numbers = [0.0; MOST];
            for (number, info) in numbers.iter_mut().zip(fault.0.numbers) {
                let one = own.iter().find(|(key, _)| key == info.key);
                *number = one.ok_or_else(|| de::Error::missing_field(info.key))?.1;
            }
            faults.0[fault.place()] = Some(numbers);
        }
        Ok(faults)
    }
}
