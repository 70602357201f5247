//! Records whose readings have times of their own.

use kalmanscope_core::record::{Clocks, LiveRecord, Record, Timed};
use kalmanscope_core::{
    Channel, Estimates, FilterKind, FilterSettings, Force, Hold, InputKind, Quantity, Remark, Robust, Run, Scenario,
    Trouble, Values, simulate,
};

use crate::events::{Told, on_fine_grid, own_clocks};
use crate::live::follow;
use crate::numbers::farthest;
use crate::run::{forced, one_filter, run_on, with_times};

const DT: f64 = 0.01;

pub(crate) fn scenario(kind: FilterKind, seed: u64) -> Scenario {
    let mut scenario = Scenario { duration: 8.0, dt: DT, seed, ..one_filter(kind) };
    scenario.filters[0].process_std = Values::ZERO;
    scenario
}

pub(crate) fn told(scenario: &Scenario, seed: u64) -> Vec<Told> {
    let mut told = own_clocks(scenario, seed);
    told.sort_by(|a, b| a.time.total_cmp(&b.time));
    told
}

fn timed(told: &[Told], of: impl Fn(&Told) -> f64) -> Timed {
    let there: Vec<&Told> = told.iter().filter(|one| !of(one).is_nan()).collect();
    Timed { times: there.iter().map(|one| one.time / DT).collect(), values: there.iter().map(|one| of(one)).collect() }
}

pub(crate) fn record(told: &[Told], len: usize) -> Record {
    let input = timed(told, |one| one.input);
    let readings = [0, 1].map(|sensor| timed(told, |one| one.readings[sensor]));
    let at_samples = |Timed { times, values }: &Timed| {
        let mut column = vec![f64::NAN; len];
        for (time, value) in times.iter().zip(values) {
            let k = (time - 1e-6).ceil() as usize;
            if k < len {
                column[k] = *value;
            }
        }
        column
    };
    let [one, other] = [0, 1].map(|sensor: usize| at_samples(&readings[sensor]));
    let columns = vec![(Quantity::DISPLACEMENT, one), (Quantity::VELOCITY, other)];
    let record = forced(DT, Hold::Zero, vec![0.0; len], columns);
    let clocks = Clocks { input: Some(input), readings: readings.to_vec() };
    record.with_clocks(clocks).expect("the times are usable")
}

fn squares(estimates: &Estimates) -> (f64, u32) {
    let measured = (0..estimates.len()).filter(|k| !estimates.nis()[*k].is_nan());
    measured.fold((0.0, 0), |(nis, readings), k| (nis + estimates.nis()[k], readings + estimates.readings(k)))
}

fn likelihood(estimates: &Estimates) -> f64 {
    (0..estimates.len()).map(|k| estimates.log_likelihood(k)).filter(|ln| !ln.is_nan()).sum()
}

/// The readings as far as the last sample, after which a smoother would know what came, and the number of samples.
fn on_whole_steps(scenario: &Scenario, seed: u64) -> (Vec<Told>, usize) {
    let mut told = told(scenario, seed);
    let len = (told.last().expect("there are some").time / DT).floor() as usize + 1;
    told.retain(|one| one.time <= (len - 1) as f64 * DT + 1e-9);
    (told, len)
}

fn pair(scenario: &Scenario, seed: u64) -> [Run; 2] {
    let (told, len) = on_whole_steps(scenario, seed);
    pair_of(scenario, &told, len)
}

fn pair_of(scenario: &Scenario, told: &[Told], len: usize) -> [Run; 2] {
    let (grid, fine) = on_fine_grid(scenario, told, 100 * len);
    [run_on(scenario, record(told, len)), run_on(&grid, fine)]
}

#[test]
fn clocks_of_their_own_equal_a_grid_a_hundred_times_finer() {
    // det S of all readings in a step underflows where each is of so small a motion.
    for (seed, size) in [(1, 1.0), (2, 1.0), (3, 1.0), (3, 1e-80)] {
        let mut scenario = scenario(FilterKind::KF, seed);
        let filter = &mut scenario.filters[0];
        (filter.fading, filter.smoother) = (1.002, true);
        filter.sensor_std.iter_mut().for_each(|std| *std *= size);
        for channel in [Channel::DISPLACEMENT, Channel::VELOCITY] {
            filter.initial_std[channel] *= size;
        }
        let (mut told, len) = on_whole_steps(&scenario, seed);
        told.iter_mut().for_each(|one| one.input *= size);
        told.iter_mut().flat_map(|one| &mut one.readings).for_each(|reading| *reading *= size);
        let [own, grid] = pair_of(&scenario, &told, len);
        let found = farthest(&own.estimates()[0], &grid.estimates()[0], 100);
        assert!(found < 1e-9, "seed {seed}: {found}");
        let [(nis, readings), all] = [&own, &grid].map(|run| squares(&run.estimates()[0]));
        assert_eq!(readings, all.1, "each reading counts, also of two in a step");
        assert!((nis / all.0 - 1.0).abs() < 1e-9, "seed {seed}: {nis} {}", all.0);
        let [own_likelihood, likelihood] = [&own, &grid].map(|run| likelihood(&run.estimates()[0]));
        assert!((own_likelihood / likelihood - 1.0).abs() < 1e-9, "seed {seed}: {own_likelihood} {likelihood}");
        let [own, grid] = [own, grid].map(|run| run.smoothed().remove(0));
        let found = farthest(&own, &grid, 100);
        assert!(found < 1e-6, "smoothed, seed {seed}: {found}");
    }
}

