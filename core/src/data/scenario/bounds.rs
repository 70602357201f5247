//! The bounds of what a filter estimates.

use std::fmt;

use serde::de::{Deserializer, MapAccess, Visitor};
use serde::{Deserialize, Serialize, Serializer};

use super::values::Key;
use crate::Channel;

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
        struct Table;

        impl<'de> Visitor<'de> for Table {
            type Value = Bounds;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a table of channels")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Bounds, A::Error> {
                let mut bounds = Bounds::default();
                while let Some(Key(channel)) = map.next_key()? {
                    bounds.set(channel, map.next_value()?);
                }
                Ok(bounds)
            }
        }

        deserializer.deserialize_map(Table)
    }
}
