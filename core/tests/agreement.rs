//! Different computations of the same numbers agree.

use kalmanscope_core::{
    Channel, Estimates, FilterKind, FilterSettings, Quantity, Run, Scenario, Sensor, Update, Values,
};

use crate::numbers::DETERMINISTIC;
use crate::run::{finished, finished_on, oscillator, record_of, values};

const INITIAL_STD: [f64; 4] = [0.3, 1.0, 0.0, 0.0];

fn known_parameters(kinds: &[FilterKind], dt: f64) -> Scenario {
    let mut scenario = Scenario { dt, duration: 4.0, plant: oscillator(6.0, 0.05), ..Scenario::default() };
    scenario.add_sensor(Sensor::new(Quantity::ACCELERATION, 0.5));
    let settings = |&kind: &FilterKind| FilterSettings {
        name: kind.name().to_owned(),
        kind,
        fading: 1.002,
        sensor_std: vec![0.01, 0.06, 0.5],
        initial_mean: values([0.2, -0.5, 6.0, 0.05]),
        initial_std: values(INITIAL_STD),
        process_std: Values::PROCESS_STD.with([(Channel::NATURAL_FREQUENCY, 0.0), (Channel::DAMPING_RATIO, 0.0)]),
        ..FilterSettings::default()
    };
    scenario.filters = kinds.iter().map(settings).collect();
    scenario
}

fn eventful(dt: f64) -> Scenario {
    let mut scenario = Scenario { dt, duration: 700.0 * dt, ..Scenario::default() };
    scenario.plant.disturbance_std = 0.5;
    scenario.add_sensor(Sensor::new(Quantity::ACCELERATION, 0.5));
    let eta = FilterSettings { name: "η".to_owned(), eta: 0.01, ..scenario.filters[0].clone() };
    scenario.filters.push(eta);
    scenario.filters.push(FilterSettings { kind: FilterKind::KF, ..scenario.filters[0].clone() });
    scenario
}

fn bits(estimates: &Estimates) -> Vec<u64> {
    let per_sample = (0..estimates.len()).flat_map(|k| {
        [
            estimates.mean(k),
            estimates.cov(k),
            estimates.innovation(k),
            estimates.innovation_cov(k),
            estimates.gain(k),
            &estimates.nis()[k..=k],
            &estimates.determinant()[k..=k],
        ]
    });
    let likelihoods = (0..estimates.len()).map(|k| estimates.log_likelihood(k));
    per_sample.flatten().copied().chain(likelihoods).map(f64::to_bits).collect()
}

#[track_caller]
fn assert_same(a: &Run, b: &Run) {
    assert_eq!(a.estimates().len(), b.estimates().len());
    for (a, b) in a.estimates().iter().zip(b.estimates()) {
        assert!(a.len() > 100, "{} has only {} estimates", a.name(), a.len());
        assert_eq!(bits(a), bits(b), "{}", a.name());
        assert_eq!(a.stop(), b.stop());
    }
    assert_eq!(a.checksum(), b.checksum());
}

fn difference(a: &Estimates, b: &Estimates) -> f64 {
    let mut worst = 0.0_f64;
    for k in 0..a.len() {
        for i in 0..2 {
            worst = worst.max((a.mean(k)[i] - b.mean(k)[i]).abs() / a.std(k, i));
            for j in 0..2 {
                let scale = a.std(k, i) * a.std(k, j);
                worst = worst.max((a.cov(k)[4 * i + j] - b.cov(k)[4 * i + j]).abs() / scale);
            }
        }
        if k > 0 {
            worst = worst.max((a.nis()[k] - b.nis()[k]).abs());
            worst = worst.max((a.log_likelihood(k) - b.log_likelihood(k)).abs());
        }
    }
    worst
}

#[test]
fn all_filters_agree_on_a_linear_plant() {
    let run = finished(&known_parameters(&DETERMINISTIC, 0.001));
    let [kf, ekf, others @ ..] = run.estimates() else { unreachable!("six kinds") };
    assert_eq!(bits(kf), bits(ekf));
    for other in others {
        // Sigma points move by Runge-Kutta steps: local error (ωₙ dt)⁵/120, some 1e-13.
        let difference = difference(kf, other);
        assert!(difference < 1e-9, "{}: {difference}", other.name());
        assert!(difference > 0.0, "the {} has an update of its own", other.name());
    }
}

#[test]
fn fading_is_the_same_for_every_filter() {
    for fading in [1.0, 1.002, 1.05] {
        let mut scenario = known_parameters(&FilterKind::ALL, 0.001);
        scenario.duration = 0.3;
        for filter in &mut scenario.filters {
            (filter.fading, filter.ensemble_size) = (fading, 400);
            // Without measurements or process noise the variance is that of the free motion, times fading to the k.
            (filter.process_std, filter.initial_std) = (Values::ZERO, values(INITIAL_STD));
        }
        let record = finished(&scenario).record().clone();
        scenario.sensors.clear();
        scenario.filters.iter_mut().for_each(|filter| filter.sensor_std.clear());
        let run = finished_on(&scenario, record);
        let [kf, others @ ..] = run.estimates() else { unreachable!("eight kinds") };
        let last = kf.len() - 1;
        for other in others {
            for i in 0..2 {
                let ratio = other.std(last, i) / kf.std(last, i);
                let tolerance = if other.kind().is_sampled() { 0.15 } else { 1e-9 };
                assert!((ratio - 1.0).abs() < tolerance, "{} with {fading}: {ratio}", other.name());
            }
        }
    }
}