#[test]
fn a_live_record_has_the_times_that_its_readings_have() {
    for (seed, kind) in [(21, FilterKind::KF), (22, FilterKind::EKF), (23, FilterKind::UKF)] {
        let scenario = scenario(kind, seed);
        let (mut told, len) = on_whole_steps(&scenario, seed);
        let whole = run_on(&scenario, record(&told, len));
        told.sort_by(|a, b| a.came.total_cmp(&b.came));
        let sensors = vec![Quantity::DISPLACEMENT, Quantity::VELOCITY];
        let mut live = LiveRecord::new(DT, InputKind::Force, Hold::Zero, sensors).waiting(0.55);
        let mut growing: Option<Run> = None;
        for one in &told {
            live.take(40.0 + one.time, one.input, &one.readings).expect("it waits");
            if live.record().len() >= 2 {
                follow(&mut growing, &scenario, live.so_far());
            }
        }
        live.finish();
        let growing = follow(&mut growing, &scenario, live.so_far());
        let [found, wanted] = [growing.record(), whole.record()].map(|record| record.clocks().expect("it has clocks"));
        let done = growing.estimates()[0].len();
        assert!(done + 1 >= len, "{done} of {len}");
        let [found, wanted] = [found, wanted].map(|clocks| clocks.readings.iter().chain(&clocks.input));
        for (found, wanted) in found.zip(wanted) {
            let count = wanted.times.partition_point(|time| *time <= (done - 1) as f64);
            assert_eq!(found.values, wanted.values[..count]);
            assert!(found.times.iter().zip(&wanted.times).all(|(a, b)| (a - b).abs() < 1e-9));
        }
        let far = farthest(&growing.estimates()[0], &whole.estimates()[0], 1);
        assert!(far <= 1e-6, "{kind:?}: {far}");
    }
}

#[test]
fn a_look_ahead_equals_that_on_a_finer_grid() {
    let mut scenario = scenario(FilterKind::KF, 7);
    (scenario.filters[0].smoother, scenario.filters[0].look_ahead) = (true, 0.25);
    let [own, grid] = pair(&scenario, 7).map(|run| run.smoothed().remove(0));
    let found = farthest(&own, &grid, 100);
    assert!(found < 1e-6, "{found}");
}

#[test]
fn filters_of_parameters_agree_with_a_finer_grid() {
    for (kind, robust) in
        [(FilterKind::EKF, Robust::NONE), (FilterKind::UKF, Robust::NONE), (FilterKind::EKF, Robust::HUBER)]
    {
        // An input at 20 Hz has all of this force.
        let force = Force::Step { amplitude: 3.0, at: 0.0 };
        let mut scenario = Scenario { force, ..scenario(kind, 4) };
        let filter = &mut scenario.filters[0];
        // From a good guess, a linearisation is good over either step.
        for (channel, truth) in [(Channel::NATURAL_FREQUENCY, 6.0), (Channel::DAMPING_RATIO, 0.05)] {
            filter.initial_mean[channel] = truth;
            filter.initial_std[channel] = 0.01 * truth;
        }
        filter.robust = robust;
        filter.process_std[Channel::NATURAL_FREQUENCY] = 1e-3;
        let [own, mut grid] = pair(&scenario, 4);
        // Q is that of a step.
        let mut finer = grid.scenario().clone();
        finer.filters[0].process_std[Channel::NATURAL_FREQUENCY] = 1e-4;
        grid.update(&finer).expect("it can be run");
        let found = farthest(&own.estimates()[0], &grid.estimates()[0], 100);
        assert!(found < 0.1, "{kind:?} {robust:?}: {found}");
    }
}

