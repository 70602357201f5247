//! The views, one per file, each a function of an immutable context, and their table.

mod autocorrelation;
mod channels;
mod consistency;
pub(crate) mod diagnosis;
mod filters;
mod frequency_response;
mod gain;
mod handles;
mod innovations;
mod map;
mod matrices;
mod measured;
mod model_classes;
mod monte_carlo;
mod oscillator;
mod parameter_plane;
mod scores;
mod sensors;
pub(crate) mod sketch;
mod spectrogram;
mod tune;
mod weights;

use crate::request::ViewKind;
use crate::session::Wanted;
use crate::view::View;

pub fn view(kind: ViewKind) -> &'static View {
    match kind {
        ViewKind::Oscillator => &oscillator::VIEW,
        ViewKind::Parameters => &channels::PARAMETERS,
        ViewKind::States => &channels::STATES,
        ViewKind::Errors => &channels::ERRORS,
        ViewKind::Measured => &measured::VIEW,
        ViewKind::Innovations => &innovations::VIEW,
        ViewKind::Classes => &model_classes::VIEW,
        ViewKind::Consistency => &consistency::VIEW,
        ViewKind::Autocorrelation => &autocorrelation::VIEW,
        ViewKind::Gain => &gain::VIEW,
        ViewKind::Phase => &parameter_plane::PHASE,
        ViewKind::ParameterPlane => &parameter_plane::VIEW,
        ViewKind::FrequencyResponse => &frequency_response::VIEW,
        ViewKind::Spectrogram => &spectrogram::VIEW,
        ViewKind::Matrices => &matrices::VIEW,
        ViewKind::Scores => &scores::VIEW,
        ViewKind::Filters => &filters::VIEW,
        ViewKind::Map => &map::VIEW,
        ViewKind::MonteCarlo => &monte_carlo::VIEW,
        ViewKind::Tune => &tune::VIEW,
        ViewKind::Sensors => &sensors::VIEW,
    }
}

pub fn wanted(views: &[ViewKind]) -> Wanted {
    views.iter().map(|kind| view(*kind).wanted).fold(Wanted::NOTHING, Wanted::and)
}
