//! What is computed from a run beside its estimates.

use kalmanscope_core::{CramerRao, Diagnostics, Estimates, Run, Scenario};

/// A Cramér-Rao bound and the places of the filters that it is for.
pub struct Bound {
    /// The bound.
    pub bound: CramerRao,
    /// The filters' places in the scenario.
    pub places: Vec<usize>,
}

/// Diagnostics, bounds and smoothed estimates of a run's filters.
#[derive(Default)]
pub(super) struct Analysis {
    diagnostics: Vec<Diagnostics>,
    /// Whether the diagnostics are those of this run, and not of an earlier one.
    begun: bool,
    bounds: Vec<Bound>,
    with_bounds: bool,
    smoothed: Vec<(usize, Estimates)>,
}

impl Analysis {
    pub(super) fn diagnostics(&self) -> &[Diagnostics] {
        &self.diagnostics
    }

    pub(super) fn bounds(&self) -> &[Bound] {
        &self.bounds
    }

    pub(super) fn smoothed(&self) -> &[(usize, Estimates)] {
        &self.smoothed
    }

    /// Whether bounds are to be computed. Returns whether that is new.
    pub(super) fn want_bounds(&mut self, wanted: bool) -> bool {
        let new = self.with_bounds != wanted;
        if new {
            self.with_bounds = wanted;
            self.bounds.clear();
        }
        new
    }

    /// Before another run.
    pub(super) fn begin_anew(&mut self) {
        self.begun = false;
        self.bounds.clear();
        self.smoothed.clear();
    }

    /// Takes in what is new of a run. Bounds and hindsight need the scenario that it is of, and hindsight all of it.
    pub(super) fn follow(&mut self, scenario: Option<&Scenario>, run: &Run, whole: bool) {
        let Self { diagnostics, begun, bounds, with_bounds, smoothed } = self;
        let record = run.record();
        diagnostics.resize_with(run.estimates().len(), Diagnostics::default);
        for (diagnostics, estimates) in diagnostics.iter_mut().zip(run.estimates()) {
            if *begun {
                diagnostics.follow(estimates, record);
            } else {
                diagnostics.restart(estimates, record);
            }
        }
        *begun = true;
        if !whole {
            smoothed.clear();
        } else if let Some(scenario) = scenario.filter(|_| smoothed.is_empty()) {
            let with = scenario.filters.iter().enumerate().filter(|(_, filter)| filter.smoother);
            *smoothed = with.map(|(place, _)| place).zip(run.smoothed()).collect();
        }
        if let Some(scenario) = scenario.filter(|_| *with_bounds) {
            if bounds.is_empty() {
                *bounds = bounds_of(scenario, record.dt());
            }
            for Bound { bound, .. } in bounds {
                bound.follow(record);
            }
        }
    }
}

/// The bounds of a scenario's filters, before the first sample.
fn bounds_of(scenario: &Scenario, dt: f64) -> Vec<Bound> {
    let mut bounds: Vec<Bound> = Vec::new();
    for place in 0..scenario.filters.len() {
        if let Some(same) = bounds.iter_mut().find(|b| b.bound.is_for(scenario, place)) {
            same.places.push(place);
        } else if let Some(bound) = CramerRao::new(scenario, place, dt) {
            bounds.push(Bound { bound, places: vec![place] });
        }
    }
    bounds
}
