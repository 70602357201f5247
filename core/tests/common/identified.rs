//! What the importer's filters make of a table, with the start values that it finds.

use std::sync::Arc;

use kalmanscope_core::import::{Builder, Mapping, Table};
use kalmanscope_core::suggest::{scenario_for, suggest};
use kalmanscope_core::{Channel, Hold, Run};

/// The run, and the last ωₙ and ζ of its first filter with their standard deviations.
pub(crate) fn identified(table: &Table) -> ([(f64, f64); 2], Run) {
    let (mapping, kind) = Mapping::guess(table);
    let imported = Builder::new(table, &mapping, kind, Hold::First).and_then(Builder::finish);
    let record = imported.expect("it is a record").record;
    let mut scenario = scenario_for(&record);
    scenario.record = Some(mapping);
    let scenario = suggest(&scenario, &record).scenario;
    let mut run = Run::on_record(&scenario, Arc::new(record)).expect("it can be run");
    run.finish();
    let estimates = &run.estimates()[0];
    let last = estimates.len() - 1;
    let found = [Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO].map(|channel| {
        let place = estimates.place(channel).expect("it is estimated");
        (estimates.canonical_mean(last, place), estimates.std(last, place))
    });
    (found, run)
}
