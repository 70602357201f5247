//! The times at which a motion begins anew.

use crate::mathematics::filter::{Filter, FilterError};
use crate::{FilterSettings, Model};

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
    times: Vec<f64>,
    /// Places in the state, and the variances that are added there.
    variances: Vec<(usize, f64)>,
}

impl Plucks {
    /// Those of a filter with this model, after a time \[s\].
    pub(crate) fn new(settings: &FilterSettings, model: &Model, start: f64) -> Self {
        let mut times: Vec<f64> = settings.plucks.iter().map(|time| time - start).collect();
        times.sort_by(f64::total_cmp);
        let of = |(place, channel): (usize, &crate::Channel)| {
            let moves = !channel.is_parameter() && !channel.is_augmentation();
            moves.then(|| (place, settings.initial_std[*channel].powi(2)))
        };
        let variances =
            if times.is_empty() { Vec::new() } else { model.channels().iter().enumerate().filter_map(of).collect() };
        Self { times, variances }
    }

    /// Widens the belief of a filter that goes on from one time to a later one, if it was plucked meanwhile \[s\].
    ///
    /// # Errors
    /// Those of a belief that has no root.
    pub(crate) fn pass(&self, filter: &mut Filter, [from, to]: [f64; 2]) -> Result<(), FilterError> {
        let count = self.times.partition_point(|time| *time <= to) - self.times.partition_point(|time| *time <= from);
        if count == 0 {
            return Ok(());
        }
        let mut belief = filter.belief().gaussian().into_owned();
        for &(place, variance) in &self.variances {
            belief.cov[(place, place)] += count as f64 * variance;
        }
        filter.belief_mut().replace(&belief).map(|_| ())
    }
}
