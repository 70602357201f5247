//! The built-in scenarios.

use kalmanscope_core::{Scenario, ScenarioError};

/// A built-in scenario.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BuiltIn {
    /// The name of its file.
    pub file: &'static str,
    /// Its name in menus.
    pub title: &'static str,
    toml: &'static str,
}

macro_rules! built_in {
    ($folder:literal, $($title:literal: $file:literal),* $(,)?) => {
        &[$(BuiltIn {
            title: $title,
            file: $file,
            toml: include_str!(concat!("../assets/", $folder, "/", $file, ".toml")),
        }),*]
    };
}

/// Every built-in scenario, in the menu's order.
pub const BUILT_IN: &[BuiltIn] = built_in![
    "scenarios",
    "With and without forgetting": "forgetting",
    "Sudden stiffness loss": "stiffness-loss",
    "Constant parameters": "constant",
    "Slow drift": "slow-drift",
    "Acceleration only": "acceleration-only",
    "Free vibration": "free-vibration",
    "Hammer blows": "hammer",
    "Chirp": "chirp",
    "Known parameters": "known-parameters",
    "No excitation": "no-excitation",
    "Duffing oscillator": "duffing",
    "Bouc-Wen hysteresis": "bouc-wen",
    "Shear building": "shear-building",
    "Measured: a circuit": "circuit",
    "Measured: an earthquake": "earthquake",
    "Measured: a staircase": "staircase",
    "Q too small": "q-too-small",
    "Q too large": "q-too-large",
    "R wrong by ten": "r-wrong-by-ten",
    "Outliers": "outliers",
    "Which damping": "which-damping",
    "A hum": "hum",
];

/// Scenarios with an equation as their plant, in the menu's order.
pub const EQUATIONS: &[BuiltIn] = built_in![
    "equations",
    "Pendulum": "pendulum",
    "Van der Pol": "van-der-pol",
    "Dry friction": "dry-friction",
    "Quadratic damping": "quadratic-damping",
    "Vibration absorber": "absorber",
    "Mathieu": "mathieu",
    "Helmholtz": "helmholtz",
    "RLC circuit": "rlc-circuit",
    "Rotor": "rotor",
    "Bridge pier": "bridge-pier",
    "Cart between two springs": "cart",
    "Seismometer": "seismometer",
];

impl BuiltIn {
    /// The scenario that a new user sees first: it shows an effect within seconds.
    pub const FIRST: Self = BUILT_IN[0];

    /// The scenario with this file name.
    pub fn named(file: &str) -> Option<&'static Self> {
        BUILT_IN.iter().chain(EQUATIONS).find(|scenario| scenario.file == file)
    }

    /// A sentence on what the scenario shows: the file's first comment.
    pub fn description(&self) -> &'static str {
        self.toml.lines().next().unwrap_or_default().trim_start_matches(['#', ' '])
    }

    /// The file's text.
    pub const fn toml(&self) -> &'static str {
        self.toml
    }

    /// The scenario.
    ///
    /// # Errors
    /// [`ScenarioError`] where the file is invalid, which a test rules out.
    pub fn scenario(&self) -> Result<Scenario, ScenarioError> {
        Scenario::from_toml(self.toml)
    }
}
