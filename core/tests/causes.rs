//! Rules about which cause may stand first.

use kalmanscope_core::diagnosis::Remedy;
use kalmanscope_core::import::Mapping;
use kalmanscope_core::record::{Input, Record};
use kalmanscope_core::setting::Edit;
use kalmanscope_core::{
    Channel, Diagnosis, Diagnostics, Force, Hold, Quantity, Run, Scenario, Sensor, Task as _, Values, simulate,
};

use crate::run::{finished_on, remedies};

fn searched(run: &Run) -> Vec<Remedy> {
    let estimates = &run.estimates()[0];
    let diagnostics = Diagnostics::new(estimates, run.record());
    let Some(diagnosis) = Diagnosis::new(&diagnostics, estimates, run.record(), None) else { return Vec::new() };
    let search = diagnosis.search(run.scenario(), 0, &diagnostics, estimates, run.record());
    search.expect("it can be run").run()
}

fn found(scenario: &Scenario) -> Vec<Remedy> {
    on_record(scenario, simulate(scenario).without_truth())
}

fn on_record(scenario: &Scenario, record: Record) -> Vec<Remedy> {
    let run = finished_on(scenario, record);
    remedies(&run, 0, run.record())
}

fn keys(remedies: &[Remedy]) -> Vec<&'static str> {
    remedies.iter().map(|remedy| remedy.first.cause.key).collect()
}

#[test]
fn an_accelerometer_under_a_broadband_force_is_not_still() {
    for seed in 3..7 {
        let scenario = Scenario::from_toml(&format!(
            "seed = {seed}\ndt = 0.01\nduration = 30.0\nforce = {{ white_noise = {{ std = 10.0 }} }}\n\
             [plant]\nnatural_frequency = 6.0\ndamping_ratio = 0.05\ninput_gain = 1.5\n\
             [[sensors]]\nmeasures = \"acceleration\"\nnoise_std = 0.5\n[[filters]]\nkind = \"ekf\"\n"
        ))
        .unwrap();
        let found = keys(&found(&scenario));
        assert_eq!(found.first(), Some(&"input_gain"), "seed {seed}: {found:?}");
        assert!(!found.contains(&"no_excitation"), "seed {seed}: {found:?}");
    }
}

#[test]
fn a_drift_is_no_sudden_change() {
    let mut scenario = Scenario::from_toml(include_str!("../../assets/scenarios/slow-drift.toml")).unwrap();
    scenario.filters.truncate(1);
    for seed in 0..3 {
        scenario.seed = seed;
        let found = found(&scenario);
        assert_ne!(keys(&found).first(), Some(&"sudden_change"), "seed {seed}: {:?}", keys(&found));
    }
}

#[test]
fn remedies_that_end_good_stand_first() {
    let scenario = Scenario::from_toml(
        "seed = 3\ndt = 0.01\nduration = 40.0\nforce = { white_noise = { std = 10.0 } }\n\
         [plant]\nnatural_frequency = { step = { from = 6.0, to = 5.2, at = 24.0 } }\ndamping_ratio = 0.03\n\
         [[sensors]]\nmeasures = \"displacement\"\nnoise_std = 0.002\n\
         [[sensors]]\nmeasures = \"acceleration\"\nnoise_std = 0.3\n\
         [[filters]]\nkind = \"ekf\"\nprocess_std = { displacement = 1e-8, velocity = 1e-6, natural_frequency = 6e-5, \
         damping_ratio = 3e-7 }\n",
    )
    .unwrap();
    for seed in 3..6 {
        let found = found(&Scenario { seed, ..scenario.clone() });
        let ends_good = |remedy: &Remedy| remedy.after.as_ref().is_some_and(|verdict| verdict.kind.is_good());
        assert!(!found.is_empty());
        if found.iter().any(ends_good) {
            assert!(ends_good(&found[0]), "seed {seed}: {:?}", keys(&found));
        }
        // A factor that silences a sensor is no explanation.
        assert_ne!(found[0].first.cause.key, "sensor_noise", "seed {seed}: {}", found[0].first.sentence);
    }
}

