//! The time that a filter takes for one sample.

use std::sync::Arc;
use std::time::{Duration, Instant};

use kalmanscope_core::{Estimates, Record, Run, RunError, Scenario};

/// Limits the repetitions of a filter, together with [`PATIENCE`]; the shortest time counts.
const REPEATS: usize = 7;
const PATIENCE: Duration = Duration::from_millis(500);
/// Limits the samples of a repetition.
const MOST: usize = 100_000;

/// Time per step of each filter \[ns\], measured by running it alone over the beginning of the record of a finished run; `None` for
/// a filter without a step.
///
/// # Errors
/// [`RunError`] where the run does not belong to the scenario.
pub fn step_times(scenario: &Scenario, run: &Run) -> Result<Vec<Option<f64>>, RunError> {
    let ends: Vec<usize> = run.estimates().iter().map(Estimates::len).collect();
    step_times_of(scenario, run.record(), &ends)
}

/// The same for filters that have done this many samples of a record.
///
/// # Errors
/// Those of [`step_times`].
pub(crate) fn step_times_of(
    scenario: &Scenario,
    record: &Record,
    samples: &[usize],
) -> Result<Vec<Option<f64>>, RunError> {
    let record = Arc::new(record.part(0..record.len().min(MOST)));
    let mut times = Vec::new();
    for (filter, &samples) in scenario.filters.iter().zip(samples) {
        let samples = samples.min(record.len());
        if samples < 2 {
            times.push(None);
            continue;
        }
        let alone = Scenario { filters: vec![filter.clone()], ..scenario.clone() };
        let started = Instant::now();
        let mut best = Duration::MAX;
        for _ in 0..REPEATS {
            let mut run = Run::on_record(&alone, Arc::clone(&record))?;
            let begin = Instant::now();
            run.advance_to(samples);
            best = best.min(begin.elapsed());
            if started.elapsed() > PATIENCE {
                break;
            }
        }
        times.push(Some(best.as_secs_f64() * 1e9 / (samples - 1) as f64));
    }
    Ok(times)
}
