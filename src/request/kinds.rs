//! Kinds of views, of arrangements and of entries in the legend.

use serde::{Deserialize, Serialize};

/// An entry of the legend of all plots.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LegendEntry {
    /// The truth.
    Truth,
    /// The measurements.
    Measured,
    /// The ±2σ bands.
    Bands,
    /// The verdicts on the filters, and the marks of bad parts.
    Verdicts,
    /// The smoothed estimates.
    Hindsight,
    /// The filter with an id.
    Filter(u32),
}

/// The views.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum ViewKind {
    /// The moving mass.
    Oscillator,
    /// Parameters over time.
    Parameters,
    /// States over time.
    States,
    /// Errors within ±2σ and the Cramér-Rao bound.
    Errors,
    /// Measurements against predictions and free runs.
    Measured,
    /// Innovations within ±2√S.
    Innovations,
    /// NIS and NEES.
    Consistency,
    /// Probabilities of the filters as model classes.
    Classes,
    /// Autocorrelation of the innovations.
    Autocorrelation,
    /// Kalman gain over time.
    Gain,
    /// Velocity over displacement.
    Phase,
    /// Two parameters with their covariance.
    ParameterPlane,
    /// Frequency response over the force's spectrum.
    FrequencyResponse,
    /// Power over time and frequency.
    Spectrogram,
    /// Predict and update in numbers.
    Matrices,
    /// Filters side by side.
    Scores,
    /// The filters' numbers side by side.
    Filters,
    /// Verdicts with their evidence, causes and edits.
    Diagnosis,
    /// A score over two settings.
    Map,
    /// Statistics over many seeds.
    MonteCarlo,
    /// A search for the best settings of a filter.
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

    /// Its preferred shape.
    pub(crate) const fn proportions(self) -> Proportions {
        match self {
            Self::Autocorrelation | Self::Phase | Self::ParameterPlane | Self::FrequencyResponse => Proportions::Square,
            Self::Oscillator => Proportions::Flat,
            Self::Map | Self::MonteCarlo | Self::Tune => Proportions::Tall,
            _ => Proportions::Wide,
        }
    }
}

/// The preferred shape of a view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Proportions {
    /// Plots over time, which need width.
    Wide,
    /// A plot over something other than time, about as high as wide.
    Square,
    /// A picture that is much wider than high.
    Flat,
    /// A picture with choices above it, which needs more height than others.
    Tall,
}

/// A ready-made choice of views.
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
    /// Every arrangement.
    pub const ALL: [Self; 4] = [Self::Teach, Self::Tune, Self::Compare, Self::Laboratory];

    /// Its name in the menu.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Teach => "Teach",
            Self::Tune => "Tune",
            Self::Compare => "Compare",
            Self::Laboratory => "Laboratory",
        }
    }
}
