//! Kinds of views, of arrangements, of entries in the legend and of answers.

use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LegendEntry {
    Truth,
    Measured,
    Bands,
    Verdicts,
    Hindsight,
    Filter(u32),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Answer {
    Choice(usize),
    Skipped,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum ViewKind {
    Oscillator,
    Parameters,
    States,
    Errors,
    Measured,
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
    Wide,
    Square,
    Flat,
    Tall,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrangement {
    Teach,
    Tune,
    Compare,
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
