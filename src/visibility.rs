//! The parts of all plots that can be switched on and off: by the legend, a key or a lesson.

use std::collections::BTreeSet;

use kalmanscope_core::{Channel, FilterSettings};

use crate::request::LegendEntry;

/// Which entries of the legend all plots draw.
#[derive(Clone, Debug, PartialEq, Hash)]
pub struct Visibility {
    /// The truth.
    pub truth: bool,
    /// The measurements.
    pub measured: bool,
    /// The ±2σ bands.
    pub bands: bool,
    /// The channels that there are charts of, or none for all.
    pub only: Vec<Channel>,
    /// The ids of the filters that are hidden.
    hidden_filters: BTreeSet<u32>,
}

impl Default for Visibility {
    fn default() -> Self {
        Self { truth: true, measured: true, bands: true, only: Vec::new(), hidden_filters: BTreeSet::new() }
    }
}

impl Visibility {
    /// Those of `channels` that are wanted; all where none is, since a view is not left empty.
    pub fn channels(&self, channels: Vec<Channel>) -> Vec<Channel> {
        let wanted: Vec<Channel> = channels.iter().copied().filter(|channel| self.only.contains(channel)).collect();
        if wanted.is_empty() { channels } else { wanted }
    }

    /// Whether the filter with this id is drawn.
    pub fn filter(&self, id: u32) -> bool {
        !self.hidden_filters.contains(&id)
    }

    /// Shows an entry of the legend, or hides it.
    pub fn toggle(&mut self, entry: LegendEntry) {
        match entry {
            LegendEntry::Truth => self.truth = !self.truth,
            LegendEntry::Measured => self.measured = !self.measured,
            LegendEntry::Bands => self.bands = !self.bands,
            LegendEntry::Filter(id) => {
                if !self.hidden_filters.remove(&id) {
                    self.hidden_filters.insert(id);
                }
            }
        }
    }

    /// Forgets that filters were hidden which are gone: a filter that comes later may have the id of one of them.
    pub(crate) fn forget_filters_but(&mut self, filters: &[FilterSettings]) {
        self.hidden_filters.retain(|id| filters.iter().any(|filter| filter.id == *id));
    }
}
