//! Sensors that are late or early: filters that know, in every way in which a filter can run.

use std::sync::Arc;

use kalmanscope_core::record::{Clocks, Input, LiveRecord, Record, Timed};
use kalmanscope_core::{
    Channel, Estimates, EventFilter, FilterKind, OnlineFilter, Quantity, Run, Scenario, Source, Trouble, simulate,
};

/// The delays of displacement and velocity \[s\]: whole steps of 0.01 s, parts of steps, late and early.
const DELAYS: [[f64; 2]; 5] = [[0.05, 0.0], [0.0, 0.02], [0.0235, 0.0], [-0.03, 0.0077], [0.041, 0.0415]];

fn scenario(kind: FilterKind, delays: [f64; 2]) -> Scenario {
    let mut scenario = Scenario { duration: 6.0, ..Scenario::default() };
    scenario.plant.set(Channel::NATURAL_FREQUENCY, 6.0);
    scenario.filters.truncate(1);
    let filter = &mut scenario.filters[0];
    (filter.kind, filter.fading, filter.ensemble_size) = (kind, 1.0, 40);
    filter.sensor_delay = delays.to_vec();
    scenario
}

fn run(scenario: &Scenario, record: &Record) -> Run {
    let mut run = Run::on_record(scenario, Arc::new(record.clone())).expect("it can be run");
    run.finish();
    assert_eq!(run.estimates()[0].stop(), None);
    run
}

/// The same record whose readings tell their true times.
fn moved(record: &Record, delays: [f64; 2]) -> Record {
    let timed = |sensor: usize| {
        let late = delays[sensor] / record.dt();
        let times = (0..record.len()).map(|k| k as f64 - late);
        Timed { times: times.collect(), values: record.measured(sensor).to_vec() }
    };
    let clocks = Clocks { input: None, readings: vec![timed(0), timed(1)] };
    record.clone().with_clocks(clocks).expect("the times rise")
}

/// The largest difference of two filters' means, over their standard deviations.
fn distance(one: &Estimates, other: &Estimates) -> f64 {
    assert_eq!(one.len(), other.len());
    let n = one.channels().len();
    let off = |k: usize, i: usize| {
        (one.mean(k)[i] - other.mean(k)[i]).abs() / other.std(k, i).max(1e-9 * other.mean(k)[i].abs()).max(1e-12)
    };
    (0..one.len()).flat_map(|k| (0..n).map(move |i| off(k, i))).fold(0.0, f64::max)
}

#[test]
fn a_delay_is_a_reading_at_another_time() {
    for kind in [FilterKind::KF, FilterKind::EKF, FilterKind::UKF, FilterKind::SR_UKF, FilterKind::CKF] {
        for delays in DELAYS {
            let late = scenario(kind, delays);
            let record = simulate(&late);
            let mut own = late.clone();
            own.filters[0].sensor_delay.clear();
            let (known, told) = (run(&late, &record), run(&own, &moved(&record, delays)));
            let [known, told] = [&known, &told].map(|run| &run.estimates()[0]);
            assert!(distance(known, told) < 1e-9, "{kind:?} {delays:?}: {}", distance(known, told));
            let [own, other] = [known, told].map(|estimates| estimates.nis()[300]);
            assert!((own - other).abs() < 1e-9 * other, "{kind:?} {delays:?}: {own} {other}");
        }
    }
}

