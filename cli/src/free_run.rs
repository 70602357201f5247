//! Free runs of the identified models, as text.

use kalmanscope_core::Length;
use kalmanscope_core::free_run::one_step;
use kalmanscope_core::{Estimates, Fit, Identified, Quantity, Record, Run, Scenario};

use crate::number::{fixed, short};

pub(crate) struct FreeRunResults {
    pub(crate) name: String,
    pub(crate) is_own: bool,
    pub(crate) samples: usize,
    /// The fits, filter by filter, and each sensor by sensor.
    pub(crate) fits: Vec<FreeFit>,
}

pub(crate) struct FreeFit {
    pub(crate) filter: String,
    pub(crate) sensor: Quantity,
    /// The free run's agreement with the measurements, if there is something to compare.
    pub(crate) free: Option<Fit>,
    /// That of the predictions one step ahead, over the run's own record.
    pub(crate) one_step: Option<Fit>,
}

impl FreeRunResults {
    pub(crate) fn new(name: &str, record: &Record, own: &Record) -> Self {
        // By address: a held-out file may have the same numbers, and is still not the record that the filters followed.
        let is_own = std::ptr::eq(own, record);
        Self { name: name.to_owned(), is_own, samples: record.len(), fits: Vec::new() }
    }

    pub(crate) fn lines(&self, length: Length) -> impl Iterator<Item = String> {
        self.fits.iter().map(move |fit| line(fit, length))
    }
}

fn line(fit: &FreeFit, length: Length) -> String {
    let FreeFit { filter, sensor, free, one_step } = fit;
    let unit = length.in_place_of(sensor.unit());
    let free = free.map_or_else(|| "nothing to compare".to_owned(), |fit| words(fit, unit));
    let ahead = one_step.map_or_else(String::new, |fit| format!("; one step ahead: {}", words(fit, unit)));
    format!("{filter}, {}: {free}{ahead}", sensor.name())
}

pub(crate) fn fits(run: &Run, record: &Record) -> Vec<FreeFit> {
    let is_own = std::ptr::eq(run.record(), record);
    let of = |(place, estimates)| fits_of(run.scenario(), place, estimates, record, is_own);
    run.estimates().iter().enumerate().flat_map(of).collect()
}

/// `None` without a free run. Over the record that the filter has followed, its one-step predictions are compared too.
pub(crate) fn fits_of(
    scenario: &Scenario,
    place: usize,
    estimates: &Estimates,
    record: &Record,
    is_own: bool,
) -> Vec<FreeFit> {
    let (Some(settings), Some(last)) = (scenario.filters.get(place), estimates.len().checked_sub(1)) else {
        return Vec::new();
    };
    let free = Identified::at(scenario, settings, estimates, last).run(record, 0..record.len());
    let fit = |(place, (&sensor, &fit))| {
        let ahead = is_own.then(|| one_step(estimates, record, place, free.fitted..record.len())).flatten();
        FreeFit { filter: estimates.name().to_owned(), sensor, free: fit, one_step: ahead }
    };
    record.sensors().iter().zip(&free.fits).enumerate().map(fit).collect()
}

fn words(fit: Fit, unit: &str) -> String {
    if fit.rms.is_infinite() {
        return "the model runs away".to_owned();
    }
    format!("rms error {} {unit}, fit {} %", short(fit.rms), fixed(fit.percent, 2))
}
