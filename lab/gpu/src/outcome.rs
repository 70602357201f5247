//! From the shader's sums to the outcome of a run.

use kalmanscope_core::diagnostics::{Tally, Total};
use kalmanscope_core::kernel::abreast::{OscillatorFilter, log_likelihood};
use kalmanscope_core::score::{ChannelSums, Outcome};
use kalmanscope_core::{Channel, FilterError, Record, Stop};

use crate::layout::State;
use crate::tape::{CHANNELS, Tape};

/// A run that has been done.
pub(crate) struct Ran<'a> {
    pub(crate) filter: &'a OscillatorFilter,
    pub(crate) record: &'a Record,
    pub(crate) tape: &'a Tape,
}

/// The outcome of a run.
pub(crate) fn outcome(ran: &Ran<'_>, state: &State) -> Outcome {
    let stop = (state.stopped > 0).then(|| Stop { sample: state.stopped as usize, reason: reason(state.reason) });
    let samples = stop.map_or(ran.record.len(), |stop| stop.sample);
    let [degrees, measured] = ran.tape.measured[samples - 1];
    let sums = channels(ran, state, samples);
    Outcome {
        samples,
        nees: Total { sum: state.nees, degrees: state.nees_degrees, samples: state.nees_samples },
        nis: Total { sum: state.nis, degrees, samples: measured },
        log_likelihood: if degrees > 0 { log_likelihood(state.nis, state.ln_determinants, degrees) } else { 0.0 },
        stop,
        diverged: stop.is_some() || sums.iter().any(|(_, sums)| sums.is_lost()),
        channels: sums.iter().filter_map(|(channel, sums)| Some((*channel, sums.score(samples)?))).collect(),
        mean: state.mean.to_vec(),
        std: state.variance.map(f64::sqrt).to_vec(),
        looks: Vec::new(),
    }
}

/// The sums of the channels whose truth is known.
fn channels(ran: &Ran<'_>, state: &State, samples: usize) -> Vec<(Channel, ChannelSums)> {
    let Some(largest_truth) = ran.tape.largest_truth.get(samples - 1) else { return Vec::new() };
    let initial = &ran.filter.initial;
    let recent = samples.saturating_sub(ran.record.len() * 4 / 5) as u32;
    let of = |place: usize| {
        let channel = CHANNELS[place];
        let truth = |k: usize| ran.record.truth(channel).map_or(f64::NAN, |truth| truth[k]);
        // In canonical form, in which the natural frequency is not negative.
        let error = |mean: f64, frequency: f64, k: usize| {
            let sign = if channel.is_mirrored() && frequency < 0.0 { -1.0 } else { 1.0 };
            sign * mean - truth(k)
        };
        let sums = ChannelSums {
            total: Tally { squares: state.squares[place], known: samples as u32, inside: state.inside[place] },
            first_error: error(initial.mean[place], initial.mean[2], 0).abs(),
            largest_truth: largest_truth[place],
            settled: state.settled[place] as usize,
            recent: (state.recent[place], recent),
            error: error(state.mean[place], state.mean[2], samples - 1),
            std: state.variance[place].sqrt(),
            initial_std: initial.cov[(place, place)].sqrt(),
        };
        (channel, sums)
    };
    (0..CHANNELS.len()).map(of).collect()
}

/// As `belief.wgsl` numbers them.
fn reason(number: u32) -> FilterError {
    match number {
        2 => FilterError::SingularInnovation,
        _ => FilterError::NotFinite,
    }
}