/// Filters of all kinds take whole steps exactly, those that count in samples too, and smoothers as well.
#[test]
fn a_delay_of_whole_steps_is_a_column_that_is_moved() {
    for kind in FilterKind::ALL {
        let mut late = scenario(kind, [0.05, -0.02]);
        late.filters[0].smoother = !kind.is_sampled();
        let record = simulate(&late);
        let column = |sensor: usize, late: isize| {
            let at = |k: usize| k.checked_add_signed(late).and_then(|k| record.measured(sensor).get(k));
            (0..record.len()).map(|k| at(k).copied().unwrap_or(f64::NAN)).collect::<Vec<f64>>()
        };
        let input = Input { kind: record.input_kind(), hold: record.hold(), values: record.input().to_vec() };
        let columns = vec![(Quantity::DISPLACEMENT, column(0, 5)), (Quantity::VELOCITY, column(1, -2))];
        let right = Record::new(record.dt(), input, columns).expect("the columns are a record");
        let mut own = late.clone();
        own.filters[0].sensor_delay.clear();
        let (known, told) = (run(&late, &record), run(&own, &right));
        assert!(distance(&known.estimates()[0], &told.estimates()[0]) < 1e-6, "{kind:?}");
        assert!(known.estimates()[0].remarks().iter().all(|remark| !matches!(remark.what, Trouble::Rounded(_))));
        if let ([known], [told]) = (&known.smoothed()[..], &told.smoothed()[..]) {
            assert!(distance(known, told) < 1e-6, "{kind:?} smoothed");
        }
        // Sample 100 has the reading that comes five samples later.
        let measured = known.estimates()[0].measured(&record, 0).expect("there is such a sensor");
        assert_eq!(measured(100).to_bits(), record.measured(0)[105].to_bits());
    }
}

#[test]
fn a_part_of_a_step_is_rounded_where_a_filter_counts_in_samples_and_this_is_said() {
    for delays in [[0.02, 0.0], [0.0235, 0.0]] {
        let late = scenario(FilterKind::ENKF, delays);
        let run = run(&late, &simulate(&late));
        let is_said = run.estimates()[0].remarks().iter().any(|remark| matches!(remark.what, Trouble::Rounded(_)));
        assert_eq!(is_said, delays[0] == 0.0235, "{delays:?}");
    }
}

/// A record that grows, one that forgets, and samples that come in one by one.
#[test]
fn a_filter_waits_for_a_late_sensor_and_has_the_same_bits() {
    for delays in DELAYS {
        let late = scenario(FilterKind::UKF, delays);
        let record = simulate(&late);
        let whole = run(&late, &record);
        let bits = |mean: &[f64]| mean.iter().map(|x| x.to_bits()).collect::<Vec<u64>>();
        let expected: Vec<Vec<u64>> = (0..record.len()).map(|k| bits(whole.estimates()[0].mean(k))).collect();

        let first = |samples: usize| Arc::new(record.part(0..samples));
        let mut growing = Run::from_source(&late, Source::Live(first(100))).expect("it can be run");
        for samples in [150, 151, 400, record.len()] {
            growing.advance_to(usize::MAX);
            assert!(growing.done() <= growing.record().len());
            assert!(growing.lengthen(first(samples)));
        }
        growing.advance_to(usize::MAX);
        let waits = delays.iter().fold(0.0, |most: f64, late| most.max(late / 0.01)).ceil() as usize;
        assert_eq!(growing.done(), record.len() - waits);
        for (k, mean) in expected.iter().enumerate().take(growing.done()) {
            assert_eq!(&bits(growing.estimates()[0].mean(k)), mean, "{delays:?}, growing, sample {k}");
        }

        let mut forgetful = Run::new(&late).expect("it can be run");
        for samples in (50..=600).step_by(50) {
            forgetful.advance_to(samples);
            forgetful.forget(40);
        }
        let last = forgetful.estimates()[0].len() - 1;
        assert_eq!(bits(forgetful.estimates()[0].mean(last)), expected[599], "{delays:?}, forgetful");

        let mut online = OnlineFilter::new(&late, 0).expect("it can be run");
        assert_eq!(online.latency(), waits);
        let mut done = 0;
        for k in 0..record.len() {
            let readings = [record.measured(0)[k], record.measured(1)[k]];
            if let Some(sample) = online.step(record.time(k), record.input()[k], &readings).expect("it fits") {
                assert_eq!(bits(sample.mean), expected[done], "{delays:?}, one by one, sample {done}");
                done += 1;
            }
        }
        assert_eq!(done, record.len() - waits);
    }
}

