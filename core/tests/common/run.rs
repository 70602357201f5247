//! Scenarios and runs for tests.

use std::sync::Arc;

use kalmanscope_core::free_decay::Ring;
use kalmanscope_core::import::{Imported, Mapping, Table, build, read};
use kalmanscope_core::record::{Clocks, Input, Timed};
use kalmanscope_core::scenario::Fault;
use kalmanscope_core::suggest::{Suggestion, scenario_for, suggest};
use kalmanscope_core::{
    Channel, CramerRao, Estimates, EventFilter, FilterKind, FilterSettings, Force, Hold, InputKind, Plant, PlantKind,
    Quantity, Record, Run, Sample, Scenario, Sensor, Signal, Sink, Stop, Values, simulate,
};

use crate::numbers::{beliefs, bits};

/// Every plant but the chains of more than ten masses, whose steps are long and the same.
pub(crate) fn plants() -> impl Iterator<Item = PlantKind> {
    PlantKind::ALL.into_iter().filter(|kind| kind.masses() <= 10)
}

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

/// A run whose first filter does not stop.
pub(crate) fn run_on(scenario: &Scenario, record: impl Into<Arc<Record>>) -> Run {
    let run = finished_on(scenario, record);
    assert_eq!(run.estimates()[0].stop(), None);
    run
}

fn built(table: &Table, mapping: &Mapping, kind: InputKind, hold: Hold) -> Imported {
    build(table, mapping, kind, hold, &[]).expect("it is a record")
}

pub(crate) fn forced(dt: f64, hold: Hold, values: Vec<f64>, columns: Vec<(Quantity, Vec<f64>)>) -> Record {
    Record::new(dt, Input { kind: InputKind::Force, hold, values }, columns).expect("the columns are a record")
}

pub(crate) fn with_fault(sensor: &mut Sensor, fault: Fault, numbers: &[f64]) {
    sensor.faults.add(fault, sensor.measures);
    sensor.faults.numbers_mut(fault).expect("it is there").copy_from_slice(numbers);
}

/// The record whose readings have these times of their own, in steps.
pub(crate) fn with_times(record: &Record, time: impl Fn(usize, f64) -> f64) -> Record {
    let timed = |sensor: usize| {
        let there = record.measured(sensor).iter().enumerate().filter(|(_, value)| !value.is_nan());
        let (times, values) = there.map(|(k, value)| (time(sensor, k as f64), *value)).unzip();
        Timed { times, values }
    };
    let clocks = Clocks { input: None, readings: (0..record.sensors().len()).map(timed).collect() };
    record.clone().with_clocks(clocks).expect("the times rise")
}

pub(crate) fn with_input(record: &Record, values: Vec<f64>) -> Record {
    let input = Input { kind: record.input_kind(), hold: record.hold(), values };
    let columns = record.sensors().iter().enumerate().map(|(i, &sensor)| (sensor, record.measured(i).to_vec()));
    let truth =
        record.true_channels().into_iter().filter_map(|channel| Some((channel, record.truth(channel)?.to_vec())));
    let other = Record::new(record.dt(), input, columns.collect()).and_then(|other| other.with_truth(truth.collect()));
    other.expect("the columns are as long")
}

pub(crate) fn simulated(scenario: &Scenario) -> Record {
    let record = simulate(scenario);
    assert_eq!(record.len(), scenario.samples());
    record
}

pub(crate) fn measured(scenario: &Scenario) -> Record {
    simulate(scenario).without_truth()
}

pub(crate) fn truth(record: &Record, channel: Channel) -> &[f64] {
    record.truth(channel).expect("its truth is known")
}

pub(crate) fn one_filter(kind: FilterKind) -> Scenario {
    let mut scenario = Scenario::default();
    scenario.filters.truncate(1);
    scenario.filters[0].kind = kind;
    scenario
}

/// A filter of each kind, with few members.
pub(crate) fn of_all_kinds(settings: &FilterSettings) -> Vec<FilterSettings> {
    let named = |kind: FilterKind| FilterSettings { kind, id: 0, name: kind.name().to_owned(), ..settings.clone() };
    let of = |kind| FilterSettings { ensemble_size: 40, ..named(kind) };
    FilterKind::ALL.map(of).to_vec()
}

/// Bit by bit, with what there was before the update and every remark.
#[track_caller]
pub(crate) fn assert_same_estimates(one: &Estimates, other: &Estimates, what: &str) {
    let updates = |estimates: &Estimates| {
        let sample = |k| [estimates.innovation(k), estimates.innovation_cov(k), estimates.gain(k)].map(bits);
        let updates = (0..estimates.len()).flat_map(sample).flatten();
        updates.chain(estimates.log_likelihoods().map(f64::to_bits)).collect::<Vec<u64>>()
    };
    assert_eq!((one.len(), one.stop()), (other.len(), other.stop()), "{what}");
    assert!(beliefs(one) == beliefs(other) && updates(one) == updates(other), "{what}");
    let rest = |of: &Estimates| [of.nis(), of.determinant(), of.effective_samples()].map(bits);
    assert_eq!((rest(one), one.remarks()), (rest(other), other.remarks()), "{what}");
    assert_eq!(one.checksum(), other.checksum(), "{what}");
}

pub(crate) fn oscillator(natural_frequency: impl Into<Signal>, damping_ratio: impl Into<Signal>) -> Plant {
    let plant = Plant::default().with(Channel::NATURAL_FREQUENCY, natural_frequency);
    plant.with(Channel::DAMPING_RATIO, damping_ratio)
}

