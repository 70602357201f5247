//! Which cause may stand first, remedies of several causes, and causes that need a look at the record.

use kalmanscope_core::import::Mapping;
use kalmanscope_core::scenario::Fault;
use kalmanscope_core::setting::Edit;
use kalmanscope_core::{
    Channel, Diagnostics, FilterKind, Force, Hold, Quantity, Record, Scenario, Sensor, Signal, Task as _, Values,
    signal, simulate,
};
use kalmanscope_diagnosis::{Remedy, VerdictKind, in_percent};

use crate::run::{finished_on, forced, last, measured, one_filter, oscillator, with_fault, with_input};
use crate::{diagnosis, remedies};

fn found(scenario: &Scenario) -> Vec<Remedy> {
    on_record(scenario, measured(scenario))
}

fn on_record(scenario: &Scenario, record: Record) -> Vec<Remedy> {
    let run = finished_on(scenario, record);
    remedies(&run, 0, run.record())
}

fn turned(remedy: &Remedy) -> Vec<&str> {
    remedy.edits.iter().map(|edit| edit.key.as_str()).collect()
}

fn firsts(remedies: &[Remedy]) -> Vec<&'static str> {
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
        let found = firsts(&found(&scenario));
        assert_eq!(found.first(), Some(&"input_gain"), "seed {seed}: {found:?}");
        assert!(!found.contains(&"no_excitation"), "seed {seed}: {found:?}");
    }
}

/// Remedies where the time between samples is told as this many times the true one.
fn three_sensors(seed: u64, told: f64) -> Vec<Remedy> {
    let sensors = [(Quantity::DISPLACEMENT, 0.002), (Quantity::VELOCITY, 0.01), (Quantity::ACCELERATION, 0.1)];
    let plant = oscillator(4.0 + seed as f64 % 5.0, 0.03);
    let mut scenario = Scenario { seed, duration: 40.0, plant, ..one_filter(FilterKind::EKF) };
    scenario.sensors = sensors.map(|(quantity, std)| Sensor::new(quantity, std)).to_vec();
    scenario.filters[0].sensor_std = sensors.iter().map(|(_, std)| *std).collect();
    let record = simulate(&scenario);
    let columns = (0..3).map(|place| (sensors[place].0, record.measured(place).to_vec())).collect();
    on_record(&scenario, forced(told * record.dt(), record.hold(), record.input().to_vec(), columns))
}

#[test]
fn wrong_times_are_told_from_a_wrong_scale() {
    for (seed, told) in [(1, 0.8), (2, 1.25), (3, 1.1), (4, 0.5)] {
        let found = three_sensors(seed, told);
        assert_eq!(firsts(&found).first(), Some(&"times"), "{told}: {found:?}");
        let sentence = &found[0].first.sentence;
        assert!(sentence.contains(&format!("about {:.2}", 1.0 / told)), "{sentence}");
    }
}

#[test]
fn a_sensor_that_disagrees_is_put_right() {
    let repaired = |found: &[Remedy], cause: &str, key: &str| {
        let first = &found[0];
        assert_eq!(first.first.cause.key, cause, "{found:?}");
        assert!(ends_good(first), "{cause}: {first:?}");
        let edit = first.edits.iter().find(|edit| edit.key.ends_with(key));
        edit.unwrap_or_else(|| panic!("{key} is not among {:?}", first.edits)).value.clone()
    };
    let delays = |found: &[Remedy]| -> Vec<f64> {
        let value = repaired(found, "sensor_late", "sensor_delay");
        value.as_array().unwrap().iter().map(|one| one.as_float().unwrap()).collect()
    };
    let scenario =
        |seed: u64| Scenario { seed, duration: 40.0, plant: oscillator(5.0, 0.05), ..one_filter(FilterKind::EKF) };
    for (seed, quantity, by) in [
        (11, Quantity::DISPLACEMENT, 1.15),
        (12, Quantity::VELOCITY, 0.7),
        (13, Quantity::DISPLACEMENT, -1.0),
        (14, Quantity::VELOCITY, -1.0),
    ] {
        let mut scenario = scenario(seed);
        scenario.plant.set(quantity.gain(), by);
        let found = found(&scenario);
        let cause = if by < 0.0 { "sensor_sign" } else { "sensor_scale" };
        let gain = repaired(&found, cause, &format!("initial_mean.{}", quantity.gain().key())).as_float().unwrap();
        assert!((gain / by - 1.0).abs() < 0.05, "{gain} for {by}");
    }
    for (seed, late) in [(21, 0.06), (22, 0.04), (23, 0.11)] {
        let mut scenario = scenario(seed);
        with_fault(&mut scenario.sensors[1], Fault::LATE, &[late]);
        let found = found(&scenario);
        let delays = delays(&found);
        assert!(delays[0] == 0.0 && (delays[1] - late).abs() < 0.01, "{delays:?} for {late}");
    }
    // A filter that takes a sensor for late which is in time.
    let mut wrong = scenario(31);
    wrong.filters[0].sensor_delay = vec![0.0, 0.055];
    let found = found(&wrong);
    let delays = delays(&found);
    assert!(delays.iter().all(|delay| delay.abs() < 0.002), "{delays:?}");
}

