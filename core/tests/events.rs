//! Filters of sensors with clocks of their own.

use kalmanscope_core::{
    Channel, EventError, EventFilter, EventSetupError, FilterKind, Force, Hold, PlantKind, Quantity, Record, Robust,
    Run, Sample, Scenario, Sensor, Values, simulate, smoothed,
};

use crate::numbers::{DETERMINISTIC, Random, distance};
use crate::run::{after_events, finished, finished_on, forced, one_filter, readings};

const NONE: f64 = f64::NAN;

fn scenario(kind: FilterKind, hold: Hold) -> Scenario {
    Scenario { duration: 10.0, hold, ..one_filter(kind) }
}

fn far(sample: &Sample<'_>, run: &Run) -> f64 {
    let estimates = &run.estimates()[0];
    distance([sample.mean, sample.cov], estimates, estimates.len() - 1)
}

#[test]
fn one_common_clock_gives_the_estimates_of_a_run() {
    for hold in [Hold::Zero, Hold::First] {
        for kind in DETERMINISTIC {
            for (plant, fading, substeps, delay) in [
                (PlantKind::SDOF, 1.003, 1, 0),
                (PlantKind::DUFFING, 1.0, 3, 0),
                (PlantKind::BOUC_WEN, 1.001, 2, 0),
                (PlantKind::SDOF, 1.0, 1, 4),
            ] {
                let mut scenario = scenario(kind, hold);
                scenario.set_plant(plant.clone());
                let filter = &mut scenario.filters[0];
                (filter.fading, filter.substeps, filter.input_delay) = (fading, substeps, delay);
                filter.process_std[Channel::NATURAL_FREQUENCY] = 1e-3;
                let run = finished(&scenario);
                let found = far(&after_events(&scenario, run.record()).sample(), &run);
                assert!(found < 1e-8, "{kind:?} {plant:?} {hold:?}: {found}");
            }
        }
    }
}

#[derive(Clone, Debug)]
pub(crate) struct Told {
    pub(crate) time: f64,
    pub(crate) came: f64,
    pub(crate) input: f64,
    pub(crate) readings: [f64; 2],
}

/// 100 Hz with a jitter of half a step, 7 Hz, and an input at 20 Hz. Times are multiples of dt / 100. A fifth is up to 0.5 s late.
pub(crate) fn own_clocks(scenario: &Scenario, seed: u64) -> Vec<Told> {
    let fine = simulate(&Scenario { dt: 1e-4, filters: Vec::new(), ..scenario.clone() });
    let mut random = Random::new(seed);
    let tick = scenario.dt / 100.0;
    let mut told = vec![Told { time: 0.0, came: 0.0, input: fine.input()[0], readings: [NONE; 2] }];
    let mut add = |nominal: f64, jitter: f64, sensor: Option<usize>| {
        let k = ((nominal + jitter) / tick).round().max(1.0) as usize;
        if k >= fine.len() {
            return;
        }
        let late = if random.uniform() < 0.2 && sensor.is_some() { 0.5 * random.uniform() } else { 0.0 };
        let (mut input, mut readings) = (NONE, [NONE; 2]);
        match sensor {
            Some(sensor) => readings[sensor] = fine.measured(sensor)[k],
            None => input = fine.input()[k],
        }
        told.push(Told { time: k as f64 * tick, came: k as f64 * tick + late, input, readings });
    };
    let mut jitter = Random::new(seed + 1);
    for k in 1..(scenario.duration * 100.0) as usize {
        add(k as f64 * 0.01, 0.005 * (2.0 * jitter.uniform() - 1.0), Some(0));
    }
    (1..(scenario.duration * 7.0) as usize).for_each(|k| add(k as f64 / 7.0, 0.0, Some(1)));
    (1..(scenario.duration * 20.0) as usize).for_each(|k| add(k as f64 / 20.0, 0.0, None));
    told.sort_by(|a, b| a.came.total_cmp(&b.came));
    told
}

