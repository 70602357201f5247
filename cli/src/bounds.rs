//! The Cramér-Rao bounds of a finished run.

use kalmanscope_core::{CramerRao, Run, Scenario};

/// The bound of each of the scenario's filters over the whole record; without samples where the truth is not known.
pub fn bounds(scenario: &Scenario, run: &Run) -> Vec<Option<CramerRao>> {
    let of = |place| {
        let mut bound = CramerRao::new(scenario, place, run.record().dt())?;
        bound.follow(run.record());
        Some(bound)
    };
    (0..scenario.filters.len()).map(of).collect()
}
