//! The times at which a motion begins anew.

use crate::mathematics::lists::{mapped, sort_numbers};
use crate::{Channel, FilterSettings};

/// Widens a belief of the motion where a plant is plucked: parameters and augmentations are what they were.
///
/// ```text
/// P ← P + P₀ of displacements, velocities and hidden states, before the prediction over the time of a pluck
/// ```
///
/// The pull is an unknown force over a short time: it adds to the motion whatever was there before, about which nothing is known but its size.
#[derive(Clone, Debug, Default)]
pub(crate) struct Plucks {
    /// In rising order \[s\].
    pub(super) times: Vec<f64>,
    /// Places in the state, and the variances that are added there.
    variances: Vec<(usize, f64)>,
}

impl Plucks {
    pub(crate) fn new(settings: &FilterSettings, channels: &[Channel], start: f64) -> Self {
        let mut times = mapped(&settings.plucks, &|time| time - start);
        sort_numbers(&mut times);
        let of = |(place, channel): (usize, &Channel)| {
            let moves = !channel.is_parameter() && !channel.is_augmentation();
            moves.then(|| (place, settings.initial_std[*channel].powi(2)))
        };
        let variances =
            if times.is_empty() { Vec::new() } else { channels.iter().enumerate().filter_map(of).collect() };
        Self { times, variances }
    }

    /// The places and the variances to add for a filter that goes on from one time to a later one \[s\], if it was plucked meanwhile.
    pub(crate) fn between(&self, [from, to]: [f64; 2]) -> Option<impl Iterator<Item = (usize, f64)>> {
        let count = self.times.partition_point(|time| *time <= to) - self.times.partition_point(|time| *time <= from);
        let widened = move |&(place, variance): &(usize, f64)| (place, count as f64 * variance);
        (count > 0).then(|| self.variances.iter().map(widened))
    }
}