pub(crate) fn knowing(kind: FilterKind, [wn, zeta]: [f64; 2]) -> FilterSettings {
    FilterSettings {
        kind,
        initial_mean: values([0.0, 0.0, wn, zeta]),
        initial_std: values([0.3, 1.0, 0.0, 0.0]),
        process_std: values([1e-4, 0.02, 0.0, 0.0]),
        fading: 1.0,
        ..Scenario::default().filters[0].clone()
    }
}

/// The values of x, ẋ, ωₙ and ζ; those of all other channels are zero.
pub(crate) fn values(of: [f64; 4]) -> Values {
    let channels = [Channel::DISPLACEMENT, Channel::VELOCITY, Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO];
    Values::ZERO.with(channels.into_iter().zip(of))
}

pub(crate) fn assets(folder: &str) -> Vec<(String, String)> {
    let folder = format!("{}/../assets/{folder}", env!("CARGO_MANIFEST_DIR"));
    let files = std::fs::read_dir(folder).expect("there is a folder").map(|file| file.expect("it can be read").path());
    let mut files: Vec<_> = files.filter(|path| path.extension().is_some_and(|ending| ending == "toml")).collect();
    files.sort();
    let name = |path: &std::path::Path| path.file_stem().expect("it has a name").to_string_lossy().into_owned();
    files.iter().map(|path| (name(path), std::fs::read_to_string(path).expect("it can be read"))).collect()
}

pub(crate) fn asset(folder: &str, name: &str) -> Scenario {
    let path = format!("{}/../assets/{folder}/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"));
    Scenario::from_toml(&text).unwrap_or_else(|error| panic!("{name}: {error}"))
}

pub(crate) fn built_in(name: &str) -> Scenario {
    asset("scenarios", name)
}

pub(crate) fn last(estimates: &Estimates, channel: Channel) -> (f64, f64) {
    let (k, place) = (estimates.len() - 1, estimates.place(channel).expect("it is estimated"));
    (estimates.mean(k)[place], estimates.std(k, place))
}

pub(crate) fn readings(record: &Record, k: usize) -> Vec<f64> {
    (0..record.sensors().len()).map(|sensor| record.measured(sensor)[k]).collect()
}

pub(crate) fn after_events(scenario: &Scenario, record: &Record) -> EventFilter {
    let mut events = EventFilter::new(scenario, 0).expect("it follows events");
    for k in 0..record.len() {
        events.take(record.time(k), record.input()[k], &readings(record, k)).expect("it is taken in");
    }
    events
}

pub(crate) fn bound(scenario: &Scenario, filter: usize, record: &Record) -> CramerRao {
    let mut bound = CramerRao::new(scenario, filter, scenario.dt).expect("there is a bound");
    bound.follow_to(record.len(), record);
    bound
}

pub(crate) fn imported(table: &Table, hold: Hold) -> (Imported, Mapping) {
    let (mapping, kind) = Mapping::guess(table);
    (built(table, &mapping, kind, hold), mapping)
}

pub(crate) fn suggested(
    table: &Table,
    change_mapping: impl Fn(&mut Mapping),
    change: impl Fn(&mut Scenario),
) -> (Suggestion, Run) {
    let (mut mapping, kind) = Mapping::guess(table);
    let _ = Ring::choose(table, &mut mapping);
    change_mapping(&mut mapping);
    let record = built(table, &mapping, kind, Hold::First).record;
    let mut scenario = scenario_for(&record);
    scenario.record = Some(mapping.clone());
    change(&mut scenario);
    let suggestion = suggest(&scenario, &record);
    let scenario = &suggestion.scenario;
    let record = built(table, scenario.record.as_ref().unwrap_or(&mapping), kind, scenario.hold).record;
    let run = finished_on(scenario, record);
    (suggestion, run)
}

pub(crate) fn identified(table: &Table) -> ([(f64, f64); 2], Run) {
    let (_, run) = suggested(table, |_| (), |_| ());
    let of = |channel| last(&run.estimates()[0], channel);
    ([Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO].map(of), run)
}

/// A covariance of rank one that only shrinks: rounding makes its small variances positive or negative.
pub(crate) fn shrinking(kind: FilterKind) -> Scenario {
    let filter = FilterSettings {
        kind,
        initial_mean: values([0.0, 0.0, 61.7, 0.55]),
        initial_std: values([0.0, 0.0, 1.0, 0.0]),
        process_std: Values::ZERO,
        ..FilterSettings::default()
    };
    let force = Force::Step { amplitude: 0.3, at: 1.9 };
    Scenario { dt: 0.2, duration: 40.0, force, sensors: vec![], filters: vec![filter], ..Scenario::default() }
}

pub(crate) struct Each<F> {
    pub(crate) wants_prior: bool,
    pub(crate) call: F,
}

impl<F: FnMut(&Sample<'_>)> Sink for Each<F> {
    fn push(&mut self, sample: &Sample<'_>) {
        (self.call)(sample);
    }

    fn stop_at(&mut self, stop: Stop) {
        panic!("{stop:?}");
    }

    fn wants_prior(&self) -> bool {
        self.wants_prior
    }
}

/// The record in a file that [`Record::write_csv`] has written.
pub(crate) fn record_of(file: Vec<u8>, scenario: &Scenario) -> Record {
    let table = read(file, None).expect("it is a table");
    let sensors: Vec<Quantity> = scenario.sensors.iter().map(|sensor| sensor.measures).collect();
    let (mapping, kind, _) = Mapping::guess_for(&table, &sensors);
    built(&table, &mapping, kind, Hold::Zero).record
}
