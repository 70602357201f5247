//! Runs for tests.

use kalmanscope_core::{Run, Scenario};

/// The run of a scenario to its end, or until the truth stops.
pub(crate) fn finished(scenario: &Scenario) -> Run {
    let mut run = Run::new(scenario).expect("the scenario is possible");
    run.finish();
    assert!(run.len() == scenario.samples() || run.truth_stop().is_some());
    run
}
