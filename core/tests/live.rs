//! A record that becomes longer while filters follow it.

use std::sync::Arc;

use kalmanscope_core::free_decay::Decay;
use kalmanscope_core::record::{LiveError, LiveRecord, Record};
use kalmanscope_core::suggest::{scenario_for, suggest};
use kalmanscope_core::{
    Channel, FilterKind, FilterSettings, Hold, InputKind, Quantity, Run, Scenario, Source, Trouble,
};

use crate::numbers::Random;
use crate::phone::{Phone, USUAL};
use crate::run::{assert_same_estimates, finished_on, last, measured, readings};

fn scenario(hold: Hold) -> Scenario {
    let mut scenario = Scenario { duration: 5.0, hold, ..Scenario::default() };
    let first = scenario.filters[0].clone();
    use FilterKind as Kind;
    for (kind, input_delay) in [(Kind::SR_UKF, 0), (Kind::ENKF, 0), (Kind::EKF, -3), (Kind::UKF, 2)] {
        scenario.filters.push(FilterSettings { kind, input_delay, ensemble_size: 30, id: 0, ..first.clone() });
    }
    scenario.number_filters();
    scenario
}

fn live_run(scenario: &Scenario, record: impl Into<Arc<Record>>) -> Run {
    let mut run = Run::from_source(scenario, Source::Live(record.into())).expect("it can be run");
    run.advance_to(usize::MAX);
    run
}

/// Lets a run follow a record as far as it has come; the first time, begins it.
pub(crate) fn follow<'a>(run: &'a mut Option<Run>, scenario: &Scenario, so_far: Arc<Record>) -> &'a mut Run {
    let run = run.get_or_insert_with(|| live_run(scenario, Arc::clone(&so_far)));
    let is_longer = so_far.len() > run.record().len();
    assert!(run.lengthen(so_far) || !is_longer);
    run.advance_to(usize::MAX);
    run
}

fn assert_same(run: &Run, whole: &Run) {
    assert_eq!(run.done(), whole.done());
    for (a, b) in run.estimates().iter().zip(whole.estimates()) {
        assert_same_estimates(a, b, a.name());
    }
}

#[test]
fn a_run_over_a_growing_record_has_the_bits_of_one_over_the_whole() {
    for hold in [Hold::Zero, Hold::First] {
        let scenario = scenario(hold);
        let record = measured(&scenario);
        let mut run = live_run(&scenario, record.part(0..0));
        let mut random = Random::new(3);
        let mut length = 0;
        while length < record.len() {
            run.advance_to(usize::MAX);
            assert_eq!(run.done(), length.saturating_sub(3), "the delayed filter waits for three inputs");
            length = (length + 1 + (40.0 * random.uniform()) as usize).min(record.len());
            assert!(run.lengthen(Arc::new(record.part(0..length))));
        }
        run.advance_to(usize::MAX);
        let mut whole = Run::on_record(&scenario, Arc::new(record.clone())).expect("it can be run");
        whole.advance_to(record.len() - 3);
        assert_same(&run, &whole);
    }
}

#[test]
fn what_is_no_longer_record_changes_nothing() {
    let scenario = scenario(Hold::Zero);
    let record = measured(&scenario);
    let mut run = live_run(&scenario, record.part(0..200));
    let before = run.checksum();
    let other = record.clone().with_measured(|_, k, x| if k == 100 { x + 1e-12 } else { x });
    for wrong in [record.part(0..199), record.part(1..300), other, record.clone().starting_at(1.0)] {
        assert!(!run.lengthen(Arc::new(wrong)));
        run.advance_to(usize::MAX);
        assert_eq!((run.done(), run.checksum()), (197, before));
    }
    let mut ended = Run::on_record(&scenario, Arc::new(record.part(0..200))).expect("it can be run");
    assert!(!ended.lengthen(Arc::new(record)), "a measured record has ended");
}

