//! What is computed from a run beside its estimates.

use kalmanscope_core::diagnostics::{Depth, Diagnostics};
use kalmanscope_core::{CramerRao, Estimates, Run, Scenario};

/// A Cramér-Rao bound and the places of the filters that it is for.
pub struct Bound {
    /// The bound.
    pub bound: CramerRao,
    /// The filters' places in the scenario.
    pub places: Vec<usize>,
}

/// What is to be computed beside the estimates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// The Cramér-Rao bounds, which cost as much as a filter.
    pub bounds: bool,
    /// Diagnostics, and how deep.
    pub diagnostics: Option<Depth>,
}

impl Default for Wanted {
    /// All diagnostics, no bounds.
    fn default() -> Self {
        Self { bounds: false, diagnostics: Some(Depth::All) }
    }
}

/// Diagnostics, bounds and smoothed estimates of a run's filters.
#[derive(Default)]
pub(super) struct Analysis {
    diagnostics: Vec<Diagnostics>,
    wanted: Wanted,
    /// The number of filters, from the first on, whose diagnostics are those of this run and not of an earlier one, and the
    /// places of those in between of which that is not so.
    begun: usize,
    changed: Vec<usize>,
    bounds: Vec<Bound>,
    /// How much the bounds are still worth.
    validity: Validity,
    smoothed: Vec<(usize, Estimates)>,
}

/// What has changed since bounds were computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
enum Validity {
    /// The truth.
    #[default]
    None,
    /// The filters.
    Truth,
    /// Nothing.
    All,
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

    pub(super) fn wanted(&self) -> Wanted {
        self.wanted
    }

    /// Says what is to be computed from now on.
    pub(super) fn want(&mut self, wanted: Wanted) {
        if self.wanted.bounds != wanted.bounds {
            self.bounds.clear();
            self.validity = Validity::None;
        }
        if self.wanted.diagnostics != wanted.diagnostics {
            self.diagnostics.clear();
            self.begun = 0;
        }
        self.wanted = wanted;
    }

    /// Before another run.
    pub(super) fn begin_anew(&mut self) {
        self.begun = 0;
        self.validity = Validity::None;
        self.smoothed.clear();
    }

    /// Before the same run with other filters at these places.
    pub(super) fn begin_filters_anew(&mut self, places: &[usize]) {
        self.changed.extend_from_slice(places);
        self.validity = self.validity.min(Validity::Truth);
        self.smoothed.clear();
    }

    /// Takes in what is new of a run. Bounds and hindsight need the scenario that it is of, and hindsight all of it.
    pub(super) fn follow(&mut self, scenario: Option<&Scenario>, run: &Run, whole: bool) {
        let Self { diagnostics, wanted, begun, changed, bounds, validity, smoothed } = self;
        let record = run.record();
        if let Some(depth) = wanted.diagnostics {
            diagnostics.resize_with(run.estimates().len(), || Diagnostics::empty(depth));
        }
        for (place, (diagnostics, estimates)) in diagnostics.iter_mut().zip(run.estimates()).enumerate() {
            if place < *begun && !changed.contains(&place) {
                diagnostics.follow(estimates, record);
            } else {
                diagnostics.restart(estimates, record);
            }
        }
        *begun = diagnostics.len();
        changed.clear();
        if !whole {
            smoothed.clear();
        } else if let Some(scenario) = scenario.filter(|_| smoothed.is_empty()) {
            let with = scenario.filters.iter().enumerate().filter(|(_, filter)| filter.smoother);
            *smoothed = with.map(|(place, _)| place).zip(run.smoothed()).collect();
        }
        if let Some(scenario) = scenario.filter(|_| wanted.bounds) {
            if *validity != Validity::All {
                let old = std::mem::take(bounds);
                *bounds = bounds_of(scenario, record.dt(), old, *validity == Validity::Truth);
                *validity = Validity::All;
            }
            for Bound { bound, .. } in bounds {
                bound.follow(record);
            }
        }
    }
}

/// The bounds of a scenario's filters: those of `old` that are for them, if these are of the same truth; the others are
/// before their first sample, in the memory of what is left of `old`.
fn bounds_of(scenario: &Scenario, dt: f64, mut old: Vec<Bound>, same_truth: bool) -> Vec<Bound> {
    let mut bounds: Vec<Bound> = Vec::new();
    for place in 0..scenario.filters.len() {
        let is_for = |b: &Bound| b.bound.is_for(scenario, place);
        if let Some(same) = bounds.iter_mut().find(|b| is_for(b)) {
            same.places.push(place);
        } else if let Some(same) = old.iter().position(|b| same_truth && is_for(b)) {
            bounds.push(Bound { places: vec![place], ..old.swap_remove(same) });
        } else if let Some(bound) = CramerRao::new(scenario, place, dt) {
            bounds.push(Bound { bound, places: vec![place] });
        }
    }
    for new in bounds.iter_mut().filter(|b| b.bound.is_empty()) {
        let Some(old) = old.pop() else { break };
        new.bound.recycle(old.bound);
    }
    bounds
}