/// The table of faults in `faults.md`, to which `docs/verdicts.md` leads.
#[test]
fn every_fault_of_the_table_has_its_cause_first_and_its_remedy() {
    let page = include_str!("faults.md");
    let part = page.split("### Fault, cause and remedy").nth(1).unwrap().split("###").next().unwrap();
    let base = Scenario::from_toml(part.split("```toml").nth(1).unwrap().split("```").next().unwrap()).unwrap();
    let rows = part.lines().filter(|line| line.starts_with("| ") && line.contains('`'));
    let wrong: Vec<String> = rows.filter_map(|row| failure(row, &base)).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

fn failure(row: &str, base: &Scenario) -> Option<String> {
    let words: Vec<&str> = row.split('`').skip(1).step_by(2).collect();
    let [change, cause, remedy] = words[..] else { panic!("{row}") };
    let (key, value) = change.split_once(" = ").unwrap();
    let value = toml::from_str::<toml::Table>(&format!("value = {value}")).unwrap()["value"].clone();
    let mut scenario = Edit::new(key, value).apply(base).unwrap_or_else(|error| panic!("{row}: {error}"));
    // The filter assumes another course of the input than that of the record.
    let record = simulate(if key == "hold" { base } else { &scenario });
    if key == "plant" || key == "plant.kind" {
        scenario.filters[0].plant = Some(base.plant.kind.clone());
    }
    let found = on_record(&scenario, record.without_truth());
    let is_right = found.first().is_some_and(|first| {
        // Another plant comes with those that are next.
        let is_plant = |one: &&Remedy| one.first.edits.iter().any(|edit| edit.key.ends_with(".plant"));
        let names_others = found.iter().filter(is_plant).count() < 2
            || !is_plant(&first)
            || first.first.sentence.contains("; other plants that were tried: ");
        let is_best = ends_good(first) || !found.iter().any(ends_good);
        is_best
            && first.first.cause.key == cause
            && first.edits.iter().any(|edit| edit.key.contains(remedy))
            && names_others
    });
    (!is_right).then(|| {
        format!("{change}: {:?} {:?}", firsts(&found), found.first().map(|first| (&first.first.sentence, &first.edits)))
    })
}

#[test]
fn an_input_that_is_a_smooth_curve_is_put_on_finer_steps() {
    for seed in 1..=3 {
        let force = Force::Chirp { amplitude: 3.0, from: 1.0, to: 25.0, sweep: 60.0 };
        let (plant, hold) = (oscillator(6.0, 0.05), Hold::First);
        let mut scenario =
            Scenario { seed, dt: 0.002, duration: 120.0, hold, force, plant, ..one_filter(FilterKind::EKF) };
        scenario.set_sensors(&[Quantity::DISPLACEMENT]);
        scenario.sensors[0].noise_std = 0.002;
        let fine = simulate(&scenario);
        let some = |values: &[f64]| values.iter().step_by(50).copied().collect();
        let columns = vec![(Quantity::DISPLACEMENT, some(fine.measured(0)))];
        let record = forced(0.1, Hold::First, some(fine.input()), columns);
        (scenario.dt, scenario.record) = (0.1, Some(Mapping::default()));
        let filter = &mut scenario.filters[0];
        (filter.sensor_std, filter.fading) = (vec![0.002], 1.0);
        filter.process_std = Values::ZERO;
        let found = on_record(&scenario, record);
        let edits: Vec<&str> = found.first().into_iter().flat_map(turned).collect();
        assert!(edits.contains(&"record.interpolate"), "seed {seed}: {:?} {edits:?}", firsts(&found));
    }
}

fn tuned(plant: &str) -> Scenario {
    Scenario::from_toml(&format!(
        "dt = 0.01\nduration = 30.0\nforce = {{ white_noise = {{ std = 10.0 }} }}\n[plant]\nnatural_frequency = 6.0\n\
         damping_ratio = 0.04\n{plant}\n[[sensors]]\nmeasures = \"displacement\"\nnoise_std = 0.005\n\
         [[sensors]]\nmeasures = \"velocity\"\nnoise_std = 0.03\n[[filters]]\nkind = \"ekf\"\n\
         initial_mean = {{ natural_frequency = 6.4, damping_ratio = 0.05 }}\n\
         initial_std = {{ natural_frequency = 0.6, damping_ratio = 0.02 }}\n\
         process_std = {{ displacement = 1e-7, velocity = 1e-5, natural_frequency = 6e-5, damping_ratio = 4e-7 }}\n"
    ))
    .unwrap()
}

fn judged(scenario: &Scenario, record: &Record) -> (VerdictKind, Vec<Remedy>) {
    let estimates = &finished_on(scenario, record.clone()).estimates()[0].clone();
    let (diagnostics, diagnosis) = (Diagnostics::new(estimates, record), diagnosis(estimates, record));
    let kind = diagnosis.verdict.as_ref().unwrap().kind;
    let mut search = diagnosis.search(scenario, 0, &diagnostics, estimates, record).unwrap();
    let mut last = 0.0;
    // A slice of time for each little piece of work.
    while !search.advance(&mut || false) {
        assert!(search.progress() >= last, "{last} and then {}", search.progress());
        last = search.progress();
    }
    let remedies = search.finish();
    for (place, one) in remedies.iter().enumerate() {
        let fewer = |other: &Remedy| {
            let has = |key: &&str| keys(one).contains(key);
            !other.first.begins_anew && keys(other).len() < keys(one).len() && keys(other).iter().all(has)
        };
        let enough = |other: &&Remedy| fewer(other) && other.gain >= one.gain && other.explains() >= one.explains();
        let needless = remedies.iter().find(enough).map(keys);
        assert!(needless.is_none(), "remedy {place} has more causes than {needless:?}: {}", told(&remedies));
    }
    assert!(!remedies.iter().any(ends_good) || ends_good(&remedies[0]), "{}", told(&remedies));
    (kind, remedies)
}

fn ends_good(remedy: &Remedy) -> bool {
    remedy.after.as_ref().is_some_and(|verdict| verdict.kind.is_good())
}

fn keys(remedy: &Remedy) -> Vec<&'static str> {
    remedy.causes().map(|likely| likely.cause.key).collect()
}

