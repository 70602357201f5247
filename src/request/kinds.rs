//! Kinds of views, of arrangements and of entries in the legend.

use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LegendEntry {
    Truth,
    Measured,
    /// The ±2σ bands.
    Bands,
    Verdicts,
    Hindsight,
    Filter(u32),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum ViewKind {
    Oscillator,
    Parameters,
    States,
    /// Errors within ±2σ and the Cramér-Rao bound.
    Errors,
    /// Measurements against predictions and free runs.
    Measured,
    /// Innovations within ±2√S.
    Innovations,
    Consistency,
    Classes,
    Autocorrelation,
    Gain,
    Phase,
    ParameterPlane,
    FrequencyResponse,
    Spectrogram,
    Matrices,
    Scores,
    Filters,
    Diagnosis,
    Map,
    MonteCarlo,
    Tune,
}

impl ViewKind {
    /// Every view, in the menu's order.
    pub const ALL: [Self; 21] = [
        Self::Oscillator,
        Self::Parameters,
        Self::States,
        Self::Errors,
        Self::Measured,
        Self::Innovations,
        Self::Consistency,
        Self::Classes,
        Self::Autocorrelation,
        Self::Gain,
        Self::Phase,
        Self::ParameterPlane,
        Self::FrequencyResponse,
        Self::Spectrogram,
        Self::Matrices,
        Self::Scores,
        Self::Filters,
        Self::Diagnosis,
        Self::Map,
        Self::MonteCarlo,
        Self::Tune,
    ];

    pub(crate) const fn proportions(self) -> Proportions {
        match self {
            Self::Autocorrelation | Self::Phase | Self::ParameterPlane | Self::FrequencyResponse => Proportions::Square,
            Self::Oscillator => Proportions::Flat,
            Self::Map | Self::MonteCarlo | Self::Tune => Proportions::Tall,
            _ => Proportions::Wide,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Proportions {
    /// Plots over time, which need width.
    Wide,
    /// A plot over something other than time, about as high as wide.
    Square,
    Flat,
    /// A picture with choices above it, which needs more height than others.
    Tall,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrangement {
    /// The story: the moving mass, parameters and states.
    Teach,
    /// For tuning Q and R: parameters, NIS and NEES, innovations and their autocorrelation.
    Tune,
    /// For comparing filters: scores, parameters, errors, their settings, the parameter plane.
    Compare,
    /// For seeing many settings at once: the map, and the states of the setting on screen.
    Laboratory,
}

impl Arrangement {
    pub const ALL: [Self; 4] = [Self::Teach, Self::Tune, Self::Compare, Self::Laboratory];

    pub const fn name(self) -> &'static str {
        match self {
            Self::Teach => "Teach",
            Self::Tune => "Tune",
            Self::Compare => "Compare",
            Self::Laboratory => "Laboratory",
        }
    }
}
