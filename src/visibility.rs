//! The parts of the plots that the legend, a key or a lesson can switch.

use std::collections::BTreeSet;

use kalmanscope_core::{Channel, FilterSettings};
use kalmanscope_diagnosis::Wanted;

use crate::kinds::LegendEntry;

#[derive(Clone, Debug, PartialEq, Hash)]
pub struct Visibility {
    pub truth: bool,
    pub measured: bool,
    pub bands: bool,
    pub verdicts: bool,
    pub hindsight: bool,
    pub only: Vec<Channel>,
    /// The channel of the step by hand, the place of its sensor and of the gain's, and whether a reader fills in the results.
    pub channel: Option<Channel>,
    pub sensor: usize,
    pub hides_results: bool,
    hidden_filters: BTreeSet<u32>,
}

impl Default for Visibility {
    fn default() -> Self {
        Self {
            truth: true,
            measured: true,
            bands: true,
            verdicts: true,
            hindsight: true,
            only: Vec::new(),
            channel: None,
            sensor: 0,
            hides_results: false,
            hidden_filters: BTreeSet::new(),
        }
    }
}

impl Visibility {
    pub fn channels(&self, channels: Vec<Channel>) -> Vec<Channel> {
        let wanted: Vec<Channel> = channels.iter().copied().filter(|channel| self.only.contains(channel)).collect();
        if wanted.is_empty() { channels } else { wanted }
    }

    pub fn filter(&self, id: u32) -> bool {
        !self.hidden_filters.contains(&id)
    }

    pub(crate) fn wanted(&self) -> Wanted {
        if self.verdicts { Wanted::DIAGNOSTICS } else { Wanted::NOTHING }
    }

    pub(crate) fn without(hidden: &[LegendEntry]) -> Self {
        let mut visible = Self::default();
        for entry in hidden {
            // A double entry in the list counts once.
            if !visible.hidden().contains(entry) {
                visible.toggle(*entry);
            }
        }
        visible
    }

    pub(crate) fn hidden(&self) -> Vec<LegendEntry> {
        let Self { truth, measured, bands, verdicts, hindsight, hidden_filters, .. } = self;
        let parts = [
            (LegendEntry::Truth, *truth),
            (LegendEntry::Measured, *measured),
            (LegendEntry::Bands, *bands),
            (LegendEntry::Verdicts, *verdicts),
            (LegendEntry::Hindsight, *hindsight),
        ];
        let parts = parts.into_iter().filter(|(_, shown)| !shown).map(|(entry, _)| entry);
        parts.chain(hidden_filters.iter().map(|id| LegendEntry::Filter(*id))).collect()
    }

    pub(crate) fn reset(&mut self) {
        *self = Self { verdicts: self.verdicts, ..Self::default() };
    }

    pub fn toggle(&mut self, entry: LegendEntry) {
        match entry {
            LegendEntry::Truth => self.truth = !self.truth,
            LegendEntry::Measured => self.measured = !self.measured,
            LegendEntry::Bands => self.bands = !self.bands,
            LegendEntry::Verdicts => self.verdicts = !self.verdicts,
            LegendEntry::Hindsight => self.hindsight = !self.hindsight,
            LegendEntry::Filter(id) => {
                if !self.hidden_filters.remove(&id) {
                    self.hidden_filters.insert(id);
                }
            }
        }
    }

    pub(crate) fn forget_filters_but(&mut self, filters: &[FilterSettings]) {
        self.hidden_filters.retain(|id| filters.iter().any(|filter| filter.id == *id));
    }
}