fn told(remedies: &[Remedy]) -> String {
    let of = |remedy: &Remedy| {
        let after = remedy.after.as_ref().map_or("none", |verdict| verdict.kind.name());
        let sentences: Vec<&str> = remedy.causes().map(|likely| likely.sentence.as_str()).collect();
        format!("{:+.0} {} -> {after}", remedy.gain, sentences.join("; "))
    };
    remedies.iter().map(of).collect::<Vec<_>>().join("\n")
}

#[test]
fn two_faults_have_one_remedy_and_its_verdict_is_kept() {
    for seed in 11..14 {
        let mut scenario = Scenario { seed, ..tuned("input_gain = 1.5\ndisturbance_std = 1.0") };
        scenario.filters[0].sensor_std = vec![0.0022, 0.0134];
        scenario.filters[0].process_std[Channel::VELOCITY] = 0.01;
        let record = measured(&scenario);
        let (before, remedies) = judged(&scenario, &record);
        assert!(!before.is_good(), "seed {seed}: {before:?}");
        let first = &remedies[0];
        assert_eq!(keys(first), ["input_gain", "sensor_noise"], "seed {seed}: {}", told(&remedies));
        assert!(first.then[0].sentence.contains("too small"), "{}", first.then[0].sentence);
        assert!(Remedy::is_explained(&remedies));
        let promised = first.after.as_ref().unwrap().kind;
        assert!(promised.is_good(), "seed {seed}: {promised:?}");
        let repaired = Edit::apply_all(&first.edits, &scenario).unwrap();
        assert_eq!(judged(&repaired, &record).0, promised, "seed {seed}");
        // No two remedies have the same causes.
        let mut sets: Vec<_> = remedies.iter().map(keys).collect();
        sets.iter_mut().for_each(|keys| keys.sort_unstable());
        assert!((0..sets.len()).all(|i| !sets[..i].contains(&sets[i])), "{sets:?}");
    }
}

