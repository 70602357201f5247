//! Diagnostics, bounds and smoothed estimates: everything computed from a run beside its estimates.

use kalmanscope_core::diagnostics::{Depth, Diagnostics};
use kalmanscope_core::{CramerRao, Estimates, Run, Scenario};

/// A Cramér-Rao bound and the filters that it is for.
pub struct Bound {
    /// The bound.
    pub bound: CramerRao,
    /// The filters' ids.
    pub filters: Vec<u32>,
}

/// The computations beside the estimates that are wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// The Cramér-Rao bounds, which cost as much as a filter.
    pub bounds: bool,
    /// Diagnostics, and how deep.
    pub diagnostics: Option<Depth>,
}

impl Wanted {
    /// The estimates alone.
    pub const NOTHING: Self = Self { bounds: false, diagnostics: None };

    /// The Cramér-Rao bounds.
    pub const BOUNDS: Self = Self { bounds: true, diagnostics: None };

    /// Diagnostics of some depth.
    pub const fn diagnostics(depth: Depth) -> Self {
        Self { bounds: false, diagnostics: Some(depth) }
    }

    /// The computations that serve both.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self { bounds: self.bounds || other.bounds, diagnostics: self.diagnostics.max(other.diagnostics) }
    }
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
    /// In the order of the run's filters.
    diagnostics: Vec<Diagnostics>,
    /// The ids of the filters that these are of; 0 where a filter has been computed anew since.
    filters: Vec<u32>,
    wanted: Wanted,
    bounds: Vec<Bound>,
    /// How much the bounds are still worth.
    validity: StillValid,
    smoothed: Vec<Estimates>,
}

/// How much of what the bounds were computed from is still the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
enum StillValid {
    /// The truth has changed.
    #[default]
    Nothing,
    /// The truth is the same, the filters have changed.
    Truth,
    /// Nothing has changed.
    Everything,
}

impl Analysis {
    pub(super) fn diagnostics(&self) -> &[Diagnostics] {
        &self.diagnostics
    }

    pub(super) fn bounds(&self) -> &[Bound] {
        &self.bounds
    }

    pub(super) fn smoothed(&self) -> &[Estimates] {
        &self.smoothed
    }

    pub(super) fn wanted(&self) -> Wanted {
        self.wanted
    }

    /// Says what is to be computed from now on.
    pub(super) fn want(&mut self, wanted: Wanted) {
        if self.wanted.bounds != wanted.bounds {
            self.bounds.clear();
            self.validity = StillValid::Nothing;
        }
        if self.wanted.diagnostics != wanted.diagnostics {
            self.diagnostics.clear();
            self.filters.clear();
        }
        self.wanted = wanted;
    }

    /// Before another run.
    pub(super) fn begin_anew(&mut self) {
        self.filters.fill(0);
        self.validity = StillValid::Nothing;
        self.smoothed.clear();
    }

    /// Before the same run in which the filters with these ids are computed anew.
    pub(super) fn begin_filters_anew(&mut self, ids: &[u32]) {
        self.filters.iter_mut().filter(|id| ids.contains(id)).for_each(|id| *id = 0);
        self.validity = self.validity.min(StillValid::Truth);
        if !ids.is_empty() {
            self.smoothed.clear();
        }
    }

    /// Takes in what is new of a run. Bounds and hindsight need the scenario that it is of, and hindsight all of it.
    pub(super) fn follow(&mut self, scenario: Option<&Scenario>, run: &Run, whole: bool) {
        let Self { diagnostics, filters, wanted, bounds, validity, smoothed } = self;
        let record = run.record();
        if let Some(depth) = wanted.diagnostics {
            follow_filters(diagnostics, filters, depth, run);
        }
        smoothed.retain(|smoothed| run.estimates().iter().any(|estimates| estimates.id() == smoothed.id()));
        if !whole {
            smoothed.clear();
        } else if scenario.is_some() && smoothed.is_empty() {
            *smoothed = run.smoothed();
        }
        if let Some(scenario) = scenario.filter(|_| wanted.bounds) {
            if *validity != StillValid::Everything {
                let old = std::mem::take(bounds);
                *bounds = bounds_of(scenario, record.dt(), old, *validity == StillValid::Truth);
                *validity = StillValid::Everything;
            }
            for Bound { bound, .. } in bounds {
                bound.follow(record);
            }
        }
    }
}

/// Lets the diagnostics of each filter take in what is new of its estimates. `filters` are the ids of those that the
/// diagnostics are of; the others begin at their first sample.
fn follow_filters(diagnostics: &mut Vec<Diagnostics>, filters: &mut Vec<u32>, depth: Depth, run: &Run) {
    let mut old: Vec<(u32, Diagnostics)> = filters.drain(..).zip(diagnostics.drain(..)).collect();
    for estimates in run.estimates() {
        let same = old.iter().position(|(id, _)| *id == estimates.id()).map(|at| old.swap_remove(at).1);
        diagnostics.push(match same {
            Some(mut same) => {
                same.follow(estimates, run.record());
                same
            }
            None => {
                // The memory of what is stale serves again.
                let stale = old.iter().position(|(id, _)| *id == 0).map(|at| old.swap_remove(at).1);
                let mut new = stale.unwrap_or_else(|| Diagnostics::empty(depth));
                new.restart(estimates, run.record());
                new
            }
        });
        filters.push(estimates.id());
    }
}

/// The bounds of a scenario's filters: those of `old` that are for them, if these are of the same truth; the others are
/// before their first sample, in the memory of what is left of `old`.
fn bounds_of(scenario: &Scenario, dt: f64, mut old: Vec<Bound>, same_truth: bool) -> Vec<Bound> {
    let mut bounds: Vec<Bound> = Vec::new();
    for (place, id) in scenario.filters.iter().map(|filter| filter.id).enumerate() {
        let is_for = |b: &Bound| b.bound.is_for(scenario, place);
        if let Some(same) = bounds.iter_mut().find(|b| is_for(b)) {
            same.filters.push(id);
        } else if let Some(same) = old.iter().position(|b| same_truth && is_for(b)) {
            bounds.push(Bound { filters: vec![id], ..old.swap_remove(same) });
        } else if let Some(bound) = CramerRao::new(scenario, place, dt) {
            bounds.push(Bound { bound, filters: vec![id] });
        }
    }
    for new in bounds.iter_mut().filter(|b| b.bound.is_empty()) {
        let Some(old) = old.pop() else { break };
        new.bound.recycle(old.bound);
    }
    bounds
}
