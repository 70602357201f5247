//! From the shader's sums to the outcome of a run.

use kalmanscope_core::diagnostics::{ErrorSums, Total};
use kalmanscope_core::internals::engine::Setup;
use kalmanscope_core::internals::{ChannelSums, log_likelihood};
use kalmanscope_core::score::Outcome;
use kalmanscope_core::{Channel, FilterError, Record, Stop};

use crate::layout::{State, Tape, Tracked};

pub(crate) struct Ran<'a> {
    pub(crate) setup: &'a Setup,
    pub(crate) record: &'a Record,
    pub(crate) tape: &'a Tape,
}

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
        mean: state.mean.clone(),
        std: state.variance.iter().map(|variance| variance.sqrt()).collect(),
        sample_scores: Vec::new(),
    }
}

fn channels(ran: &Ran<'_>, state: &State, samples: usize) -> Vec<(Channel, ChannelSums)> {
    let Ran { setup, record, tape } = ran;
    let known = state.tracked.len();
    let recent = samples.saturating_sub(record.len() * 4 / 5) as u32;
    let frequency = setup.channels.iter().position(|&channel| channel == Channel::NATURAL_FREQUENCY);
    let of = |(place, tracked): (usize, &Tracked)| {
        let channel = setup.channels[place];
        let truth = |k: usize| record.truth(channel).map_or(f64::NAN, |truth| truth[k]);
        // In canonical form, in which the natural frequency is not negative.
        let error = |mean: &[f64], k: usize| {
            let is_negative = frequency.is_some_and(|place| mean[place] < 0.0);
            let sign = if channel.is_mirrored() && is_negative { -1.0 } else { 1.0 };
            sign * mean[place] - truth(k)
        };
        let sums = ChannelSums {
            total: ErrorSums { squares: tracked.squares, known: samples as u32, inside: tracked.inside },
            first_error: error(&setup.mean, 0).abs(),
            largest_truth: tape.largest_truth[(samples - 1) * known + place],
            settled: tracked.settled as usize,
            recent: (tracked.recent, recent),
            error: error(&state.mean, samples - 1),
            std: state.variance[place].sqrt(),
            initial_std: setup.variance[place].sqrt(),
        };
        (channel, sums)
    };
    state.tracked.iter().enumerate().map(of).collect()
}

/// As `belief.wgsl` numbers them.
fn reason(number: u32) -> FilterError {
    match number {
        2 => FilterError::SingularInnovation,
        _ => FilterError::NotFinite,
    }
}
