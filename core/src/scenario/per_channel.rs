//! One number for each channel, as a table in scenario files.

use std::ops::{Index, IndexMut};

use serde::{Deserialize, Deserializer, Serialize};

use crate::Channel;
use crate::channel::channel_table;

macro_rules! make_per_channel {
    ($($doc:literal $variant:ident $field:ident $key:literal $name:literal $symbol:literal $unit:literal $role:ident $usual:expr;)*) => {
        /// One number for each channel of every plant, in the channel's unit. A filter uses those of its own plant.
        #[derive(Clone, Copy, Debug, PartialEq, Serialize)]
        pub struct PerChannel {
            $(#[doc = $doc] pub $field: f64,)*
        }

        /// What a filter takes unless told otherwise: mean, standard deviation, process noise.
        const USUAL: [PerChannel; 3] = {
            const fn column(i: usize) -> PerChannel {
                PerChannel { $($field: { const VALUES: [f64; 3] = $usual; VALUES[i] },)* }
            }
            [column(0), column(1), column(2)]
        };

        const ZERO: PerChannel = PerChannel { $($field: 0.0,)* };

        impl Index<Channel> for PerChannel {
            type Output = f64;

            fn index(&self, channel: Channel) -> &f64 {
                match channel {
                    $(Channel::$variant => &self.$field,)*
                }
            }
        }

        impl IndexMut<Channel> for PerChannel {
            fn index_mut(&mut self, channel: Channel) -> &mut f64 {
                match channel {
                    $(Channel::$variant => &mut self.$field,)*
                }
            }
        }

        /// What a file gives of a [`PerChannel`]; the rest is the default of the key that it stands under.
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        struct Given {
            $($field: Option<f64>,)*
        }

        fn given_or<'de, D: Deserializer<'de>>(usual: PerChannel, deserializer: D) -> Result<PerChannel, D::Error> {
            let given = Given::deserialize(deserializer)?;
            Ok(PerChannel { $($field: given.$field.unwrap_or(usual.$field),)* })
        }
    };
}
channel_table!(make_per_channel);

impl PerChannel {
    /// Zero for every channel.
    pub const ZERO: Self = ZERO;
    /// The mean that a filter starts from unless told otherwise: at rest, off the truth.
    pub const INITIAL_MEAN: Self = USUAL[0];
    /// The standard deviations that go with it.
    pub const INITIAL_STD: Self = USUAL[1];
    /// The process noise per step unless told otherwise.
    pub const PROCESS_STD: Self = USUAL[2];
}

pub(super) fn initial_mean<'de, D: Deserializer<'de>>(deserializer: D) -> Result<PerChannel, D::Error> {
    given_or(PerChannel::INITIAL_MEAN, deserializer)
}

pub(super) fn initial_std<'de, D: Deserializer<'de>>(deserializer: D) -> Result<PerChannel, D::Error> {
    given_or(PerChannel::INITIAL_STD, deserializer)
}

pub(super) fn process_std<'de, D: Deserializer<'de>>(deserializer: D) -> Result<PerChannel, D::Error> {
    given_or(PerChannel::PROCESS_STD, deserializer)
}
