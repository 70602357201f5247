//! The built-in scenarios.

use kalmanscope_core::{Scenario, ScenarioError};

/// A scenario that comes with the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Its name in the menu.
    pub name: &'static str,
    toml: &'static str,
}

macro_rules! entry {
    ($name:literal, $file:literal) => {
        Entry { name: $name, toml: include_str!(concat!("../assets/scenarios/", $file, ".toml")) }
    };
}

/// Every built-in scenario, in the menu's order.
pub const ENTRIES: [Entry; 15] = [
    entry!("Sudden stiffness loss", "stiffness-loss"),
    entry!("Constant parameters", "constant"),
    entry!("Slow drift", "slow-drift"),
    entry!("Acceleration only", "acceleration-only"),
    entry!("Free vibration", "free-vibration"),
    entry!("Hammer blows", "hammer"),
    entry!("Chirp", "chirp"),
    entry!("Known parameters", "known-parameters"),
    entry!("No excitation", "no-excitation"),
    entry!("Duffing oscillator", "duffing"),
    entry!("Bouc-Wen hysteresis", "bouc-wen"),
    entry!("Shear building", "shear-building"),
    entry!("Q too small", "q-too-small"),
    entry!("Q too large", "q-too-large"),
    entry!("R wrong by ten", "r-wrong-by-ten"),
];

impl Entry {
    /// What one sees, in a sentence: the file's first comment.
    pub fn description(&self) -> &'static str {
        self.toml.lines().next().unwrap_or_default().trim_start_matches(['#', ' '])
    }

    /// The scenario.
    ///
    /// # Errors
    /// [`ScenarioError`] where the file is wrong, which a test rules out.
    pub fn scenario(&self) -> Result<Scenario, ScenarioError> {
        Scenario::from_toml(self.toml)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_is_a_scenario_with_a_description() {
        for entry in ENTRIES {
            assert!(entry.scenario().is_ok(), "{}: {:?}", entry.name, entry.scenario());
            assert!(entry.description().len() > 20, "{}: {}", entry.name, entry.description());
        }
        let files = std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/assets/scenarios")).unwrap().count();
        assert_eq!(files, ENTRIES.len(), "each file is in the menu");
    }

    #[test]
    fn the_first_is_what_opens() {
        assert_eq!(ENTRIES[0].scenario().unwrap(), Scenario::default());
    }
}
