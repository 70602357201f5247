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
    Map,
    MonteCarlo,
    Tune,
    Sensors,
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
        Self::Map,
        Self::MonteCarlo,
        Self::Tune,
        Self::Sensors,
    ];

    pub(crate) fn tabs(self) -> &'static [Self] {
        let mut views = VIEWS.iter().flat_map(|(_, views)| *views);
        views.find(|view| view.tabs.contains(&self)).map_or(&[], |view| view.tabs)
    }

    pub(crate) const fn proportions(self) -> Proportions {
        match self {
            Self::Autocorrelation | Self::Phase | Self::ParameterPlane | Self::FrequencyResponse => Proportions::Square,
            Self::Oscillator => Proportions::Flat,
            Self::Map | Self::MonteCarlo | Self::Tune | Self::Sensors => Proportions::Tall,
            _ => Proportions::Wide,
        }
    }
}

pub struct Tabs {
    pub name: &'static str,
    pub tabs: &'static [ViewKind],
}

const fn tabs(name: &'static str, tabs: &'static [ViewKind]) -> Tabs {
    Tabs { name, tabs }
}

pub const VIEWS: [(&str, &[Tabs]); 3] = [
    (
        "What happens",
        &[
            tabs("Oscillator", &[ViewKind::Oscillator]),
            tabs("Parameters", &[ViewKind::Parameters]),
            tabs("States", &[ViewKind::States]),
            tabs("Measured and predicted", &[ViewKind::Measured]),
            tabs("Planes", &[ViewKind::Phase, ViewKind::ParameterPlane]),
            tabs("Frequency", &[ViewKind::FrequencyResponse, ViewKind::Spectrogram]),
        ],
    ),
    (
        "Can I believe it",
        &[
            tabs("Errors", &[ViewKind::Errors]),
            tabs("Innovations", &[ViewKind::Innovations, ViewKind::Consistency, ViewKind::Autocorrelation]),
            tabs("Scores", &[ViewKind::Scores, ViewKind::Filters]),
            tabs("Which model", &[ViewKind::Classes]),
        ],
    ),
    (
        "What if",
        &[
            tabs("Laboratory", &[ViewKind::Map, ViewKind::MonteCarlo, ViewKind::Tune, ViewKind::Sensors]),
            tabs("Kalman gain", &[ViewKind::Gain]),
            tabs("Predict and update", &[ViewKind::Matrices]),
        ],
    ),
];

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
            Self::Laboratory => "Experiment",
        }
    }
}