pub(crate) fn on_fine_grid(scenario: &Scenario, told: &[Told], len: usize) -> (Scenario, Record) {
    let tick = scenario.dt / 100.0;
    let mut fine = Scenario { dt: tick, duration: (len - 1) as f64 * tick, ..scenario.clone() };
    fine.filters[0].fading = scenario.filters[0].fading.powf(0.01);
    let (mut input, mut measured) = (vec![NONE; len], vec![vec![NONE; len]; 2]);
    for one in told {
        let k = (one.time / tick).round() as usize;
        if !one.input.is_nan() {
            input[k] = one.input;
        }
        (0..2).filter(|&i| !one.readings[i].is_nan()).for_each(|i| measured[i][k] = one.readings[i]);
    }
    let mut held = 0.0;
    input.iter_mut().for_each(|value| {
        held = if value.is_nan() { held } else { *value };
        *value = held;
    });
    let columns = [Quantity::DISPLACEMENT, Quantity::VELOCITY].into_iter().zip(measured).collect();
    (fine, forced(tick, Hold::Zero, input, columns))
}

#[test]
fn clocks_of_their_own_and_late_readings_equal_a_grid_a_hundred_times_finer() {
    for seed in 1..=3 {
        let mut scenario = scenario(FilterKind::KF, Hold::Zero);
        scenario.filters[0].fading = 1.002;
        scenario.filters[0].process_std = Values::ZERO;
        scenario.duration = 8.0;
        let told = own_clocks(&Scenario { seed, ..scenario.clone() }, seed);
        let len = told.iter().map(|one| (one.time / 1e-4).round() as usize).max().unwrap_or(0) + 1;
        let (grid, record) = on_fine_grid(&scenario, &told, len);
        let expected = finished_on(&grid, record);
        let mut events = EventFilter::new(&scenario, 0).expect("it follows events");
        let mut again = 0;
        let mut found = f64::NAN;
        for one in &told {
            found = far(&events.take(one.time, one.input, &one.readings).expect("it is taken in"), &expected);
            again += events.again;
        }
        assert!(again > 500, "few came late: {again}");
        assert!(found < 1e-9, "seed {seed}: {found}");
    }
}

#[test]
fn hindsight_is_the_smoother_with_a_look_ahead() {
    for kind in [FilterKind::EKF, FilterKind::UKF] {
        for (hold, substeps, robust) in
            [(Hold::Zero, 1, Robust::NONE), (Hold::First, 3, Robust::NONE), (Hold::Zero, 1, Robust::STUDENT_T)]
        {
            let mut scenario = scenario(kind, hold);
            let filter = &mut scenario.filters[0];
            (filter.smoother, filter.look_ahead, filter.substeps, filter.robust) = (true, 0.25, substeps, robust);
            filter.process_std[Channel::NATURAL_FREQUENCY] = 1e-3;
            let run = finished(&scenario);
            let record = run.record();
            let record = record.clone().with_gaps(|sensor, k| k > 0 && (k % 7 == sensor || (300..340).contains(&k)));
            let expected = smoothed(&scenario, 0, &record).expect("it has a smoother");
            let mut events = EventFilter::new(&scenario, 0).expect("it follows events");
            assert!(events.looks_back());
            let mut compared = 0;
            for k in 0..record.len() {
                events.take(record.time(k), record.input()[k], &readings(&record, k)).expect("it is taken in");
                let Some((time, sample)) = events.hindsight() else { continue };
                let then = k - 25;
                assert!((time - record.time(then)).abs() < 1e-9, "{time} at {k}");
                let far = distance([sample.mean, sample.cov], &expected, then);
                assert!(far < 1e-6, "{kind:?} {hold:?} at {k}: {far}");
                compared += 1;
            }
            assert_eq!(compared, record.len() - 25);
        }
    }
}

