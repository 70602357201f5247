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
mod phase;
mod scores;
mod spectrogram;
mod tune;
mod weights;

use crate::request::ViewKind;
use crate::session::Wanted;
use crate::view::View;

pub fn view(kind: ViewKind) -> &'static dyn View {
    match kind {
        ViewKind::Oscillator => &oscillator::Oscillator,
        ViewKind::Parameters => &channels::Channels::Parameters,
        ViewKind::States => &channels::Channels::States,
        ViewKind::Errors => &channels::Errors,
        ViewKind::Measured => &measured::Measured,
        ViewKind::Innovations => &innovations::Innovations,
        ViewKind::Classes => &model_classes::Classes,
        ViewKind::Consistency => &consistency::Consistency,
        ViewKind::Autocorrelation => &autocorrelation::Autocorrelation,
        ViewKind::Gain => &gain::Gain,
        ViewKind::Phase => &phase::Phase,
        ViewKind::ParameterPlane => &parameter_plane::ParameterPlane,
        ViewKind::FrequencyResponse => &frequency_response::FrequencyResponse,
        ViewKind::Spectrogram => &spectrogram::SpectrogramView,
        ViewKind::Matrices => &matrices::Matrices,
        ViewKind::Scores => &scores::Scores,
        ViewKind::Filters => &filters::Filters,
        ViewKind::Diagnosis => &diagnosis::Diagnosis,
        ViewKind::Map => &map::Map,
        ViewKind::MonteCarlo => &monte_carlo::MonteCarlo,
        ViewKind::Tune => &tune::Tune,
    }
}

pub fn wanted(views: &[ViewKind]) -> Wanted {
    views.iter().map(|kind| view(*kind).wanted()).fold(Wanted::NOTHING, Wanted::and)
}
