//! Runs of a trial, a slice after the other.

use std::ops::Range;

use crate::{FreeRun, Identified, Record, Run, Running, Scenario, Sensor};

/// The samples that the free run covers.
const FREE: usize = 16_384;

/// The samples of a trial between two checks of the clock.
const CHUNK: usize = 200;

/// Runs a trial on the first samples of a record. `None` while it is under way, `Some(None)` where it is impossible.
#[expect(clippy::option_option, reason = "a trial is under way, impossible or done")]
pub(super) fn follow(
    trial: &mut Option<Run>,
    scenario: impl FnOnce() -> Scenario,
    record: &Record,
    samples: usize,
    while_time: &mut dyn FnMut() -> bool,
) -> Option<Option<Run>> {
    if trial.is_none() {
        let part = record.part(0..record.len().min(samples));
        *trial = Run::on_record(&scenario(), part.into()).ok();
    }
    let Some(run) = trial else { return Some(None) };
    while run.done() < run.samples() {
        run.advance_to(run.done() + CHUNK);
        if !while_time() && run.done() < run.samples() {
            return None;
        }
    }
    Some(trial.take())
}

/// Runs a trial, then a free run of its final model over the same samples. Returns both, with the model's error for
/// each of the scenario's sensors. `None` while the trial is under way; `Some(None)` if it is impossible. If the filter
/// has stopped, `trial` then keeps its run.
#[expect(clippy::option_option, reason = "a trial is under way, impossible or done")]
pub(super) fn follow_freely(
    trial: &mut Option<Run>,
    free: &mut Option<Running>,
    scenario: impl FnOnce() -> Scenario,
    record: &Record,
    while_time: &mut dyn FnMut() -> bool,
) -> Option<Option<(Run, Vec<f64>)>> {
    if free.is_none() {
        *trial = follow(trial, scenario, record, FREE, while_time)?;
        *free = trial.as_ref().and_then(begin_freely);
        if free.is_none() {
            return Some(None);
        }
    }
    if let (Some(running), Some(run)) = (free.as_mut(), &*trial)
        && !running.advance(run.record(), while_time)
    {
        return None;
    }
    let done = trial.take().zip(free.take());
    Some(done.and_then(|(run, running)| {
        let errors = errors(&run, &running.finish(run.record()))?;
        Some((run, errors))
    }))
}

/// The free run of the first filter's final model, before its first piece. `None` if the filter has stopped.
fn begin_freely(run: &Run) -> Option<Running> {
    let (scenario, record) = (run.scenario(), run.record());
    let estimates = run.estimates().first().filter(|estimates| estimates.stop().is_none())?;
    let model = Identified::at(scenario, &scenario.filters[0], estimates, estimates.len().checked_sub(1)?);
    Some(model.running(record, 0..record.len()))
}

/// The error of a free run for each of the scenario's sensors, if the model has not run away.
fn errors(run: &Run, free: &FreeRun) -> Option<Vec<f64>> {
    let of = |sensor: &Sensor| free.fit(run.record(), sensor.measures).map(|fit| fit.rms);
    let errors = run.scenario().sensors.iter().map(of).collect::<Option<Vec<f64>>>();
    errors.filter(|errors| errors.iter().all(|error| error.is_finite()))
}

/// The log likelihood of all innovations, if the filter went through.
pub(super) fn likelihood(run: &Run) -> Option<f64> {
    let estimates = run.estimates().first().filter(|estimates| estimates.stop().is_none())?;
    let sum: f64 = (1..estimates.len()).map(|k| estimates.log_likelihood(k)).filter(|l| !l.is_nan()).sum();
    sum.is_finite().then_some(sum)
}

/// The log likelihood of the readings at some samples, and their number, if the filter went through.
pub(super) fn likelihood_over(run: &Run, samples: Range<usize>) -> Option<(f64, u32)> {
    let estimates = run.estimates().first().filter(|estimates| estimates.stop().is_none())?;
    let told = samples.map(|k| (estimates.log_likelihood(k), estimates.readings(k))).filter(|(l, _)| !l.is_nan());
    let (sum, readings) = told.fold((0.0, 0), |(sum, all), (l, readings)| (sum + l, all + readings));
    sum.is_finite().then_some((sum, readings))
}

/// The size of the innovations over their expected size: 1 for a consistent filter.
pub(super) fn surprise(run: &Run) -> f64 {
    let Some(estimates) = run.estimates().first() else { return 1.0 };
    // The filter finds its parameters in the first half.
    let half = estimates.len() / 2..estimates.len();
    let (sum, count) = half
        .filter(|&k| !estimates.nis()[k].is_nan())
        .fold((0.0, 0), |(sum, count), k| (sum + estimates.nis()[k], count + estimates.readings(k)));
    let ratio = libm::sqrt(sum / f64::from(count.max(1)));
    if ratio.is_finite() { ratio.clamp(0.1, 10.0) } else { 1.0 }
}

/// The scenario with its first filter alone.
pub(super) fn first_alone(scenario: &Scenario) -> Scenario {
    Scenario { filters: scenario.filters.iter().take(1).cloned().collect(), ..scenario.clone() }
}