#[test]
fn events_of_a_late_sensor_count_at_the_time_that_they_tell_of() {
    for delays in DELAYS {
        let late = scenario(FilterKind::EKF, delays);
        let record = simulate(&late);
        let whole = run(&late, &record);
        let mut events = EventFilter::new(&late, 0).expect("it can be run");
        for k in 0..record.len() {
            let readings = [record.measured(0)[k], record.measured(1)[k]];
            events.take(record.time(k), record.input()[k], &readings).expect("it is in time");
        }
        let (sample, estimates) = (events.sample(), &whole.estimates()[0]);
        let last = estimates.len() - 1;
        for place in 0..4 {
            let off = (sample.mean[place] - estimates.mean(last)[place]).abs() / estimates.std(last, place);
            assert!(off < 1e-6, "{delays:?}, component {place}: {off}");
        }
    }
}

/// The truth's fault and the filter's knowledge of it: it is as good as with a sensor that is in time, and without it is lost.
#[test]
fn a_filter_that_knows_of_a_late_sensor_is_consistent() {
    let mut nis = [0.0; 2];
    for seed in 0..20 {
        for (place, delay) in [0.05, 0.0].into_iter().enumerate() {
            let mut late = scenario(FilterKind::EKF, [0.0, delay]);
            (late.seed, late.duration) = (seed, 20.0);
            let text = late.to_toml().expect("it can be written");
            let sensor = "measures = \"velocity\"\n";
            assert!(text.contains(sensor), "{text}");
            let text = text.replace(sensor, "measures = \"velocity\"\nfaults = { late = { delay = 0.05 } }\n");
            let late = Scenario::from_toml(&text).expect("it is a scenario");
            let run = run(&late, &simulate(&late).without_truth());
            let values = &run.estimates()[0].nis()[200..1900];
            nis[place] += values.iter().sum::<f64>() / values.len() as f64 / 20.0;
        }
    }
    assert!((nis[0] - 2.0).abs() < 0.05 && nis[1] > 4.0, "{nis:?}");
}

#[test]
fn delays_follow_the_sensors_and_impossible_ones_are_refused() {
    let mut scenario = scenario(FilterKind::EKF, [0.01, 0.02]);
    scenario.remove_sensor(Quantity::DISPLACEMENT);
    assert_eq!(scenario.filters[0].sensor_delay, [0.02]);
    scenario.add_sensor(kalmanscope_core::Sensor::new(Quantity::DISPLACEMENT, 0.01));
    assert_eq!(scenario.filters[0].sensor_delay, [0.0, 0.02]);
    let again = Scenario::from_toml(&scenario.to_toml().expect("it can be written")).expect("it is a scenario");
    assert_eq!(again.filters[0].sensor_delay, [0.0, 0.02]);
    for (list, what) in
        [("[0.1]", "a list of 2"), ("[0.0, 11.0]", "sensor_delay[1]"), ("[0.0, nan]", "sensor_delay[1]")]
    {
        let text = format!("[[filters]]\nkind = \"ekf\"\nsensor_delay = {list}\n");
        let error = Scenario::from_toml(&text).expect_err("it is refused").to_string();
        assert!(error.contains(what), "{error}");
    }
    // A record that is sampled more finely than its scenario says is no trouble.
    let error =
        Scenario::from_toml("dt = 1e-6\nduration = 1e-4\n[[filters]]\nkind = \"ekf\"\nsensor_delay = [0.0, 0.2]\n");
    assert!(error.expect_err("it is refused").to_string().contains("within 100000 steps"));
    let live = LiveRecord::new(0.01, again.input, again.hold, vec![Quantity::DISPLACEMENT, Quantity::VELOCITY]);
    assert!(Run::from_source(&again, Source::Live(live.so_far())).is_ok(), "an empty record");
}
