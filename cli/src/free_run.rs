//! Free runs of the identified models, as text.

use std::fmt::Write as _;

use kalmanscope_core::free_run::one_step;
use kalmanscope_core::import::Length;
use kalmanscope_core::{Fit, Identified, Quantity, Record, Run};

use crate::number::{fixed, short};

/// The free run of each filter's final model over a record, a line a filter and sensor: its error, and for the run's own record
/// that of predictions one step ahead. `name` says which record it is.
pub fn free_runs(run: &Run, record: &Record, name: &str) -> String {
    let mut text = format!("\nfree run of the final models over {name}: {} samples\n", record.len());
    for line in lines(run, record) {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "  {line}");
    }
    text
}

/// The lines of [`free_runs`].
pub(crate) fn lines(run: &Run, record: &Record) -> Vec<String> {
    let length = Length::of(run.scenario().record.as_ref());
    let line = |FreeFit { filter, sensor, free, one_step }| {
        let unit = length.in_place_of(sensor.unit());
        let told = free.map_or_else(|| "nothing to compare".to_owned(), |fit| words(fit, unit));
        let ahead = one_step.map_or_else(String::new, |fit| format!("; one step ahead {}", words(fit, unit)));
        format!("{filter}, {}: {told}{ahead}", sensor.name())
    };
    fits(run, record).into_iter().map(line).collect()
}

/// The free run of one filter's final model, for one sensor.
pub(crate) struct FreeFit {
    /// The filter's name.
    pub(crate) filter: String,
    pub(crate) sensor: Quantity,
    /// The free run's agreement with the measurements, if there is something to compare.
    pub(crate) free: Option<Fit>,
    /// That of the predictions one step ahead, over the run's own record.
    pub(crate) one_step: Option<Fit>,
}

/// The free runs of all filters over a record, for each of its sensors.
pub(crate) fn fits(run: &Run, record: &Record) -> Vec<FreeFit> {
    let scenario = run.scenario();
    let is_own = std::ptr::eq(run.record(), record);
    let mut fits = Vec::new();
    for (settings, estimates) in scenario.filters.iter().zip(run.estimates()).filter(|(_, e)| !e.is_empty()) {
        let model = Identified::at(scenario, settings, estimates, estimates.len() - 1);
        let free = model.run(record, 0..record.len());
        for (place, (&sensor, &fit)) in record.sensors().iter().zip(&free.fits).enumerate() {
            let ahead = is_own.then(|| one_step(estimates, record, place, free.fitted..record.len())).flatten();
            fits.push(FreeFit { filter: estimates.name().to_owned(), sensor, free: fit, one_step: ahead });
        }
    }
    fits
}

fn words(fit: Fit, unit: &str) -> String {
    if fit.rms.is_infinite() {
        return "the model runs away".to_owned();
    }
    format!("error {} {unit} rms, fit {} %", short(fit.rms), fixed(fit.percent, 2))
}
