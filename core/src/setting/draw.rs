//! The members of a population: scenarios whose numbers are drawn, other ones for each seed.

use std::collections::BTreeMap;

use kalmanscope_filters::random::{Normal, Purpose};
use kalmanscope_records::hash::Hash;

use super::{Address, DT, DURATION, SEED};
use crate::scenario::{Law, Scenario, ScenarioError, short};

impl Scenario {
    /// The member of the population with a seed, with its drawn numbers, each of a stream of its own; it may be impossible.
    #[must_use]
    pub fn member(&self, seed: u64) -> Self {
        let mut member = Self { seed, draw: BTreeMap::new(), ..self.clone() };
        for (address, value) in self.drawn(seed) {
            address.set(&mut member, value);
        }
        member
    }

    /// The drawn numbers of the member with a seed, in the order of their keys. A key that names no number draws none.
    pub fn drawn(&self, seed: u64) -> Vec<(Address, f64)> {
        let one = |(key, law): (&String, &Law)| {
            let address = Address::parse(self, key).ok()?;
            let mut hash = Hash::default();
            hash.add(address.key.as_bytes());
            let value = short(law.draw(&mut Normal::new(seed, Purpose::Draw(hash.value()))));
            let value = address.rounded(value);
            Some((address, value))
        };
        self.draw.iter().filter_map(one).collect()
    }

    /// Leaves out draws of numbers that the scenario lacks, and writes the keys of the others by the ids of filters.
    pub fn keep_draws(&mut self) {
        for (key, law) in std::mem::take(&mut self.draw) {
            if let Ok(address) = Address::parse(self, &key) {
                self.draw.insert(address.key, law);
            }
        }
    }

    pub(super) fn read_draws(&mut self) -> Result<(), ScenarioError> {
        if self.draw.is_empty() {
            return Ok(());
        }
        let mut numbered = self.clone();
        numbered.number_filters();
        for key in self.draw.keys() {
            let unknown = |error| ScenarioError::Syntax(format!("draw: {error}"));
            let address = Address::parse(&numbered, key).map_err(unknown)?;
            // A population has one clock, and the seed is that of the member.
            if [SEED.key, DT.key, DURATION.key].contains(&&*address.key) {
                return Err(ScenarioError::Syntax(format!(
                    "draw: `{key}` is the same for all members of a population"
                )));
            }
        }
        numbered.keep_draws();
        self.draw = numbered.draw;
        Ok(())
    }
}