#[test]
fn an_input_and_the_readings_that_come_with_it_keep_their_time() {
    for (hold, share) in [Hold::Zero, Hold::First].into_iter().flat_map(|hold| [(hold, 0.0), (hold, 0.4)]) {
        let record = measured(&Scenario { dt: 1.0 / 60.0, duration: 20.0, hold, ..scenario(hold) });
        let record = record.with_gaps(|sensor, k| share == 0.0 && k % (7 + sensor) == 3 && k > 0);
        let jitter = |k: usize| if k > 0 { share * record.dt() * libm::sin((k * k) as f64) } else { 0.0 };
        let time_of = |k: usize| 3.0 + record.time(k) + jitter(k);
        let mut live = LiveRecord::new(record.dt(), record.input_kind(), hold, record.sensors().to_vec());
        for k in 0..record.len() {
            live.take(time_of(k), record.input()[k], &readings(&record, k)).expect("it is taken in");
        }
        let made = live.record();
        assert!(made.len() >= record.len() - 2);
        if share == 0.0 {
            for sensor in 0..record.sensors().len() {
                let mut pairs = made.measured(sensor).iter().zip(record.measured(sensor));
                assert!(pairs.all(|(a, b)| a.to_bits() == b.to_bits()));
            }
            assert!(made.input().iter().zip(record.input()).all(|(a, b)| (a - b).abs() < 1e-9 * (1.0 + b.abs())));
            continue;
        }
        let clocks = made.clocks().expect("it has clocks");
        let input = clocks.input.as_ref().expect("it was told");
        for (place, reading) in clocks.readings[0].values.iter().enumerate() {
            assert_eq!(*reading, record.measured(0)[place]);
            let time = clocks.readings[0].times[place];
            assert!((3.0 + time * record.dt() - time_of(place)).abs() < 1e-9, "{place}");
            let same = input.times.iter().position(|other| *other == time).expect("they came together");
            assert_eq!(input.values[same], record.input()[place]);
        }
        assert!(made.clone().with_clocks(clocks.clone()).is_ok(), "the times rise");
        // A line has a value at each sample too, and is no other line.
        let between = input.times.len() - clocks.readings[0].times.len();
        assert_eq!(between == 0, hold == Hold::Zero, "{between}");
    }
}

#[test]
fn an_input_that_is_told_late_was_zero() {
    for hold in [Hold::Zero, Hold::First] {
        let mut live = LiveRecord::new(0.1, InputKind::Force, hold, vec![Quantity::DISPLACEMENT]);
        let mut scenario = Scenario { hold, dt: 0.1, ..Scenario::default() };
        scenario.set_sensors(&[Quantity::DISPLACEMENT]);
        let mut run: Option<Run> = None;
        for k in 0..40 {
            let time = 0.1 * f64::from(k) + 0.02 * libm::sin(f64::from(k));
            live.take(time, if k < 20 { f64::NAN } else { 1.0 }, &[0.01 * libm::cos(6.0 * time)]).expect("it comes");
            if live.record().len() > 2 {
                follow(&mut run, &scenario, live.so_far());
            }
        }
        let record = live.so_far();
        let input = record.clocks().and_then(|clocks| clocks.input.as_ref()).expect("it was told");
        let rise = input.values.iter().position(|value| *value == 1.0).expect("it was told");
        assert!((19.5..20.5).contains(&input.times[rise]) && input.times[0] == 0.0, "{:?}", &input.times[..=rise]);
        assert!(input.values[..rise].iter().all(|value| *value == 0.0));
        let whole = finished_on(&scenario, Arc::clone(&record));
        assert_same(&run.expect("it has begun"), &whole);
    }
}

#[test]
fn what_is_late_finds_its_sample_as_long_as_that_waits() {
    let sensors = vec![Quantity::DISPLACEMENT, Quantity::VELOCITY];
    let mut live = LiveRecord::new(0.1, InputKind::Force, Hold::First, sensors).waiting(0.25);
    let none = f64::NAN;
    live.take(0.0, 0.0, &[0.0, 0.0]).expect("the first");
    for k in 1..=20 {
        let t = 0.1 * f64::from(k);
        live.take(t, none, &[t, none]).expect("on time");
        // The slow sensor and the input, which is a line, come 0.2 s late.
        if k % 5 == 2 && k > 2 {
            live.take(t - 0.2, 10.0 * (t - 0.2), &[none, 2.0 * (t - 0.2)]).expect("it waits");
        }
    }
    let record = live.record();
    for k in 0..record.len() {
        let t = 0.1 * k as f64;
        assert!((record.measured(0)[k] - t).abs() < 1e-12);
        assert_eq!(record.measured(1)[k].is_nan(), k % 5 != 0);
        assert!((record.input()[k] - 10.0 * t).abs() < 1e-9 || k > 15, "{k}: {}", record.input()[k]);
    }
    assert!(matches!(live.take(0.7, none, &[1.0, none]), Err(LiveError::TooLate { .. })));
    assert!(matches!(live.take(1e9, none, &[1.0, none]), Err(LiveError::Gap { .. })));
    assert_eq!(live.take(2.1, none, &[1.0]), Err(LiveError::Readings(1, 2)));
    assert_eq!(live.take(2.1, none, &[f64::INFINITY, 0.0]), Err(LiveError::Infinite));
    live.take(2.4, none, &[2.4, none]).expect("what was refused has changed nothing");
}

