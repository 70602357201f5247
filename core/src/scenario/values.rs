//! One number for each channel, or its bounds, as a table in scenario files.

use std::fmt;
use std::marker::PhantomData;
use std::ops::{Index, IndexMut};

use kalmanscope_filters::Channel;
use kalmanscope_filters::catalogue::{KnownChannels, all_and, expected_channels};
use kalmanscope_filters::channel::Usual;
use serde::de::{self, Deserializer, MapAccess, Visitor};
use serde::{Deserialize, Serialize, Serializer};

/// One number for each channel of every plant, in the channel's unit; the usual value where it is unset.
#[derive(Clone, Debug, Default)]
pub struct Values {
    otherwise: Otherwise,
    pub(super) set: Vec<(Channel, f64)>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Otherwise {
    #[default]
    Zero,
    Mean,
    Std,
    Process,
}

impl Otherwise {
    fn of(self, channel: Channel) -> &'static f64 {
        let Usual { mean, std, process, .. } = channel.usual();
        match self {
            Self::Zero => &0.0,
            Self::Mean => mean,
            Self::Std => std,
            Self::Process => process,
        }
    }
}

impl Values {
    /// Zero for every channel.
    pub const ZERO: Self = Self::new(Otherwise::Zero);
    /// The default mean of the initial belief: at rest, with parameters off the truth.
    pub const INITIAL_MEAN: Self = Self::new(Otherwise::Mean);
    /// The default standard deviations of the initial belief.
    pub const INITIAL_STD: Self = Self::new(Otherwise::Std);
    /// The default process noise per step.
    pub const PROCESS_STD: Self = Self::new(Otherwise::Process);

    const fn new(otherwise: Otherwise) -> Self {
        Self { otherwise, set: Vec::new() }
    }

    /// The same with other numbers for some channels.
    #[must_use]
    pub fn with(mut self, values: impl IntoIterator<Item = (Channel, f64)>) -> Self {
        for (channel, value) in values {
            self[channel] = value;
        }
        self
    }

    /// The channels that have been set, and their numbers.
    pub fn iter(&self) -> impl Iterator<Item = (Channel, f64)> {
        self.set.iter().copied()
    }

    /// Sets these channels, to the usual number where there is none yet, and puts them first, in this order.
    pub(crate) fn complete(&mut self, channels: &[Channel]) {
        let own = channels.iter().map(|&channel| (channel, self[channel]));
        let rest = self.set.iter().copied().filter(|(channel, _)| !channels.contains(channel));
        self.set = own.chain(rest).collect();
    }

    /// The numbers of these channels and those that differ from `base`, over which the file is read.
    pub(crate) fn written_over(&self, base: &Self, channels: &[Channel]) -> Self {
        let own = all_and(self.iter().map(|(channel, _)| channel));
        let others = own.into_iter().filter(|c| !channels.contains(c) && self[*c] != base[*c]);
        let written = channels.iter().copied().chain(others);
        Self { otherwise: base.otherwise, set: written.map(|channel| (channel, self[channel])).collect() }
    }
}

impl Index<Channel> for Values {
    type Output = f64;

    fn index(&self, channel: Channel) -> &f64 {
        let set = self.set.iter().find(|(c, _)| *c == channel);
        set.map_or_else(|| self.otherwise.of(channel), |(_, value)| value)
    }
}

impl IndexMut<Channel> for Values {
    fn index_mut(&mut self, channel: Channel) -> &mut f64 {
        let place = self.set.iter().position(|(c, _)| *c == channel).unwrap_or_else(|| {
            self.set.push((channel, *self.otherwise.of(channel)));
            self.set.len() - 1
        });
        &mut self.set[place].1
    }
}

impl PartialEq for Values {
    fn eq(&self, other: &Self) -> bool {
        let same = |channel: Channel| self[channel] == other[channel];
        let set = || self.iter().chain(other.iter()).all(|(channel, _)| same(channel));
        set() && (self.otherwise == other.otherwise || Channel::all().iter().all(|&channel| same(channel)))
    }
}

