//! The time that a filter takes for one sample.

use std::sync::Arc;
use std::time::{Duration, Instant};

use kalmanscope_core::{Run, RunError, Scenario};

/// Limits the repetitions of a filter, together with [`PATIENCE`]; the shortest time counts.
const REPEATS: usize = 7;
const PATIENCE: Duration = Duration::from_millis(500);

/// Time per step of each filter \[ns\], measured by running it alone over the record of a finished run; `None` for a
/// filter without a step.
///
/// # Errors
/// [`RunError`] where the run does not belong to the scenario.
pub fn step_times(scenario: &Scenario, run: &Run) -> Result<Vec<Option<f64>>, RunError> {
    let record = Arc::new(run.record().clone());
    let mut times = Vec::new();
    for (filter, estimates) in scenario.filters.iter().zip(run.estimates()) {
        let steps = estimates.len().saturating_sub(1);
        if steps == 0 {
            times.push(None);
            continue;
        }
        let alone = Scenario { filters: vec![filter.clone()], ..scenario.clone() };
        let started = Instant::now();
        let mut best = Duration::MAX;
        for _ in 0..REPEATS {
            let mut run = Run::on_record(&alone, Arc::clone(&record))?;
            let begin = Instant::now();
            run.advance_to(estimates.len());
            best = best.min(begin.elapsed());
            if started.elapsed() > PATIENCE {
                break;
            }
        }
        times.push(Some(best.as_secs_f64() * 1e9 / steps as f64));
    }
    Ok(times)
}