#[test]
fn a_gain_of_another_unit_is_within_the_reach_of_its_remedy() {
    let scenario = Scenario { seed: 5, ..tuned("input_gain = 3000.0") };
    let record = measured(&scenario);
    let remedies = judged(&scenario, &record).1;
    assert!(keys(&remedies[0]).contains(&"input_gain"), "{}", told(&remedies));
    let repaired = Edit::apply_all(&remedies[0].edits, &scenario).unwrap();
    let gain = last(&finished_on(&repaired, record).estimates()[0], Channel::INPUT_GAIN).0;
    assert!((gain / 3000.0 - 1.0).abs() < 0.1, "{gain}: {}", told(&remedies));
}

#[test]
fn a_frequency_that_drifts_leaves_the_damping_ratio_alone() {
    for seed in 31..34 {
        let mut scenario = Scenario { seed, ..tuned("") };
        let drift = signal::Ramp { from: 6.0, to: 5.3, start: 0.0, end: 30.0 };
        scenario.plant.set(Channel::NATURAL_FREQUENCY, Signal::Ramp(drift));
        let remedies = judged(&scenario, &measured(&scenario)).1;
        let drift = remedies.iter().find(|one| one.first.cause.key == "slow_drift").unwrap();
        let edits = turned(drift);
        assert!(edits.len() == 1 && edits[0].ends_with("process_std.natural_frequency"), "seed {seed}: {edits:?}");
        assert!(drift.first.sentence.starts_with("natural frequency drifts, by about "), "{}", drift.first.sentence);
    }
}

#[test]
fn the_first_remedy_has_the_causes_of_the_faults() {
    let late = Force::Chirp { amplitude: 8.0, from: 2.0, to: 18.0, sweep: 9.0 };
    let noise = Scenario::default().force;
    for (what, seeds, plant, force, sensor_std, causes) in [
        ("a sweep that comes late is no wave", 41..44, "input_delay = 3", late, [0.005, 0.03], &["input_delay"][..]),
        (
            "a gain beside a small R, where nothing disturbs",
            21..24,
            "input_gain = 1.5",
            noise,
            [0.005 / 3.0, 0.01],
            &["input_gain", "sensor_noise"],
        ),
    ] {
        for seed in seeds {
            let mut scenario = Scenario { seed, force, ..tuned(plant) };
            scenario.filters[0].sensor_std = sensor_std.to_vec();
            let remedies = judged(&scenario, &measured(&scenario)).1;
            assert_eq!(keys(&remedies[0]), causes, "{what}, seed {seed}: {}", told(&remedies));
        }
    }
}

#[test]
fn an_input_that_stops_is_named_and_nothing_is_turned_for_it() {
    for seed in 51..54 {
        let scenario = Scenario { seed, ..tuned("") };
        let whole = measured(&scenario);
        let mut values = whole.input().to_vec();
        values[2200..].fill(0.0);
        let first = &judged(&scenario, &with_input(&whole, values)).1[0];
        assert_eq!((keys(first), first.edits.len()), (vec!["still_input"], 0), "seed {seed}");
        let sentence = &first.first.sentence;
        assert!(sentence.starts_with("the input is constant from 22 s on, where "), "{sentence}");
    }
}