impl Serialize for Values {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.iter().map(|(channel, value)| (channel.key(), value)))
    }
}

macro_rules! tables {
    ($($name:ident over $base:ident),*) => {
        $(pub(super) fn $name<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Values, D::Error> {
            let entries: Vec<(ChannelKey, f64)> = entries(deserializer, "a table")?;
            Ok(Values::$base.with(entries.into_iter().map(|(ChannelKey(channel), value)| (channel, value))))
        })*
    };
}
tables!(initial_mean over INITIAL_MEAN, initial_std over INITIAL_STD, process_std over PROCESS_STD, correlation_time over ZERO);

pub(super) fn entries<'de, K: Deserialize<'de>, T: Deserialize<'de>, D: Deserializer<'de>>(
    deserializer: D,
    expected: &'static str,
) -> Result<Vec<(K, T)>, D::Error> {
    deserializer.deserialize_map(Entries(expected, PhantomData))
}

struct Entries<E>(&'static str, PhantomData<E>);

impl<'de, K: Deserialize<'de>, T: Deserialize<'de>> Visitor<'de> for Entries<(K, T)> {
    type Value = Vec<(K, T)>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let mut entries = Vec::new();
        while let Some(entry) = map.next_entry()? {
            entries.push(entry);
        }
        Ok(entries)
    }
}

/// A channel as a key. An unknown key fails here, as a key, so that the message names its line.
struct ChannelKey(Channel);

impl<'de> Deserialize<'de> for ChannelKey {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let key = String::deserialize(deserializer)?;
        let unknown = || format!("unknown field `{key}`, expected {}", expected_channels(|_| true));
        KnownChannels::channel(&key).map(Self).ok_or_else(|| de::Error::custom(unknown()))
    }
}

/// The least and the most that channels can be, in their units. In a file a table: `damping_ratio = { least = 0.0, most = 0.2 }`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bounds(Vec<(Channel, Between)>);

/// The ends of what a channel can be, in its unit; no end if left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, expecting = "a table with `least`, `most` or both")]
pub struct Between {
    /// The lower end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub least: Option<f64>,
    /// The upper end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub most: Option<f64>,
}

impl Between {
    /// Both ends, infinite where there is none.
    pub fn ends(self) -> [f64; 2] {
        [self.least.unwrap_or(f64::NEG_INFINITY), self.most.unwrap_or(f64::INFINITY)]
    }

    /// Whether there is no end.
    pub fn is_open(self) -> bool {
        self == Self::default()
    }
}

impl Bounds {
    /// Whether no channel has bounds.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Each channel that has bounds.
    pub fn iter(&self) -> impl Iterator<Item = (Channel, Between)> {
        self.0.iter().copied()
    }

    /// The bounds of a channel; open if it has none.
    pub fn of(&self, channel: Channel) -> Between {
        self.iter().find(|(other, _)| *other == channel).map(|(_, between)| between).unwrap_or_default()
    }

    /// Sets the bounds of a channel, or takes them away if they are open.
    pub fn set(&mut self, channel: Channel, between: Between) {
        match self.0.iter_mut().find(|(other, _)| *other == channel) {
            Some((_, own)) => *own = between,
            None => self.0.push((channel, between)),
        }
        self.retain(|_| true);
    }

    /// Keeps the bounds of some channels.
    pub fn retain(&mut self, is_kept: impl Fn(Channel) -> bool) {
        self.0.retain(|(channel, between)| is_kept(*channel) && !between.is_open());
    }
}

impl Serialize for Bounds {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.iter().map(|(channel, between)| (channel.key(), between)))
    }
}

impl<'de> Deserialize<'de> for Bounds {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut bounds = Self::default();
        for (ChannelKey(channel), between) in entries(deserializer, "a table of channels")? {
            bounds.set(channel, between);
        }
        Ok(bounds)
    }
}