#[test]
fn times_of_the_samples_change_nothing() {
    let changes: [fn(&mut FilterSettings); 10] = [
        |_| {},
        |filter| filter.input_delay = 3,
        |filter| filter.input_delay = -2,
        |filter| filter.guesses = 5,
        |filter| (filter.kind, filter.substeps) = (FilterKind::UKF, 2),
        |filter| (filter.kind, filter.log_parameters) = (FilterKind::CKF, true),
        |filter| filter.kind = FilterKind::SR_UKF,
        |filter| (filter.kind, filter.robust) = (FilterKind::IEKF, Robust::GATE),
        |filter| filter.consider = vec![Channel::DAMPING_RATIO],
        |filter| filter.augment = vec![Channel::UNKNOWN_FORCE],
    ];
    for hold in [Hold::Zero, Hold::First] {
        for (nth, change) in changes.iter().enumerate() {
            let mut scenario = Scenario { hold, ..scenario(FilterKind::EKF, 9) };
            change(&mut scenario.filters[0]);
            let even = simulate(&scenario).without_truth().with_gaps(|sensor, k| k % 9 == sensor);
            let timed = with_times(&even, |_, k| k);
            let times = (0..even.len()).map(|k| k as f64).collect();
            for input in [None, Some(Timed { times, values: even.input().to_vec() })] {
                let clocks = Clocks { input, ..timed.clocks().expect("it has times").clone() };
                let own = run_on(&scenario, even.clone().with_clocks(clocks).expect("the times are usable"));
                let expected = run_on(&scenario, even.clone());
                let [own, expected] = [&own, &expected].map(|run| &run.estimates()[0]);
                let far = farthest(own, expected, 1);
                assert!(far < 1e-7, "{hold:?}, change {nth}: {far}");
                for k in 0..own.len() {
                    let [a, b] = [own, expected].map(|estimates| estimates.nis()[k]);
                    let is_near = a.is_nan() == b.is_nan() && (a.is_nan() || (a - b).abs() < 1e-6 * b.max(1.0));
                    assert!(is_near, "{k}: {a} {b}");
                }
            }
        }
    }
}

#[test]
fn an_option_that_counts_in_samples_says_so() {
    let base = scenario(FilterKind::EKF, 2);
    let told = told(&base, 2);
    let record = record(&told, 700);
    let changes: [(fn(&mut FilterSettings), _); 3] = [
        (|_| {}, None),
        (|filter| filter.jump = true, Some("jumps")),
        (|filter| filter.adaptation.sensor_noise = true, Some("noise that it learns")),
    ];
    for (change, expected) in changes {
        let mut scenario = base.clone();
        change(&mut scenario.filters[0]);
        let run = run_on(&scenario, record.clone());
        let found = run.estimates()[0].remarks().iter().find_map(|remark| match remark.what {
            Trouble::Moved(what) => Some(what),
            _ => None,
        });
        assert_eq!(found, expected);
        // A sensor of 7 Hz is not silent.
        let silent = |remark: &Remark| matches!(remark.what, Trouble::Missing(_));
        assert!(!run.estimates()[0].remarks().iter().any(silent), "{:?}", run.estimates()[0].remarks());
    }
}

#[test]
fn a_part_of_a_record_keeps_its_times() {
    let base = scenario(FilterKind::KF, 6);
    let told = told(&base, 6);
    let whole = record(&told, 700);
    let part = whole.part(200..600);
    let clocks = part.clocks().expect("it has times");
    assert!(clocks.readings[0].times.iter().all(|time| (-1.0..=399.0).contains(time)));
    let all = &whole.clocks().expect("it has times").readings[0].times;
    let within = all.iter().filter(|time| **time > 199.0 && **time <= 599.0).count();
    assert_eq!(clocks.readings[0].times.len(), within);
    let turned = whole.with_measured(|sensor, _, value| if sensor == 0 { -value } else { f64::NAN });
    let clocks = turned.clocks().expect("it has times");
    assert_eq!(clocks.readings[1], Timed::default());
    let sixth = told.iter().filter(|one| !one.readings[0].is_nan()).nth(5).expect("there are some");
    assert_eq!(clocks.readings[0].values[5], -sixth.readings[0]);
}

#[test]
fn impossible_times_are_refused() {
    let base = scenario(FilterKind::KF, 6);
    let even = record(&told(&base, 6), 300);
    let with = |readings: Vec<Timed>, input: Option<Timed>| {
        even.clone().with_clocks(Clocks { input, readings }).unwrap_err().to_string()
    };
    let timed = |times: &[f64]| Timed { times: times.to_vec(), values: vec![1.0; 2] };
    assert_eq!(with(vec![timed(&[1.0, 2.0])], None), "1 series of readings, but the record has 2 sensor(s)");
    assert!(with(vec![timed(&[1.0, 1.0]), Timed::default()], None).starts_with("value 1: the times must rise"));
    assert!(with(vec![timed(&[1.0, f64::NAN]), Timed::default()], None).starts_with("value 1: the times must rise"));
    assert_eq!(with(vec![timed(&[1.0]), Timed::default()], None), "1 times, but 2 values");
    assert_eq!(with(vec![Timed::default(); 2], Some(Timed::default())), "an input with times of its own needs a value");
}