#[test]
fn any_division_into_steps_gives_the_same_bits() {
    let scenario = eventful(0.01);
    let whole = finished(&scenario);
    let mut stepped = Run::new(&scenario).unwrap();
    assert!(stepped.is_empty() && stepped.estimates()[0].is_empty());
    while stepped.step() {
        let done = stepped.len();
        assert_eq!((stepped.record().len(), stepped.estimates()[0].len()), (done, done));
    }
    assert!(!stepped.step() && stepped.len() == whole.len());
    assert_same(&whole, &stepped);

    let mut jerky = Run::new(&scenario).unwrap();
    for (i, target) in [1, 1, 2, 40, 39, 41, 500, 10_000].into_iter().enumerate() {
        jerky.advance_to(target);
        if i % 2 == 0 {
            jerky.step();
        }
    }
    assert_same(&whole, &jerky);
    assert_eq!(whole.record(), jerky.record());
}

#[test]
fn a_simulated_record_filtered_again_gives_the_same_bits() {
    let scenario = eventful(0.01);
    let simulated = finished(&scenario);
    let again = finished_on(&scenario, simulated.record().clone());
    assert_same(&simulated, &again);
}

#[test]
fn a_record_from_a_file_gives_the_same_bits() {
    // For some of these, (n dt) / n is not equal to dt.
    for (dt, steps) in [(0.01, 700), (0.01, 116), (0.005, 114), (0.1 / 3.0, 333), (1.0 / 60.0, 777), (0.015, 1240)] {
        let scenario = Scenario { duration: f64::from(steps) * dt, ..eventful(dt) };
        let simulated = finished(&scenario);
        let mut file = Vec::new();
        simulated.record().write_csv(&mut file).unwrap();
        let sensors: Vec<Quantity> = scenario.sensors.iter().map(|s| s.measures).collect();
        let record = record_of(file, &sensors);
        assert_eq!(record.dt().to_bits(), dt.to_bits(), "{steps} steps of {dt} s");
        assert_eq!(&record, simulated.record());
        let again = finished_on(&scenario, record);
        assert_same(&simulated, &again);
    }
}

#[test]
fn sensors_may_stand_in_any_order() {
    let scenario = eventful(0.01);
    let mut reversed = scenario.clone();
    reversed.sensors.reverse();
    for filter in &mut reversed.filters {
        filter.sensor_std.reverse();
    }
    let (run, other) = (finished(&scenario), finished(&reversed));
    for (a, b) in run.estimates().iter().zip(other.estimates()) {
        assert!(difference(a, b) < 1e-6, "{}: {}", a.name(), difference(a, b));
    }
}

#[test]
fn a_restarted_run_equals_a_new_one() {
    let first = Scenario { duration: 3.0, ..Scenario::default() };
    let mut second = Scenario { seed: 9, duration: 2.0, ..Scenario::default() };
    second.filters.rotate_left(1);
    second.filters.truncate(1);
    second.remove_sensor(Quantity::VELOCITY);
    let mut run = finished(&first);
    for scenario in [&second, &first] {
        run.restart(scenario).unwrap();
        run.finish();
        let fresh = finished(scenario);
        assert_eq!((run.len(), run.checksum()), (fresh.len(), fresh.checksum()));
        assert_eq!(run.estimates().len(), scenario.filters.len());
    }
    let before = run.checksum();
    assert!(run.restart(&Scenario { dt: 0.0, ..first }).is_err());
    assert_eq!(run.checksum(), before, "an impossible scenario leaves the run as it is");
}

#[test]
fn an_updated_run_equals_a_new_one() {
    let mut scenario = Scenario { duration: 3.0, ..Scenario::default() };
    let more = FilterKind::ALL.map(|kind| FilterSettings {
        name: kind.name().to_owned(),
        kind,
        sensor_std: scenario.true_sensor_std(),
        ensemble_size: 40,
        ..FilterSettings::default()
    });
    scenario.filters.extend(more);
    scenario.number_filters();
    let mut run = Run::new(&scenario).unwrap();
    run.advance_to(200);
    type Edit = fn(&mut Scenario);
    let edits: [(Edit, Update); 9] = [
        (|_| {}, Update::Filters(vec![])),
        (|s| s.filters[1].fading = 1.01, Update::Filters(vec![2])),
        (|s| s.sensors[0].noise_std = 0.02, Update::Everything),
        (|s| s.filters[3].sensor_std[1] = 0.2, Update::Filters(vec![4])),
        (|s| drop(s.filters.remove(0)), Update::Filters(vec![])),
        (|s| s.filters.swap(0, 2), Update::Filters(vec![])),
        (|s| s.filters.truncate(4), Update::Filters(vec![])),
        (
            |s| s.filters.push(FilterSettings { id: 1, name: "new".into(), ..s.filters[0].clone() }),
            Update::Filters(vec![1]),
        ),
        (|s| s.plant.disturbance_std = 0.5, Update::Everything),
    ];
    for (i, (edit, computed)) in edits.into_iter().enumerate() {
        edit(&mut scenario);
        assert_eq!(run.update(&scenario).unwrap(), computed, "edit {i}");
        run.advance_to(200 + 10 * i);
        let mut new = Run::new(&scenario).unwrap();
        new.advance_to(200 + 10 * i);
        assert_eq!((run.done(), run.checksum()), (new.done(), new.checksum()), "edit {i}");
        assert_eq!(run.record(), new.record());
    }
    let before = run.checksum();
    scenario.filters[0].fading = 0.5;
    assert!(run.update(&scenario).is_err());
    assert_eq!(run.checksum(), before);
    run.finish();
    scenario.filters[0].fading = 1.0;
    run.update(&scenario).unwrap();
    assert_eq!(run.checksum(), finished(&scenario).checksum());
}