/// Remedies where times or scales are wrong: `change` gets the place of a sensor and a reading.
fn three_sensors(seed: u64, told: f64, change: impl Fn(usize, f64) -> f64) -> Vec<Remedy> {
    let sensors = [(Quantity::DISPLACEMENT, 0.002), (Quantity::VELOCITY, 0.01), (Quantity::ACCELERATION, 0.1)];
    let mut scenario = Scenario { seed, duration: 40.0, ..Scenario::default() };
    scenario.plant.set(Channel::NATURAL_FREQUENCY, 4.0 + seed as f64 % 5.0);
    scenario.plant.set(Channel::DAMPING_RATIO, 0.03);
    scenario.sensors = Vec::new();
    for (quantity, std) in sensors {
        scenario.add_sensor(Sensor::new(quantity, std));
    }
    scenario.filters.truncate(1);
    scenario.filters[0].sensor_std = sensors.iter().map(|(_, std)| *std).collect();
    let record = simulate(&scenario);
    let columns: Vec<_> = (0..3)
        .map(|place| (sensors[place].0, record.measured(place).iter().map(|value| change(place, *value)).collect()))
        .collect();
    let input = Input { kind: record.input_kind(), hold: record.hold(), values: record.input().to_vec() };
    let record = Record::new(told * record.dt(), input, columns).expect("the columns are a record");
    on_record(&scenario, record)
}

#[test]
fn wrong_times_are_told_from_a_wrong_scale() {
    let first = |remedies: &[Remedy]| remedies.first().map_or("none", |remedy| remedy.first.cause.key);
    for (seed, told) in [(1, 0.8), (2, 1.25), (3, 1.1), (4, 0.5)] {
        let found = three_sensors(seed, told, |_, value| value);
        assert_eq!(first(&found), "times", "{told}: {found:?}");
        let sentence = &found[0].first.sentence;
        assert!(sentence.contains(&format!("about {:.2}", 1.0 / told)), "{sentence}");
    }
    for (seed, scaled, by) in [(5, 0, 1.2), (6, 1, 0.8), (7, 2, 1.3), (8, 1, 1.25)] {
        let found = three_sensors(seed, 1.0, |place, value| if place == scaled { by * value } else { value });
        assert!(!keys(&found).contains(&"times"), "{scaled} by {by}: {found:?}");
        assert_eq!(first(&found), "sensor_scale", "{scaled} by {by}: {found:?}");
    }
}

#[test]
fn a_sensor_that_disagrees_is_put_right() {
    let repaired = |found: &[Remedy], cause: &str, key: &str| {
        let first = &found[0];
        assert_eq!(first.first.cause.key, cause, "{found:?}");
        assert!(first.after.as_ref().is_some_and(|verdict| verdict.kind.is_good()), "{cause}: {first:?}");
        let edit = first.edits.iter().find(|edit| edit.key.ends_with(key));
        edit.unwrap_or_else(|| panic!("{key} is not among {:?}", first.edits)).value.clone()
    };
    let scenario = |seed: u64| {
        let mut scenario = Scenario { seed, duration: 40.0, ..Scenario::default() };
        scenario.plant.set(Channel::NATURAL_FREQUENCY, 5.0);
        scenario.filters.truncate(1);
        scenario
    };
    for (seed, quantity, by) in [
        (11, Quantity::DISPLACEMENT, 1.15),
        (12, Quantity::VELOCITY, 0.7),
        (13, Quantity::DISPLACEMENT, -1.0),
        (14, Quantity::VELOCITY, -1.0),
    ] {
        let mut scenario = scenario(seed);
        scenario.plant.set(quantity.gain(), by);
        let found = on_record(&scenario, simulate(&scenario).without_truth());
        let cause = if by < 0.0 { "sensor_sign" } else { "sensor_scale" };
        let gain = repaired(&found, cause, &format!("initial_mean.{}", quantity.gain().key())).as_float().unwrap();
        assert!((gain / by - 1.0).abs() < 0.05, "{gain} for {by}");
    }
    for (seed, late) in [(21, 0.06), (22, 0.04), (23, 0.11)] {
        let scenario = scenario(seed);
        let text = scenario.to_toml().unwrap();
        let faults = format!("measures = \"velocity\"\nfaults = {{ late = {{ delay = {late} }} }}\n");
        let scenario = Scenario::from_toml(&text.replace("measures = \"velocity\"\n", &faults)).unwrap();
        let found = on_record(&scenario, simulate(&scenario).without_truth());
        let delays = repaired(&found, "sensor_late", "sensor_delay");
        let delays: Vec<f64> = delays.as_array().unwrap().iter().map(|one| one.as_float().unwrap()).collect();
        assert!(delays[0] == 0.0 && (delays[1] - late).abs() < 0.01, "{delays:?} for {late}");
    }
    // A filter that takes a sensor for late which is in time.
    let mut wrong = scenario(31);
    wrong.filters[0].sensor_delay = vec![0.0, 0.055];
    let found = on_record(&wrong, simulate(&wrong).without_truth());
    let delays = repaired(&found, "sensor_late", "sensor_delay");
    let delays: Vec<f64> = delays.as_array().unwrap().iter().map(|one| one.as_float().unwrap()).collect();
    assert!(delays.iter().all(|delay| delay.abs() < 0.002), "{delays:?}");
}

