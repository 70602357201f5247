//! Addresses of filters' settings: by the filter's id inside the program, by its name in text that people write.
//!
//! ```text
//! filters#3.process_std.velocity      by id: stays right when the filter is renamed
//! filters.EKF.process_std.velocity    by name
//! filters.1.process_std.velocity      by number, where no filter has it as its name
//! filters.*.process_std.velocity      of all filters
//! ```

use kalmanscope_filters::lists::mapped;

use crate::scenario::{ALL, FilterSettings, Scenario};

const BY_ID: &str = "filters#";

const BY_NAME: &str = "filters.";

impl FilterSettings {
    /// The address of one of its settings, by its id.
    pub fn address(&self, key: &str) -> String {
        address(self.id, key)
    }
}

pub(super) fn address(id: u32, key: &str) -> String {
    format!("{BY_ID}{id}.{key}")
}

pub(super) fn split_id(address: &str) -> Option<(u32, &str)> {
    let (id, key) = address.strip_prefix(BY_ID)?.split_once('.')?;
    Some((id.parse().ok()?, key))
}

impl Scenario {
    /// The places of the filters that an address means, and the key behind it; of names that fit, the longest one is meant.
    pub fn filters_at<'a>(&self, address: &'a str) -> Option<(Vec<usize>, &'a str)> {
        if let Some((id, key)) = split_id(address) {
            let mut places = (0..self.filters.len()).filter(|&place| self.filters[place].id == id);
            let place = places.next()?;
            return places.next().is_none().then(|| (vec![place], key));
        }
        let rest = address.strip_prefix(BY_NAME)?;
        let key_behind = |name: &str| rest.strip_prefix(name)?.strip_prefix('.');
        let named = self.filters.iter().enumerate().filter_map(|(place, filter)| {
            let key = key_behind(&filter.name)?;
            Some((filter.name.len(), place, key))
        });
        // A number counts from 1, and only where no filter has it as its name.
        let by_number = || {
            let (number, key) = rest.split_once('.')?;
            let place = number.parse::<usize>().ok()?.checked_sub(1)?;
            (place < self.filters.len()).then(|| (vec![place], key))
        };
        match named.max_by_key(|(length, ..)| *length) {
            Some((_, place, key)) => Some((vec![place], key)),
            None => by_number().or_else(|| Some(((0..self.filters.len()).collect(), key_behind(ALL)?))),
        }
    }

    /// The same address by the filter's id, if it is of one filter of the scenario; else the address as it is.
    pub fn address_by_id(&self, address: &str) -> String {
        let one = self.filters_at(address).filter(|(_, key)| !is_of_all(address, key));
        let by_id = one.and_then(|(places, key)| Some(self.filters.get(*places.first()?)?.address(key)));
        by_id.unwrap_or_else(|| address.to_owned())
    }

    /// The same address by the filter's name, as people write it; one of no filter of the scenario is left as it is.
    pub fn address_by_name(&self, address: &str) -> String {
        let filter = split_id(address).and_then(|(id, key)| {
            let filter = self.filters.iter().find(|filter| filter.id == id)?;
            Some(format!("{BY_NAME}{}.{key}", filter.name))
        });
        filter.unwrap_or_else(|| address.to_owned())
    }

    /// The end of a sentence about an address whose filter is not found: the filters that there are. Empty otherwise.
    pub fn filters_instead_of(&self, address: &str) -> String {
        let is_found = [address, &format!("{address}.")].into_iter().any(|address| self.filters_at(address).is_some());
        if !(address.starts_with(BY_ID) || address.starts_with(BY_NAME)) || is_found {
            return String::new();
        }
        self.filters_in_words()
    }

    /// The end of a sentence about a filter that is not found: those that there are.
    pub fn filters_in_words(&self) -> String {
        let names: Vec<String> = mapped(&self.filters, &|filter| format!("`{}`", filter.name));
        match &names[..] {
            [] => "; it has no filter".to_owned(),
            [only] => format!("; its filter is {only}"),
            [first @ .., last] => format!("; its filters are {} and {last}", first.join(", ")),
        }
    }
}

pub(super) fn is_of_all(address: &str, key: &str) -> bool {
    address.strip_suffix(key).is_some_and(|begin| begin == "filters.*.")
}