#[test]
fn noise_that_changes_is_named_with_its_time() {
    let scenario = Scenario { seed: 7, ..tuned("") };
    let quiet = measured(&scenario);
    let mut noisy = scenario.clone();
    with_fault(&mut noisy.sensors[0], Fault::CHANGING, &[18.0, 3.0]);
    let noisy = measured(&noisy);
    let (before, remedies) = judged(&scenario, &noisy);
    assert!(!before.is_good());
    let found = remedies.iter().flat_map(Remedy::causes).find(|likely| likely.cause.key == "changing_noise");
    let sentence = &found.unwrap().sentence;
    assert!(sentence.starts_with("R of the displacement changes, from 18 s on: innovations² are "), "{sentence}");
    assert!(!judged(&scenario, &quiet).1.iter().any(|one| one.first.cause.key == "changing_noise"));
}

#[test]
fn a_remedy_that_does_not_end_well_does_not_explain() {
    let scenario = Scenario { seed: 4, ..tuned("") };
    // A reading in fifty is far off: no setting of a filter takes that away.
    let spoilt = measured(&scenario).with_measured(|place, k, value| {
        let far = if place == 0 { 0.15 } else { 0.9 };
        if k % 50 == 7 { value + far } else { value }
    });
    let (before, remedies) = judged(&scenario, &spoilt);
    assert!(!before.is_good() && !remedies.is_empty());
    let ends = remedies[0].after.as_ref().unwrap().kind;
    assert_eq!(Remedy::is_explained(&remedies), ends.is_good(), "{}", told(&remedies));
}

#[test]
fn a_delay_is_named_with_its_sign_and_its_number_also_with_gaps() {
    for delay in -3..=3 {
        for seed in 1_000_000..1_000_003 {
            let plant = oscillator(6.0, 0.05);
            let mut scenario = Scenario { seed, duration: 20.0, plant, ..one_filter(FilterKind::EKF) };
            (scenario.plant.input_delay, scenario.filters[0].fading) = (delay, 1.0);
            let whole = simulate(&scenario);
            let is_lost = |place: usize, k: usize| (k + place).is_multiple_of(3) || (300..360).contains(&k);
            for record in [whole.clone().without_truth().with_gaps(is_lost), whole] {
                let found = on_record(&scenario, record);
                let named = found.iter().position(|remedy| remedy.first.cause.key == "input_delay");
                if delay == 0 {
                    assert_eq!(named, None, "seed {seed}: {:?}", found[0].first.sentence);
                    continue;
                }
                let place = named.unwrap_or_else(|| panic!("delay {delay}, seed {seed}: {found:?}"));
                assert!(place < 2, "delay {delay}, seed {seed}: place {place}");
                let likely = &found[place].first;
                assert_eq!(likely.edits[0].toml_line(), format!("input_delay = {delay}"), "seed {seed}");
                let word = if delay > 0 { "early" } else { "late" };
                assert!(likely.sentence.ends_with(word), "delay {delay}: {}", likely.sentence);
            }
        }
    }
}

#[test]
fn a_lead_makes_a_cause_probable_and_others_less_so() {
    let mut likely = found(&Scenario { seed: 5, ..tuned("input_gain = 1.5") }).remove(0);
    (likely.then, likely.edits, likely.after, likely.first.certain) = (Vec::new(), Vec::new(), None, false);
    let with = |gain: &f64| Remedy { gain: *gain, ..likely.clone() };
    let of = |gains: &[f64]| Remedy::probabilities(&gains.iter().map(with).collect::<Vec<_>>());
    let (near, far) = (of(&[100.0, 90.0]), of(&[1000.0, 90.0]));
    assert!(far[0] > near[0] && far[1] < near[1] && near[0] > near[1], "{near:?} {far:?}");
    for gains in [&[f64::NAN, 5.0][..], &[f64::INFINITY], &[1e300, -1e300, f64::NAN], &[]] {
        let all = of(gains);
        assert!(all.len() == gains.len() && all.iter().all(|p| *p >= 0.0), "{gains:?}: {all:?}");
        assert!(all.iter().sum::<f64>() <= 1.0, "{gains:?}: {all:?}");
    }
    assert_eq!([0.001, 0.5, 0.999].map(in_percent), ["< 1 %", "50 %", "> 99 %"]);
}
