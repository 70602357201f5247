//! The ids of filters.

use super::Scenario;

impl Scenario {
    /// Gives every filter a unique id. A filter without an id, or with that of an earlier one, gets the number of its
    /// place, counted from 1, or else the first free number.
    pub fn number_filters(&mut self) {
        let mut taken = self.filter_ids();
        let mut seen = vec![0];
        for (number, filter) in (1..).zip(&mut self.filters) {
            if seen.contains(&filter.id) {
                filter.id = if taken.contains(&number) { free(&taken) } else { number };
                taken.push(filter.id);
            }
            seen.push(filter.id);
        }
    }

    /// The smallest id that no filter has.
    pub fn free_filter_id(&self) -> u32 {
        free(&self.filter_ids())
    }

    fn filter_ids(&self) -> Vec<u32> {
        self.filters.iter().map(|filter| filter.id).collect()
    }
}

fn free(taken: &[u32]) -> u32 {
    (1..).find(|id| !taken.contains(id)).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use crate::{FilterSettings, Scenario};

    fn numbered(ids: &[u32]) -> Vec<u32> {
        let filters = ids.iter().map(|&id| FilterSettings { id, ..FilterSettings::default() }).collect();
        let mut scenario = Scenario { filters, ..Scenario::default() };
        scenario.number_filters();
        scenario.filters.iter().map(|filter| filter.id).collect()
    }

    #[test]
    fn every_filter_has_an_id_of_its_own() {
        assert_eq!(numbered(&[0, 0, 0]), [1, 2, 3]);
        assert_eq!(numbered(&[7, 2, 5]), [7, 2, 5]);
        assert_eq!(numbered(&[2, 0, 2, 0]), [2, 1, 3, 4]);
        assert!(numbered(&[]).is_empty());
        assert_eq!(Scenario::default().free_filter_id(), 3);
    }
}
