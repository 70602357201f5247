//! Free runs of the identified models, as text.

use std::fmt::Write as _;

use kalmanscope_core::free_run::one_step;
use kalmanscope_core::import::Length;
use kalmanscope_core::{Fit, Identified, Record, Run};

use crate::number::short;

/// The free run of each filter's final model over a record, a line a filter and sensor: its error, and for the run's own record
/// that of predictions one step ahead. `name` says which record it is.
pub fn free_runs(run: &Run, record: &Record, name: &str) -> String {
    let scenario = run.scenario();
    let length = Length::of(scenario.record.as_ref());
    let is_own = std::ptr::eq(run.record(), record);
    let mut text = format!("\nfree run of the final models over {name}: {} samples\n", record.len());
    for (settings, estimates) in scenario.filters.iter().zip(run.estimates()).filter(|(_, e)| !e.is_empty()) {
        let model = Identified::at(scenario, settings, estimates, estimates.len() - 1);
        let free = model.run(record, 0..record.len());
        for (place, (quantity, fit)) in record.sensors().iter().zip(&free.fits).enumerate() {
            let line = fit
                .map_or_else(|| "nothing to compare".to_owned(), |fit| words(fit, length.in_place_of(quantity.unit())));
            // Writing to a string cannot fail.
            let _ = write!(text, "  {}, {}: {line}", estimates.name(), quantity.name());
            if is_own && let Some(fit) = one_step(estimates, record, place, free.fitted..record.len()) {
                let _ = write!(text, "; one step ahead {}", words(fit, length.in_place_of(quantity.unit())));
            }
            text.push('\n');
        }
    }
    text
}

fn words(fit: Fit, unit: &str) -> String {
    if fit.rms.is_infinite() {
        return "the model runs away".to_owned();
    }
    format!("error {} {unit} rms, fit {:.2} %", short(fit.rms), fit.percent)
}
