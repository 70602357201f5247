//! The Cramér-Rao bounds of a scenario's filters.

use crate::{CramerRao, Scenario};

/// A Cramér-Rao bound and the filters that it applies to.
pub struct Bound {
    /// The bound.
    pub bound: CramerRao,
    /// The filters' ids.
    pub filters: Vec<u32>,
}

/// The bounds of a scenario's filters: reuses those of `old` that still apply, and adds new ones for the places that
/// need one.
pub(super) fn bounds_of(
    scenario: &Scenario,
    dt: f64,
    mut old: Vec<Bound>,
    is_needed: impl Fn(usize) -> bool,
) -> Vec<Bound> {
    let mut bounds: Vec<Bound> = Vec::new();
    for place in (0..scenario.filters.len()).filter(|&place| is_needed(place)) {
        let id = scenario.filters[place].id;
        let is_for = |b: &Bound| b.bound.is_for(scenario, place);
        if let Some(same) = bounds.iter_mut().find(|b| is_for(b)) {
            same.filters.push(id);
        } else if let Some(same) = old.iter().position(is_for) {
            bounds.push(Bound { filters: vec![id], ..old.swap_remove(same) });
        } else if let Some(bound) = CramerRao::new(scenario, place, dt) {
            bounds.push(Bound { bound, filters: vec![id] });
        }
    }
    bounds
}
