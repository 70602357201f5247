//! All channels: those of plants, the augmentations, and while a text is read, those of its equations.

use std::cell::RefCell;
use std::sync::LazyLock;

use serde::{Deserialize, Deserializer, de};

use crate::Channel;
use crate::channel::{augment, expected};

impl Channel {
    /// Every channel of every built-in plant, and every augmentation.
    pub fn all() -> &'static [Self] {
        static ALL: LazyLock<Vec<Channel>> = LazyLock::new(|| Channel::of_plants().chain(augment::all()).collect());
        &ALL
    }

    /// The channel of a built-in plant, or the augmentation, with this key. A scenario knows those of its equations too.
    pub fn from_key(key: &str) -> Option<Self> {
        Self::all().iter().copied().find(|channel| channel.key() == key)
    }
}

/// [`Channel::all`], and then those of `others` that are not among them.
pub fn all_and(others: impl IntoIterator<Item = Channel>) -> Vec<Channel> {
    let mut all = Channel::all().to_vec();
    for channel in others {
        if !all.contains(&channel) {
            all.push(channel);
        }
    }
    all
}

thread_local! {
    static KNOWN: RefCell<Vec<Channel>> = const { RefCell::new(Vec::new()) };
}

/// Until this is dropped, this thread also reads the keys of these channels: serde has no context. The last ones that were added count.
pub struct KnownChannels {
    before: usize,
}

impl KnownChannels {
    pub fn new(channels: impl DoubleEndedIterator<Item = Channel>) -> Self {
        KNOWN.with_borrow_mut(|known| {
            let before = known.len();
            known.extend(channels.rev());
            Self { before }
        })
    }

    /// The channel that a key means here.
    pub fn channel(key: &str) -> Option<Channel> {
        let own = || KNOWN.with_borrow(|known| known.iter().rev().copied().find(|channel| channel.key() == key));
        Channel::from_key(key).or_else(own)
    }
}

impl Drop for KnownChannels {
    fn drop(&mut self) {
        KNOWN.with_borrow_mut(|known| known.truncate(self.before));
    }
}

impl<'de> Deserialize<'de> for Channel {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let key = String::deserialize(deserializer)?;
        let expected = || expected_channels(|_| true);
        KnownChannels::channel(&key)
            .ok_or_else(|| de::Error::custom(format!("unknown variant `{key}`, expected {}", expected())))
    }
}

pub fn expected_channels(has: impl Fn(Channel) -> bool) -> String {
    let all = KNOWN.with_borrow(|known| all_and(known.iter().rev().copied()));
    expected(all.iter().filter(|c| c.mass() == 0 && has(**c)).map(|c| c.key()))
}
