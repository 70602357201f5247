//! The ends of filters on records without an input.

use kalmanscope_core::suggest::{scenario_for, suggest};
use kalmanscope_core::{Channel, Diagnosis, Diagnostics, Quantity, Run, VerdictKind};

use crate::ambient::{Accelerometer, Ambient};

/// The end of a filter on a record.
pub(crate) struct End {
    /// Relative errors of ωₙ and ζ, and the same in standard deviations.
    pub(crate) errors: [f64; 2],
    pub(crate) sigmas: [f64; 2],
    /// Relative errors of the first guess.
    pub(crate) guess: [f64; 2],
    /// Whether a white force was taken for the cause of the motion.
    pub(crate) is_white: bool,
    pub(crate) verdict: VerdictKind,
    pub(crate) text: String,
    /// The reasons of the start values.
    pub(crate) reasons: String,
}

/// The end of one of the suggested filters.
pub(crate) fn end(ambient: &Ambient, place: usize) -> End {
    let record = ambient.record();
    let suggestion = suggest(&scenario_for(&record), &record);
    let filter = &suggestion.scenario.filters[place];
    let force = filter.augment.contains(&Channel::WHITE_FORCE).then(|| filter.process_std[Channel::WHITE_FORCE]);
    let truth = [ambient.natural_frequency, ambient.damping_ratio];
    let channels = [Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO];
    let guess = [0, 1].map(|i| filter.initial_mean[channels[i]] / truth[i] - 1.0);
    let mut run = Run::on_record(&suggestion.scenario, record.clone().into()).unwrap();
    run.finish();
    let estimates = &run.estimates()[place];
    let last = estimates.len() - 1;
    let places = channels.map(|channel| estimates.place(channel).unwrap());
    let errors = [0, 1].map(|i| estimates.mean(last)[places[i]] / truth[i] - 1.0);
    let stds = [0, 1].map(|i| estimates.std(last, places[i]) / truth[i]);
    let diagnosis = Diagnosis::new(&Diagnostics::new(estimates, &record), estimates, &record, None).unwrap();
    let verdict = diagnosis.verdict.unwrap().kind;
    let text = format!(
        "guess {:+.2} % {:+.0} %, end {:+.2} % {:+.0} % (σ {:.2} % {:.0} %), {:?}, force {force:?}, R {:?}, {}",
        100.0 * guess[0],
        100.0 * guess[1],
        100.0 * errors[0],
        100.0 * errors[1],
        100.0 * stds[0],
        100.0 * stds[1],
        suggestion.scenario.hold,
        filter.sensor_std,
        verdict.name(),
    );
    let is_white = force.is_some();
    let (sigmas, reasons) = ([0, 1].map(|i| errors[i] / stds[i]), suggestion.reasons.join("\n"));
    End { errors, sigmas, guess, verdict, is_white, text, reasons }
}

/// Twenty minutes at 20 Hz, or ten at 50 Hz.
pub(crate) fn building(rate: f64, sensors: &[Quantity], accelerometer: Accelerometer, seed: u64) -> Ambient {
    Ambient {
        natural_frequency: std::f64::consts::TAU * 1.2,
        damping_ratio: 0.04,
        rate,
        seconds: if rate < 30.0 { 1200.0 } else { 600.0 },
        sensors: sensors.to_vec(),
        accelerometer,
        noise: 0.01,
        seed,
    }
}

pub(crate) const SETS: [&[Quantity]; 4] = [
    &[Quantity::DISPLACEMENT],
    &[Quantity::VELOCITY],
    &[Quantity::ACCELERATION],
    &[Quantity::DISPLACEMENT, Quantity::ACCELERATION],
];

/// Three minutes of an accelerometer on a light mass.
pub(crate) fn mass(accelerometer: Accelerometer, rate: f64, seed: u64) -> Ambient {
    Ambient {
        natural_frequency: 19.478,
        damping_ratio: 0.02,
        rate,
        seconds: 180.0,
        sensors: vec![Quantity::ACCELERATION],
        accelerometer,
        noise: 0.02,
        seed,
    }
}
