//! The model, the initial belief and the noise of a filter, from its settings.

use super::FilterContext;
use crate::mathematics::filter::{Gaussian, Noise, White};
use crate::mathematics::linalg::{Matrix, Vector};
use crate::{Channel, FilterSettings, Model, Values};

/// A model with the initial belief and the noise of a filter.
pub(crate) struct Beginning {
    pub(crate) model: Model,
    pub(crate) initial: Gaussian,
    /// Q, without the row and the column of a white force; R; λ.
    pub(crate) noise: Noise,
    pub(crate) white: Option<White>,
    /// The places of the components that count but are not estimated.
    pub(crate) considered: Vec<usize>,
}

impl Beginning {
    /// Of a filter with these settings.
    pub(crate) fn of(settings: &FilterSettings, context: &FilterContext<'_>) -> Self {
        let model = context.model(settings);
        let (mean, unit) = initial_state(&model, settings);
        let initial =
            Gaussian::independent(mean.clone(), &spread(&model, settings, &settings.initial_std).component_mul(&unit));
        let process = spread(&model, settings, &settings.process_std).component_mul(&unit);
        let mut process = Matrix::from_diagonal(&process.component_mul(&process));
        let white = White::of(&model, settings.process_std[Channel::WHITE_FORCE], context.hold, context.sensors);
        if let Some(white) = white {
            white.add_rest(&model, mean.as_slice(), context.dt, &mut process);
            white.leave_out(&mut process);
        }
        let sensors = settings.sensor_std.iter().map(|s| s * s).collect();
        let considered = settings.consider.iter().filter_map(|channel| model.place(*channel)).collect();
        Self { model, initial, noise: Noise { process, sensors, fading: settings.fading }, white, considered }
    }

    /// Whether all its numbers are finite.
    pub(crate) fn is_finite(&self) -> bool {
        self.initial.is_finite() && self.noise.is_finite()
    }
}

/// The initial mean as a state, and the size of each channel's unit in the state's unit. For a logarithm that is one
/// over the initial mean. It converts all standard deviations of the settings, including that of the process noise, and
/// stays the same when the estimate moves.
fn initial_state(model: &Model, settings: &FilterSettings) -> (Vector, Vector) {
    let mean: Vec<f64> = model.channels().iter().map(|&c| settings.initial_mean[c]).collect();
    model.to_state(&mean)
}

/// Standard deviations of a model's components; zero for those that the filter knows.
fn spread(model: &Model, settings: &FilterSettings, std: &Values) -> Vector {
    let of = |&channel| if settings.knows(channel) { 0.0 } else { std[channel] };
    Vector::from_iterator(model.size(), model.channels().iter().map(of))
}
