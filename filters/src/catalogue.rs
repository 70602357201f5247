//! All channels: those of the plants in the registry, the augmentations, and while a text is read, those of its equations.

use std::cell::RefCell;
use std::sync::LazyLock;

use serde::{Deserialize, Deserializer, de};

use crate::channel::{augment, expected};
use crate::{Channel, PlantKind};

impl Channel {
    /// Every channel of every plant in the registry, and every augmentation.
    pub fn all() -> &'static [Self] {
        static ALL: LazyLock<Vec<Channel>> = LazyLock::new(|| {
            let mut all = Vec::new();
            PlantKind::ALL.iter().for_each(|kind| add(&mut all, kind.channels().iter().copied()));
            add(&mut all, augment::all());
            all
        });
        &ALL
    }

    /// The channel of a plant in the registry, or the augmentation, with this key, if there is one. A scenario knows those of its
    /// equations too.
    pub fn from_key(key: &str) -> Option<Self> {
        Self::all().iter().copied().find(|channel| channel.key() == key)
    }
}

fn add(all: &mut Vec<Channel>, others: impl IntoIterator<Item = Channel>) {
    for channel in others {
        if !all.contains(&channel) {
            all.push(channel);
        }
    }
}

/// [`Channel::all`], and then those of `others` that are not among them.
pub fn all_and(others: impl IntoIterator<Item = Channel>) -> Vec<Channel> {
    let mut all = Channel::all().to_vec();
    add(&mut all, others);
    all
}

/// The channel with a key of the first of these plants that has one.
pub fn channel_of<'a>(plants: impl IntoIterator<Item = &'a PlantKind>, key: &str) -> Option<Channel> {
    plants.into_iter().flat_map(PlantKind::channels).copied().find(|channel| channel.key() == key)
}

thread_local! {
    static PLANTS: RefCell<Vec<PlantKind>> = const { RefCell::new(Vec::new()) };
}

/// Until this is dropped, this thread also reads the keys of these plants' channels: serde has no room for a context. Where two
/// plants have a key, the plants that were added last count, and the first of those.
pub struct KnownPlants {
    before: usize,
}

impl KnownPlants {
    pub fn new(plants: Vec<PlantKind>) -> Self {
        PLANTS.with_borrow_mut(|known| {
            let before = known.len();
            known.extend(plants.into_iter().rev());
            Self { before }
        })
    }

    pub(crate) fn find(is_it: impl Fn(&PlantKind) -> bool) -> Option<PlantKind> {
        PLANTS.with_borrow(|known| known.iter().rev().find(|kind| is_it(kind)).cloned())
    }

    fn channels() -> Vec<Channel> {
        PLANTS.with_borrow(|known| all_and(known.iter().rev().flat_map(|kind| kind.channels().iter().copied())))
    }

    /// The channel that a key means here.
    pub fn channel(key: &str) -> Option<Channel> {
        let own = || PLANTS.with_borrow(|known| channel_of(known.iter().rev(), key));
        Channel::from_key(key).or_else(own)
    }
}

impl Drop for KnownPlants {
    fn drop(&mut self) {
        PLANTS.with_borrow_mut(|known| known.truncate(self.before));
    }
}

impl<'de> Deserialize<'de> for Channel {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let key = String::deserialize(deserializer)?;
        let expected = || expected_channels(|_| true);
        KnownPlants::channel(&key)
            .ok_or_else(|| de::Error::custom(format!("unknown variant `{key}`, expected {}", expected())))
    }
}

pub fn expected_channels(has: impl Fn(Channel) -> bool) -> String {
    let all = KnownPlants::channels();
    expected(all.iter().filter(|c| c.mass() == 0 && has(**c)).map(|c| c.key()))
}
