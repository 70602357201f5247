//! Different computations of the same numbers agree.

use kalmanscope_core::{FilterKind, FilterSettings, Quantity, Run, Scenario, Sensor, Update};

use crate::numbers::farthest;
use crate::run::{assert_same_estimates, finished, finished_on, of_all_kinds, record_of};

fn eventful(dt: f64) -> Scenario {
    let mut scenario = Scenario { dt, duration: 700.0 * dt, ..Scenario::default() };
    scenario.plant.disturbance_std = 0.5;
    scenario.add_sensor(Sensor::new(Quantity::ACCELERATION, 0.5));
    let eta = FilterSettings { name: "η".to_owned(), eta: 0.01, ..scenario.filters[0].clone() };
    scenario.filters.push(eta);
    scenario.filters.push(FilterSettings { kind: FilterKind::KF, ..scenario.filters[0].clone() });
    scenario
}

#[track_caller]
fn assert_same(a: &Run, b: &Run) {
    assert_eq!(a.estimates().len(), b.estimates().len());
    for (a, b) in a.estimates().iter().zip(b.estimates()) {
        assert!(a.len() > 100, "{} has only {} estimates", a.name(), a.len());
        assert_same_estimates(a, b, a.name());
    }
    assert_eq!(a.checksum(), b.checksum());
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
fn a_record_from_a_file_gives_the_same_bits() {
    // For some of these, (n dt) / n is not equal to dt.
    for (dt, steps) in [(0.01, 700), (0.01, 116), (0.005, 114), (0.1 / 3.0, 333), (1.0 / 60.0, 777), (0.015, 1240)] {
        let scenario = Scenario { duration: f64::from(steps) * dt, ..eventful(dt) };
        let simulated = finished(&scenario);
        let mut file = Vec::new();
        simulated.record().write_csv(&mut file).unwrap();
        let record = record_of(file, &scenario);
        assert_eq!(record.dt().to_bits(), dt.to_bits(), "{steps} steps of {dt} s");
        assert_eq!(&record, simulated.record());
        assert_same(&simulated, &finished_on(&scenario, record));
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
        assert!(farthest(a, b, 1) < 1e-6, "{}: {}", a.name(), farthest(a, b, 1));
    }
}

#[test]
fn an_updated_run_equals_a_new_one() {
    let mut scenario = Scenario { duration: 3.0, ..Scenario::default() };
    scenario.filters.extend(of_all_kinds(&scenario.filters[0]));
    scenario.number_filters();
    let mut run = Run::new(&scenario).unwrap();
    run.advance_to(200);
    type Edit = fn(&mut Scenario);
    let edits: [(Edit, Update); 11] = [
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
        (|s| s.remove_sensor(Quantity::VELOCITY), Update::Everything),
        (|s| (s.seed, s.duration) = (9, 4.0), Update::Everything),
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