#[test]
fn late_readings_end_where_the_same_readings_in_order_do_and_so_does_hindsight() {
    let plain = [FilterKind::EKF, FilterKind::UKF, FilterKind::SR_UKF].map(|kind| (kind, Robust::NONE));
    for (kind, robust) in plain.into_iter().chain([(FilterKind::EKF, Robust::STUDENT_T)]) {
        for hold in [Hold::Zero, Hold::First] {
            let mut scenario = scenario(kind, hold);
            scenario.force = Force::Chirp { amplitude: 5.0, from: 3.0, to: 9.0, sweep: 10.0 };
            let filter = &mut scenario.filters[0];
            (filter.robust, filter.smoother, filter.look_ahead) = (robust, true, 0.4);
            let told = own_clocks(&scenario, 5);
            let mut ordered = told.clone();
            ordered.sort_by(|a, b| a.time.total_cmp(&b.time));
            let end = |told: &[Told]| {
                let (mut events, mut waited) = (EventFilter::new(&scenario, 0).expect("it follows events"), 0);
                for one in told {
                    events.take(one.time, one.input, &one.readings).expect("it is taken in");
                    waited += usize::from(events.hindsight().is_none());
                }
                assert!((30..70).contains(&waited), "it waits for the look-ahead: {waited}");
                let (newest, last) = (events.time().expect("it has begun"), events.sample().mean.to_vec());
                let known = events.sample().cov[10];
                let (time, sample) = events.hindsight().expect("it is known");
                assert!((0.4..0.42).contains(&(newest - time)), "{time} of {newest}");
                assert!(sample.cov[10] <= known * (1.0 + 1e-9), "a constant is known then as well as now");
                (last, time, sample.mean.to_vec(), sample.cov.to_vec())
            };
            let [late, ordered] = [end(&told), end(&ordered)];
            for (i, (a, b)) in late.0.iter().zip(&ordered.0).enumerate() {
                assert!(((a - b) / b.abs().max(1e-3)).abs() < 1e-9, "{kind:?} {hold:?} {i}: {late:?} {ordered:?}");
                let far = (late.2[i] - ordered.2[i]).abs() / ordered.3[5 * i].sqrt();
                assert!(far < 1e-6, "hindsight of {kind:?} {hold:?}, {i}: {far}");
            }
            assert_eq!(late.1, ordered.1, "{kind:?} {hold:?}");
            // An input that moves is linear between its values, and not held.
            let is_right = (late.0[2] / 6.0 - 1.0).abs() < 0.02 && (late.0[3] / 0.05 - 1.0).abs() < 0.2;
            assert!(hold == Hold::Zero || is_right, "{kind:?}: {late:?}");
        }
    }
}

#[test]
fn what_cannot_be_taken_in_is_refused_in_words_and_changes_nothing() {
    let scenario = scenario(FilterKind::EKF, Hold::Zero);
    let mut events = EventFilter::new(&scenario, 0).expect("it follows events").keeping(0.1);
    for k in 0..100 {
        events.take(0.01 * f64::from(k), 1.0, &[0.001, NONE]).expect("it is taken in");
    }
    let before = events.take(0.99, NONE, &[NONE; 2]).expect("it is taken in").mean.to_vec();
    for (time, input, readings, words) in [
        (NONE, 1.0, vec![0.0, 0.0], "the time is NaN"),
        (f64::INFINITY, 1.0, vec![0.0, 0.0], "the time is inf"),
        (0.5, 1.0, vec![0.0, 0.0], "which is too late"),
        (1e9, 1.0, vec![0.0, 0.0], "begin a new filter"),
        (1.0, f64::NEG_INFINITY, vec![0.0, 0.0], "the input is -inf"),
        (1.0, 1.0, vec![0.0], "there are 1 readings, but the scenario has 2 sensors"),
        (1.0, 1.0, vec![0.0, f64::INFINITY], "the reading of velocity is infinite"),
    ] {
        let error = events.take(time, input, &readings).map(|_| ()).expect_err(words);
        assert!(error.to_string().contains(words), "{error}");
        assert!(!matches!(error, EventError::Stopped(..)));
    }
    assert_eq!(events.take(0.99, NONE, &[NONE; 2]).expect("it is taken in").mean, before);
}