/// The table of faults in `docs/verdicts.md`.
#[test]
fn every_fault_of_the_table_has_its_cause_first_and_its_remedy() {
    let page = include_str!("../../docs/verdicts.md");
    let part = page.split("### Fault, cause and remedy").nth(1).unwrap().split("###").next().unwrap();
    let base = Scenario::from_toml(part.split("```toml").nth(1).unwrap().split("```").next().unwrap()).unwrap();
    let rows = part.lines().filter(|line| line.starts_with("| ") && line.contains('`'));
    let wrong: Vec<String> = rows.filter_map(|row| failure(row, &base)).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Returns the causes that were found, if the first is not the one of the row, or lacks its remedy.
fn failure(row: &str, base: &Scenario) -> Option<String> {
    let words: Vec<&str> = row.split('`').skip(1).step_by(2).collect();
    let [change, cause, remedy] = words[..] else { panic!("{row}") };
    let (key, value) = change.split_once(" = ").unwrap();
    let value = toml::from_str::<toml::Table>(&format!("value = {value}")).unwrap()["value"].clone();
    let mut scenario = Edit::new(key, value).apply(base).unwrap_or_else(|error| panic!("{row}: {error}"));
    // The filter assumes another course of the input than that of the record.
    let record = simulate(if key == "hold" { base } else { &scenario });
    if key == "plant" || key == "plant.kind" {
        scenario.filters[0].plant = Some(base.plant.kind);
    }
    let found = searched(&finished_on(&scenario, record.without_truth()));
    let is_right = found.first().is_some_and(|first| {
        // Another plant comes with those that are next.
        let is_plant = |one: &&Remedy| one.first.edits.iter().any(|edit| edit.key.ends_with(".plant"));
        let names_others = found.iter().filter(is_plant).count() < 2
            || !is_plant(&first)
            || first.first.sentence.contains("; other plants that were tried: ");
        first.first.cause.key == cause && first.edits.iter().any(|edit| edit.key.contains(remedy)) && names_others
    });
    (!is_right).then(|| {
        format!("{change}: {:?} {:?}", keys(&found), found.first().map(|first| (&first.first.sentence, &first.edits)))
    })
}

/// Ten samples a swing, of an input without steps or corners.
#[test]
fn an_input_that_is_a_smooth_curve_is_put_on_finer_steps() {
    for seed in 1..=3 {
        let force = Force::Chirp { amplitude: 3.0, from: 1.0, to: 25.0, sweep: 60.0 };
        let mut scenario =
            Scenario { seed, dt: 0.002, duration: 120.0, hold: Hold::First, force, ..Scenario::default() };
        scenario.set_sensors(&[Quantity::DISPLACEMENT]);
        scenario.sensors[0].noise_std = 0.002;
        scenario.plant.set(Channel::NATURAL_FREQUENCY, 6.0);
        let fine = simulate(&scenario);
        let some = |values: &[f64]| values.iter().step_by(50).copied().collect();
        let input = Input { kind: fine.input_kind(), hold: Hold::First, values: some(fine.input()) };
        let record = Record::new(0.1, input, vec![(Quantity::DISPLACEMENT, some(fine.measured(0)))]).unwrap();
        (scenario.dt, scenario.record) = (0.1, Some(Mapping::default()));
        scenario.filters.truncate(1);
        let filter = &mut scenario.filters[0];
        (filter.sensor_std, filter.fading) = (vec![0.002], 1.0);
        filter.process_std = Values::ZERO;
        let run = finished_on(&scenario, record);
        let found = searched(&run);
        let edits: Vec<&str> =
            found.first().into_iter().flat_map(|one| &one.edits).map(|edit| edit.key.as_str()).collect();
        assert!(edits.contains(&"record.interpolate"), "seed {seed}: {:?} {edits:?}", keys(&found));
    }
}