#[test]
fn a_prompt_record_waits_for_none_that_has_gone_on_and_for_all_once_one_is_late() {
    let none = f64::NAN;
    let sensors = vec![Quantity::DISPLACEMENT, Quantity::VELOCITY];
    let mut live = LiveRecord::new(0.01, InputKind::Force, Hold::Zero, sensors).waiting(0.1).prompt();
    // The velocity arrives 20 ms after the displacement and the input of the same time.
    for k in 0..50 {
        let time = f64::from(k) * 0.01;
        live.take(time, time, &[1.0, none]).expect("it is taken in");
        if k >= 2 {
            live.take(time - 0.02, none, &[none, 2.0]).expect("it is taken in");
        }
    }
    assert_eq!(live.record().len(), 48, "as far as the sensor that is told last");
    assert!((0..47).all(|k| live.record().measured(0)[k] == 1.0 && live.record().measured(1)[k] == 2.0));
    // A sensor that is silent is waited for.
    for k in 50..80 {
        let time = f64::from(k) * 0.01;
        live.take(time, time, &[1.0, none]).expect("it is taken in");
    }
    assert_eq!(live.record().len(), 70, "0.1 s");
    // The first reading out of order comes too late; from then on all are waited for.
    live.take(0.79, none, &[none, 3.0]).expect("it is taken in");
    assert_eq!(live.record().len(), 79);
    assert!(matches!(live.take(0.78, none, &[none, 4.0]), Err(LiveError::TooLate { .. })));
    for k in 80..100 {
        let time = f64::from(k) * 0.01;
        live.take(time, time, &[1.0, none]).expect("it is taken in");
        if k >= 82 {
            live.take(time - 0.02, none, &[none, 5.0]).expect("it is taken in");
            live.take(time - 0.03, none, &[none, 6.0]).expect("it is waited for");
        }
    }
    assert_eq!(live.record().len(), 90, "0.1 s");
}

#[test]
fn a_clock_that_stands_still_takes_no_memory_without_end_and_the_end_is_completed() {
    let mut live = LiveRecord::new(0.01, InputKind::Force, Hold::Zero, vec![Quantity::VELOCITY]).waiting(0.1);
    for _ in 0..150_000 {
        live.take(1.0, f64::NAN, &[2.0]).expect("one is kept");
    }
    assert_eq!(live.repeated(), 149_999);
    let creeping = |k: u32| live.take(1.0 + 1e-7 * f64::from(k), f64::NAN, &[2.0]) == Err(LiveError::Burst);
    let refused = (1..=150_000).map(creeping).filter(|is_refused| *is_refused).count();
    assert_eq!(refused, 150_001 - LiveRecord::MOST_WAITING, "the first one waits too");
    live.take(3.0, f64::NAN, &[3.0]).expect("the clock goes on");
    let before = live.record().len();
    let mut earlier = live.so_far();
    live.finish();
    assert_eq!((before, live.record().len()), (191, 201));
    assert!(live.update(&mut earlier) && !live.update(&mut earlier));
    assert_eq!((earlier.measured(0)[0], earlier.measured(0)[200]), (2.0, 3.0));
}

#[test]
fn a_record_is_full_in_words_and_no_message_makes_it_panic() {
    let mut random = Random::new(11);
    let mut live = LiveRecord::new(1e-3, InputKind::Force, Hold::First, vec![Quantity::VELOCITY]).smoothing(3);
    let (mut taken, mut time) = (0, 0.0);
    for _ in 0..300_000 {
        time += 2e-3 * random.uniform();
        let odd = random.uniform();
        let at = match () {
            () if odd < 0.01 => f64::NAN,
            () if odd < 0.02 => -f64::INFINITY,
            () if odd < 0.03 => 1e300,
            () if odd < 0.1 => time - 0.01 * random.uniform(),
            () => time,
        };
        let value = if random.uniform() < 0.02 { f64::INFINITY } else { random.normal() };
        let input = if random.uniform() < 0.5 { f64::NAN } else { random.normal() };
        taken += usize::from(live.take(at, input, &[value]).is_ok());
    }
    assert_eq!(live.record().len(), LiveRecord::MOST);
    assert_eq!(live.take(time, 0.0, &[0.0]), Err(LiveError::Full));
    assert!(taken > 150_000, "{taken}");
    let clocks = live.record().clocks().expect("it has clocks").clone();
    assert!(live.record().clone().with_clocks(clocks).is_ok(), "the times rise");
    assert!(live.record().input().iter().all(|x| x.is_finite()));
}

