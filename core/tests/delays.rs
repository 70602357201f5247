//! Inputs and sensors that are recorded late or early: filters that know, filters that do not, and the cause that is named.

use std::sync::Arc;

use kalmanscope_core::record::LiveRecord;
use kalmanscope_core::scenario::Fault;
use kalmanscope_core::{
    FilterKind, LastSample, OnlineFilter, Quantity, Run, Scenario, Sensor, Source, Trouble, simulate,
};

use crate::numbers::{bits, distance, farthest, mean};
use crate::run::{
    after_events, measured, one_filter, oscillator, readings, run_on, with_fault, with_input, with_times,
};

#[test]
fn a_filter_that_knows_the_delay_is_one_on_an_input_that_is_moved() {
    for delay in -3_i32..=3 {
        // The plant feels the input this many samples late.
        let mut scenario = Scenario { duration: 20.0, plant: oscillator(6.0, 0.05), ..one_filter(FilterKind::EKF) };
        (scenario.plant.input_delay, scenario.filters[0].fading) = (delay, 1.0);
        let is_lost = |place: usize, k: usize| (k + place).is_multiple_of(3) || (300..360).contains(&k);
        let late = simulate(&scenario).without_truth().with_gaps(is_lost);
        scenario.filters[0].input_delay = delay;
        let known = run_on(&scenario, late.clone());
        scenario.filters[0].input_delay = 0;
        // Before the first sample and after the last one, the input is what it is there.
        let last = late.len() as i32 - 1;
        let moved = (0..=last).map(|k| late.input()[(k - delay).clamp(0, last) as usize]);
        let moved = with_input(&late, moved.collect());
        let expected = run_on(&scenario, moved);
        let means = |run: &Run| (0..late.len()).map(|k| run.estimates()[0].mean(k).to_vec()).collect::<Vec<_>>();
        assert!(means(&known) == means(&expected), "delay {delay}");
    }
}

/// The delays of displacement and velocity \[s\]: whole steps of 0.01 s, parts of steps, late and early.
const SENSOR_DELAYS: [[f64; 2]; 5] = [[0.05, 0.0], [0.0, 0.02], [0.0235, 0.0], [-0.03, 0.0077], [0.041, 0.0415]];

fn late(kind: FilterKind, delays: [f64; 2]) -> Scenario {
    let mut scenario = Scenario { duration: 6.0, plant: oscillator(6.0, 0.05), ..one_filter(kind) };
    let filter = &mut scenario.filters[0];
    (filter.fading, filter.ensemble_size) = (1.0, 40);
    filter.sensor_delay = delays.to_vec();
    scenario
}

#[test]
fn a_delay_is_a_reading_at_another_time() {
    for kind in [FilterKind::KF, FilterKind::EKF, FilterKind::UKF, FilterKind::SR_UKF, FilterKind::CKF] {
        for delays in SENSOR_DELAYS {
            let late = late(kind, delays);
            let record = simulate(&late);
            let mut own = late.clone();
            own.filters[0].sensor_delay.clear();
            let timed = with_times(&record, |sensor, k| k - delays[sensor] / record.dt());
            let runs = [run_on(&late, record), run_on(&own, timed)];
            let [known, told] = runs.each_ref().map(|run| &run.estimates()[0]);
            assert!(farthest(known, told, 1) < 1e-9, "{kind:?} {delays:?}: {}", farthest(known, told, 1));
            let [own, other] = [known, told].map(|estimates| estimates.nis()[300]);
            assert!((own - other).abs() < 1e-9 * other, "{kind:?} {delays:?}: {own} {other}");
        }
    }
}

