//! All channels: those of the plants in the registry, and the augmentations.

use std::sync::{PoisonError, RwLock};

use serde::{Deserialize, Deserializer, de};

use crate::mathematics::channel::{augment, expected};
use crate::{Channel, PlantKind};

impl Channel {
    /// Every channel of every plant in the registry, every augmentation, and those of equations that have been read.
    pub fn all() -> &'static [Self] {
        static ALL: RwLock<(usize, &'static [Channel])> = RwLock::new((0, &[]));
        let own = crate::mathematics::equation::channels();
        let place = own.as_ptr() as usize;
        let (of, all) = *ALL.read().unwrap_or_else(PoisonError::into_inner);
        if of == place && !all.is_empty() {
            return all;
        }
        let mut all = Vec::new();
        let plants = PlantKind::ALL.iter().flat_map(|kind| kind.channels().iter().copied());
        for channel in plants.chain(augment::all()).chain(own.iter().copied()) {
            if !all.contains(&channel) {
                all.push(channel);
            }
        }
        let all: &'static [Channel] = all.leak();
        *ALL.write().unwrap_or_else(PoisonError::into_inner) = (place, all);
        all
    }

    /// The channel with this key, if there is one.
    pub fn from_key(key: &str) -> Option<Self> {
        Self::all().iter().copied().find(|channel| channel.key() == key)
    }
}

impl<'de> Deserialize<'de> for Channel {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let key = String::deserialize(deserializer)?;
        let expected = || expected_channels(|_| true);
        Self::from_key(&key)
            .ok_or_else(|| de::Error::custom(format!("unknown variant `{key}`, expected {}", expected())))
    }
}

pub(crate) fn expected_channels(has: impl Fn(Channel) -> bool) -> String {
    expected(Channel::all().iter().filter(|c| c.mass() == 0 && has(**c)).map(|c| c.key()))
}
