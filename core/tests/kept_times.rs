//! Files whose times are kept.

use kalmanscope_core::import::{Builder, Imported, Mapping, read};
use kalmanscope_core::record::{Record, Timed};
use kalmanscope_core::suggest::{scenario_for, suggest};
use kalmanscope_core::{Channel, FilterKind, Force, Hold, Scenario};

use crate::clocks::{record, run, scenario, told};
use crate::random::Random;

/// A file of a slow chirp and a displacement at these times, in steps of a millisecond: a line between two told values is nearly the
/// force.
fn text(seed: u64, wanted: &[usize]) -> String {
    let force = Force::Chirp { amplitude: 3.0, from: 1.0, to: 4.0, sweep: 30.0 };
    let mut scenario = Scenario { dt: 1e-3, duration: 60.0, hold: Hold::First, force, seed, ..Scenario::default() };
    scenario.plant.set(Channel::NATURAL_FREQUENCY, 6.0);
    scenario.plant.set(Channel::DAMPING_RATIO, 0.05);
    scenario.sensors.truncate(1);
    let record = kalmanscope_core::simulate(&scenario);
    let row = |k: &usize| format!("{:.3},{},{}\n", *k as f64 * 1e-3, record.input()[*k], record.measured(0)[*k]);
    "t [s],force,displacement\n".to_owned() + &wanted.iter().map(row).collect::<String>()
}

fn import(text: &str, even: bool) -> Imported {
    let table = read(text.as_bytes().to_vec(), None).expect("it is a table");
    let (mut mapping, kind) = Mapping::guess(&table);
    mapping.time.even = even;
    Builder::new(&table, &mapping, kind, Hold::First).and_then(Builder::finish).expect("it is a record")
}

/// How far the last estimate of ωₙ and ζ is from the truth, in its standard deviations, after a run from their start values.
fn errors(record: &Record) -> [f64; 2] {
    let scenario = suggest(&scenario_for(record), record).scenario;
    let run = run(&scenario, record.clone());
    let estimates = &run.estimates()[0];
    let last = estimates.len() - 1;
    [(Channel::NATURAL_FREQUENCY, 6.0), (Channel::DAMPING_RATIO, 0.05)].map(|(channel, truth)| {
        let at = estimates.place(channel).expect("it is estimated");
        (estimates.mean(last)[at] - truth) / estimates.std(last, at)
    })
}

/// Times that come as they like are those of the readings, and identify the oscillator within the bands.
#[test]
fn irregular_times_are_kept() {
    let mut random = Random::new(11);
    let (mut within, mut all) = (0, 0);
    for seed in 0..10 {
        let mut wanted = vec![0_usize];
        while wanted[wanted.len() - 1] < 59_800 {
            let wait = -40.0 * (1.0 - random.uniform()).ln();
            wanted.push(wanted[wanted.len() - 1] + (wait as usize).clamp(1, 99));
        }
        let Imported { record, remarks, .. } = import(&text(seed, &wanted), false);
        assert!(remarks[0].starts_with("the times are irregular: the filters take each reading"), "{remarks:?}");
        let clocks = record.clocks().expect("it has times");
        let kept = wanted.iter().filter(|k| {
            let step = (**k as f64 * 1e-3 - record.time(0)) / record.dt();
            step > -1.0 && step <= (record.len() - 1) as f64
        });
        assert_eq!(clocks.readings[0].times.len(), kept.count(), "no reading is lost");
        let errors = errors(&record);
        within += errors.iter().filter(|error| error.abs() <= 2.0).count();
        all += errors.len();
        assert!(errors.iter().all(|error| error.abs() < 5.0), "seed {seed}: {errors:?}");
    }
    assert!(within * 10 >= all * 8, "{within} of {all} in the bands");
}

/// Jitter of less than half a step leaves each reading alone in its step.
#[test]
fn jitter_leaves_a_reading_in_each_step() {
    let mut random = Random::new(5);
    let wanted: Vec<usize> =
        (0..1500).map(|k| (40.0 * (f64::from(k) + 0.8 * (random.uniform() - 0.5))).max(0.0) as usize).collect();
    let text = text(3, &wanted);
    let record = import(&text, false).record;
    let there = record.measured(0).iter().filter(|value| !value.is_nan()).count();
    assert!(there >= record.len() - 2 && record.len() >= 1498, "{there} of {}", record.len());
    let found = errors(&record);
    assert!(found.iter().all(|error| error.abs() < 4.0), "{found:?}");
    let even = import(&text, true);
    assert!(even.record.clocks().is_none() && even.remarks[0].contains("even steps"), "{:?}", even.remarks);
}

/// What is written is read with the same times.
#[test]
fn a_file_of_a_record_keeps_its_times() {
    let base = scenario(FilterKind::KF, 3);
    let record = record(&told(&base, 3), 700).starting_at(12.5);
    let mut file = Vec::new();
    record.write_csv(&mut file).expect("it is written");
    let table = read(file, None).expect("it is a table");
    let (mapping, kind) = Mapping::guess(&table);
    let again = Builder::new(&table, &mapping, kind, Hold::Zero).and_then(Builder::finish).expect("a record").record;
    let seconds = |record: &Record, timed: &Timed| -> Vec<f64> {
        timed.times.iter().map(|step| record.time(0) + step * record.dt()).collect()
    };
    let [own, found] = [&record, &again].map(|record| record.clocks().expect("it has times"));
    for (own, found) in own.readings.iter().zip(&found.readings) {
        let [before, after] = [seconds(&record, own), seconds(&again, found)];
        // The new one begins and ends with the steps of its fastest clock.
        let from = before.iter().position(|time| (time - after[0]).abs() < 1e-9).expect("the first is among them");
        assert!(from < 20 && after.len() + 40 > before.len(), "{from}: {} of {}", after.len(), before.len());
        for (k, time) in after.iter().enumerate() {
            assert!((time - before[from + k]).abs() < 1e-9);
            assert_eq!(found.values[k], own.values[from + k]);
        }
    }
    // At steps that are asked for, the filters know the same at the end.
    let mut at_steps = mapping.clone();
    at_steps.time.dt = Some(0.25);
    let coarse = Builder::new(&table, &at_steps, kind, Hold::Zero).and_then(Builder::finish).expect("a record").record;
    assert!((coarse.dt(), coarse.time(0)) == (0.25, again.time(0)) || coarse.time(0) < again.time(0));
    let count = |record: &Record| record.clocks().map(|clocks| clocks.readings[0].times.len());
    assert!(count(&coarse) > Some(600) && coarse.len() < 40, "{:?} in {}", count(&coarse), coarse.len());
    at_steps.time.dt = Some(1e-12);
    let refused = Builder::new(&table, &at_steps, kind, Hold::Zero).err().expect("it is too long").to_string();
    assert!(refused.contains("samples"), "{refused}");
}