#[test]
fn a_slow_sensor_that_is_measured_now_is_not_silent() {
    let sensors = [Quantity::DISPLACEMENT, Quantity::VELOCITY];
    let mut scenario = Scenario { dt: 0.01, ..Scenario::default() };
    scenario.set_sensors(&sensors);
    let mut live = LiveRecord::new(0.01, InputKind::Force, Hold::Zero, sensors.to_vec());
    let mut run: Option<Run> = None;
    let missing = |run: &Run| -> Vec<usize> {
        let remarks = run.estimates()[0].remarks().iter();
        let of_velocity = remarks.filter(|remark| remark.what == Trouble::Missing(Quantity::VELOCITY));
        of_velocity.map(|remark| remark.sample).collect()
    };
    for k in 0..1200 {
        let time = 0.01 * f64::from(k) + 0.003 * libm::sin(f64::from(k));
        // 4 Hz, and nothing from 8 s on.
        let velocity = if k % 25 == 10 && k < 800 { 0.0 } else { f64::NAN };
        live.take(time, f64::NAN, &[0.0, velocity]).expect("it comes");
        let run = follow(&mut run, &scenario, live.so_far());
        if k == 799 {
            assert!(missing(run).iter().all(|first| *first < 11), "{:?}", missing(run));
        }
    }
    let silent = missing(&run.expect("it has begun"));
    assert!(silent.iter().any(|first| (780..800).contains(first)), "{silent:?}");
}

#[test]
fn a_record_of_many_readings_a_step_is_full_in_words() {
    let mut live = LiveRecord::new(1.0, InputKind::Force, Hold::Zero, vec![Quantity::VELOCITY]);
    let taken = (0..2_000_000).filter(|k| live.take(2e-5 * f64::from(*k), f64::NAN, &[1.0]).is_ok()).count();
    let kept = live.record().clocks().expect("it has clocks").readings[0].times.len();
    assert!((LiveRecord::MOST_READINGS..LiveRecord::MOST_READINGS + 100_001).contains(&kept), "{kept}");
    assert!((kept..=kept + 100_000).contains(&taken), "{taken}");
    assert_eq!(live.take(100.0, f64::NAN, &[1.0]), Err(LiveError::Full));
    assert!(LiveError::Full.to_string().contains("1000000 readings"), "{}", LiveError::Full);
}

/// Seeds and situations are others than those with which the smoothing was chosen.
#[test]
fn a_swing_with_a_jittering_clock_is_identified_while_it_is_measured() {
    let (mut inside, mut count) = ([0, 0], 0);
    for seed in 101..=110 {
        for (frequency, damping, rate, jitter) in
            [(5.2, 0.006, 100.0, 0.6), (8.3, 0.015, 60.0, 0.7), (12.5, 0.01, 60.0, 0.4)]
        {
            let phone = Phone { seed, frequency, damping, rate, jitter, seconds: 30.0, ..USUAL };
            let readings = phone.readings();
            let decay = Decay::of(&readings).expect("it swings");
            let mut live = decay.live();
            for reading in readings.iter().filter(|reading| reading[0] >= decay.begin) {
                live.take(reading[0], f64::NAN, &[decay.along(*reading)]).expect("it is taken in");
            }
            let record = live.record();
            let clocks = record.clocks().expect("it has clocks");
            let end = live.begin().expect("it has begun") + record.time(record.len() - 1);
            let taken = readings.iter().filter(|reading| (decay.begin..=end).contains(&reading[0])).count();
            assert_eq!(clocks.readings[0].times.len(), taken, "each reading is there");
            let first = record.part(0..(3.0 * rate) as usize);
            let scenario = suggest(&scenario_for(&first), &first).scenario;
            let run = live_run(&scenario, live.so_far());
            let estimates = &run.estimates()[0];
            let settled = (estimates.len() - 1) / 2..=estimates.len() - 1;
            let nis: f64 = settled.clone().map(|k| estimates.nis()[k]).filter(|nis| !nis.is_nan()).sum();
            let readings: u32 = settled.map(|k| estimates.readings(k)).sum();
            let mean = nis / f64::from(readings);
            assert!((0.7..1.4).contains(&mean), "seed {seed}, {frequency} rad/s: a mean NIS of {mean}");
            let channels = [(Channel::NATURAL_FREQUENCY, frequency), (Channel::DAMPING_RATIO, damping)];
            for (k, (channel, truth)) in channels.into_iter().enumerate() {
                let (mean, std) = last(estimates, channel);
                let name = format!("seed {seed}, {frequency} rad/s: {mean} for {truth}");
                assert!((mean / truth - 1.0).abs() < [0.002, 0.15][k], "{name}");
                inside[k] += i32::from((mean - truth).abs() < 2.0 * std);
            }
            count += 1;
        }
    }
    assert!(inside.iter().all(|inside| 10 * inside >= 9 * count), "inside ±2σ: {inside:?} of {count}");
}