#[test]
fn a_delay_of_whole_steps_is_a_column_that_is_moved() {
    for kind in FilterKind::ALL {
        let mut late = late(kind, [0.05, -0.02]);
        late.filters[0].smoother = !kind.is_sampled();
        let record = simulate(&late);
        let right = record.clone().with_measured(|sensor, k, _| {
            let at = k.checked_add_signed([5, -2][sensor]).and_then(|k| record.measured(sensor).get(k));
            at.copied().unwrap_or(f64::NAN)
        });
        let mut own = late.clone();
        own.filters[0].sensor_delay.clear();
        let (known, told) = (run_on(&late, record.clone()), run_on(&own, right));
        assert!(farthest(&known.estimates()[0], &told.estimates()[0], 1) < 1e-6, "{kind:?}");
        assert!(known.estimates()[0].remarks().iter().all(|remark| !matches!(remark.what, Trouble::Rounded(_))));
        if let ([known], [told]) = (&known.smoothed()[..], &told.smoothed()[..]) {
            assert!(farthest(known, told, 1) < 1e-6, "{kind:?} smoothed");
        }
        // Sample 100 has the reading that comes five samples later.
        let measured = known.estimates()[0].measured(&record, 0).expect("there is such a sensor");
        assert_eq!(measured(100).to_bits(), record.measured(0)[105].to_bits());
    }
}

#[test]
fn a_part_of_a_step_is_rounded_where_a_filter_counts_in_samples_and_this_is_said() {
    for delays in [[0.02, 0.0], [0.0235, 0.0]] {
        let late = late(FilterKind::ENKF, delays);
        let run = run_on(&late, simulate(&late));
        let is_said = run.estimates()[0].remarks().iter().any(|remark| matches!(remark.what, Trouble::Rounded(_)));
        assert_eq!(is_said, delays[0] == 0.0235, "{delays:?}");
    }
}

#[test]
fn a_filter_waits_for_a_late_sensor_and_has_the_same_bits() {
    for delays in SENSOR_DELAYS {
        let late = late(FilterKind::UKF, delays);
        let record = simulate(&late);
        let whole = run_on(&late, record.clone());
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
        let mut last = LastSample::default();
        for k in 0..record.len() {
            online.step(record.input()[k], &readings(&record, k), &mut last);
            let done = online.pass.done();
            assert_eq!(done, (k + 1).saturating_sub(waits));
            if let Some(sample) = done.checked_sub(1) {
                assert_eq!(bits(last.sample().mean), expected[sample], "{delays:?}, one by one, sample {sample}");
            }
        }
    }
}

#[test]
fn events_of_a_late_sensor_count_at_the_time_that_they_tell_of() {
    for delays in SENSOR_DELAYS {
        let late = late(FilterKind::EKF, delays);
        let record = simulate(&late);
        let (whole, events) = (run_on(&late, record.clone()), after_events(&late, &record));
        let (sample, estimates) = (events.sample(), &whole.estimates()[0]);
        let far = distance([sample.mean, sample.cov], estimates, estimates.len() - 1);
        assert!(far < 1e-6, "{delays:?}: {far}");
    }
}

#[test]
fn a_filter_that_knows_of_a_late_sensor_is_consistent() {
    let mut nis = [0.0; 2];
    for seed in 0..20 {
        for (place, delay) in [0.05, 0.0].into_iter().enumerate() {
            let mut late = late(FilterKind::EKF, [0.0, delay]);
            (late.seed, late.duration) = (seed, 20.0);
            with_fault(&mut late.sensors[1], Fault::LATE, &[0.05]);
            let run = run_on(&late, measured(&late));
            nis[place] += mean(&run.estimates()[0].nis()[200..1900]) / 20.0;
        }
    }
    assert!((nis[0] - 2.0).abs() < 0.05 && nis[1] > 4.0, "{nis:?}");
}

#[test]
fn delays_follow_the_sensors() {
    let mut scenario = late(FilterKind::EKF, [0.01, 0.02]);
    scenario.remove_sensor(Quantity::DISPLACEMENT);
    assert_eq!(scenario.filters[0].sensor_delay, [0.02]);
    scenario.add_sensor(Sensor::new(Quantity::DISPLACEMENT, 0.01));
    assert_eq!(scenario.filters[0].sensor_delay, [0.0, 0.02]);
    let again = Scenario::from_toml(&scenario.to_toml().expect("it can be written")).expect("it is a scenario");
    assert_eq!(again.filters[0].sensor_delay, [0.0, 0.02]);
    let live = LiveRecord::new(0.01, again.input, again.hold, vec![Quantity::DISPLACEMENT, Quantity::VELOCITY]);
    assert!(Run::from_source(&again, Source::Live(live.so_far())).is_ok(), "an empty record");
}
