//! What the importer's filters make of a table, with the start values that it finds.

use kalmanscope_core::import::{Builder, Mapping, Table};
use kalmanscope_core::suggest::{scenario_for, suggest};
use kalmanscope_core::{Channel, Hold, Run};

use crate::run::{finished_on, last};

/// The run, and the last ωₙ and ζ of its first filter with their standard deviations.
pub(crate) fn identified(table: &Table) -> ([(f64, f64); 2], Run) {
    let (mapping, kind) = Mapping::guess(table);
    let imported = Builder::new(table, &mapping, kind, Hold::First).and_then(Builder::finish);
    let record = imported.expect("it is a record").record;
    let mut scenario = scenario_for(&record);
    scenario.record = Some(mapping);
    let scenario = suggest(&scenario, &record).scenario;
    let run = finished_on(&scenario, record);
    let of = |channel| last(&run.estimates()[0], channel);
    (([Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO]).map(of), run)
}