#[test]
fn settings_that_count_in_samples_are_refused_in_words() {
    let refused = |change: &dyn Fn(&mut Scenario)| {
        let mut scenario = scenario(FilterKind::EKF, Hold::Zero);
        change(&mut scenario);
        let error = EventFilter::new(&scenario, 0).map(|_| ()).expect_err("it is refused");
        assert!(matches!(error, EventSetupError::Setting(_)), "{error}");
        error.to_string()
    };
    assert!(refused(&|scenario| scenario.filters[0].kind = FilterKind::PF).contains("random members"));
    assert!(refused(&|scenario| scenario.filters[0].jump = true).contains("jumps"));
    assert!(refused(&|scenario| scenario.filters[0].augment = vec![Channel::WHITE_FORCE]).contains("a white force"));
    assert!(refused(&|scenario| scenario.filters[0].adaptation.sensor_noise = true).contains("learns"));
    assert!(EventFilter::new(&scenario(FilterKind::EKF, Hold::Zero), 3).is_err());
}

#[test]
fn random_messages_end_no_program_and_memory_stays() {
    let mut scenario = scenario(FilterKind::EKF, Hold::First);
    scenario.sensors.push(Sensor::new(Quantity::ACCELERATION, 0.1));
    scenario.filters[0].sensor_std.push(0.1);
    let mut random = Random::new(7);
    let mut events = EventFilter::new(&scenario, 0).expect("it follows events");
    let (mut time, mut taken, mut refused) = (0.0, 0_u32, 0_u32);
    for k in 0..1_000_000_u32 {
        time += 0.002 + (0.01 * random.normal()).max(-0.02);
        let odd = |every: u32, value: f64, usual: f64| if k % every == every - 1 { value } else { usual };
        let at = odd(97, f64::NAN, odd(1009, time + 1e7, odd(53, time - 2.0, time)));
        let input = odd(89, f64::INFINITY, odd(3, NONE, random.normal()));
        let readings =
            [odd(2, NONE, 0.1 * random.normal()), odd(61, f64::NEG_INFINITY, NONE), odd(5, random.normal(), NONE)];
        match events.take(at, input, &readings) {
            Ok(sample) => {
                taken += 1;
                assert!(sample.mean.iter().all(|x| x.is_finite()), "message {k}");
            }
            Err(EventError::Stopped(..)) => {
                events = EventFilter::new(&scenario, 0).expect("it follows events");
                time = 0.0;
            }
            Err(_) => refused += 1,
        }
    }
    assert!(taken > 600_000 && refused > 50_000, "{taken} {refused}");
}

#[test]
fn a_day_takes_no_more_memory_than_a_minute() {
    let scenario = scenario(FilterKind::EKF, Hold::Zero);
    let mut events = EventFilter::new(&scenario, 0).expect("it follows events");
    let mut random = Random::new(3);
    let mut follow = |from: u32, until: u32| {
        for k in from..until {
            let late = if k % 31 == 30 { 0.035 } else { 0.0 };
            let time = 0.01 * f64::from(k) - late;
            // At resonance: ωₙ = 6 rad/s, ζ = 0.05.
            let (sin, cos) = (6.0 * time).sin_cos();
            events.take(time, 0.36 * cos, &[0.1 * sin + 0.01 * random.normal(), NONE]).expect("it is taken");
        }
    };
    follow(0, 6000);
    let used = allocation_counter::measure(|| follow(6000, 8_640_000));
    assert!(used.bytes_current < 10_000 && used.bytes_max < 100_000, "{used:?}");
}
