//! Runs for tests.

use std::sync::Arc;

use kalmanscope_core::diagnosis::Remedy;
use kalmanscope_core::import::{Builder, Mapping, Table, read};
use kalmanscope_core::record::Input;
use kalmanscope_core::suggest::{scenario_for, suggest};
use kalmanscope_core::{
    Channel, Diagnosis, Diagnostics, Estimates, FilterKind, Hold, Record, Run, Scenario, Task as _,
};

pub(crate) fn finished(scenario: &Scenario) -> Run {
    let mut run = Run::new(scenario).expect("the scenario is possible");
    run.finish();
    assert!(run.len() == scenario.samples() || run.truth_stop().is_some());
    run
}

pub(crate) fn finished_on(scenario: &Scenario, record: impl Into<Arc<Record>>) -> Run {
    let mut run = Run::on_record(scenario, record.into()).expect("the record fits");
    run.finish();
    run
}

pub(crate) fn finished_on_file(scenario: &Scenario, file: impl Into<Vec<u8>>) -> Run {
    let mapping = scenario.record.as_ref().expect("it says what the columns are");
    let table = read(file, mapping.dialect).expect("it is a table");
    let imported = Builder::new(&table, mapping, scenario.input, scenario.hold).and_then(Builder::finish);
    finished_on(scenario, imported.expect("it is a record").record)
}

pub(crate) fn one_filter(kind: FilterKind) -> Scenario {
    let mut scenario = Scenario::default();
    scenario.filters.truncate(1);
    scenario.filters[0].kind = kind;
    scenario
}

pub(crate) fn last(estimates: &Estimates, channel: Channel) -> (f64, f64) {
    let (k, place) = (estimates.len() - 1, estimates.place(channel).expect("it is estimated"));
    (estimates.mean(k)[place], estimates.std(k, place))
}

pub(crate) fn with_input(record: &Record, values: Vec<f64>) -> Record {
    let input = Input { kind: record.input_kind(), hold: record.hold(), values };
    let columns = record.sensors().iter().enumerate().map(|(i, &sensor)| (sensor, record.measured(i).to_vec()));
    let truth = Channel::all().iter().filter_map(|&channel| Some((channel, record.truth(channel)?.to_vec())));
    let other = Record::new(record.dt(), input, columns.collect()).and_then(|other| other.with_truth(truth.collect()));
    other.expect("the columns are as long")
}

pub(crate) fn remedies(run: &Run, filter: usize, record: &Record) -> Vec<Remedy> {
    let estimates = &run.estimates()[filter];
    let diagnostics = Diagnostics::new(estimates, record);
    let diagnosis = Diagnosis::new(&diagnostics, estimates, record, None).expect("there is something to judge");
    let search = diagnosis.search(run.scenario(), filter, &diagnostics, estimates, record);
    search.expect("it can be run").run()
}

/// The last ωₙ and ζ of the first filter that an importer sets up for a table, each with its σ, and the run.
pub(crate) fn identified(table: &Table) -> ([(f64, f64); 2], Run) {
    let (mapping, kind) = Mapping::guess(table);
    let imported = Builder::new(table, &mapping, kind, Hold::First).and_then(Builder::finish);
    let record = imported.expect("it is a record").record;
    let mut scenario = scenario_for(&record);
    scenario.record = Some(mapping);
    let scenario = suggest(&scenario, &record).scenario;
    let run = finished_on(&scenario, record);
    let of = |channel| last(&run.estimates()[0], channel);
    ([Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO].map(of), run)
}
