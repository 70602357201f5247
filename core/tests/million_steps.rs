//! Numerical problems are reported at their sample, without panics and without silent NaN.

use std::cell::Cell;

use kalmanscope_core::{
    Adaptation, Aspect, Channel, Estimates, FilterError, FilterKind, FilterSettings, Force, Plant, PlantKind,
    Propagation, Quantity, Remark, Run, Scenario, Sensor, Trouble, TruthError, TruthStop, Values, simulate,
};
use proptest::prelude::*;
use proptest::test_runner::{TestError, TestRunner};

use crate::health::{check_file, check_scenario, scenario_of};
use crate::invariants::cases;
use crate::run::{asset, built_in, finished, finished_on, values};

/// The same cases every time, and other ones with another `KALMANSCOPE_TEST_SEED`.
fn config(count: u32) -> ProptestConfig {
    let seed = std::env::var("KALMANSCOPE_TEST_SEED").map_or(20_261_121, |text| text.parse().unwrap());
    cases(seed, count)
}

#[test]
fn a_million_steps_of_random_scenarios_are_valid_or_stop_with_a_reason() {
    let steps = Cell::new(0);
    let any_bytes = proptest::collection::vec(any::<u8>(), 400);
    let result = TestRunner::new(config(5500)).run(&any_bytes, |bytes| {
        let (scenario, gap) = scenario_of(&bytes);
        prop_assert_eq!(scenario.validate(), Ok(()));
        let done = check_scenario(&scenario, gap);
        let done = done.map_err(|what| TestCaseError::fail(format!("{what}\n{}", scenario.to_toml().unwrap())))?;
        steps.set(steps.get() + done);
        Ok(())
    });
    match result {
        Ok(()) => assert!(steps.get() > 1_000_000, "{} steps", steps.get()),
        Err(TestError::Fail(reason, _)) => panic!("{reason}"),
        Err(error) => panic!("{error}"),
    }
}

proptest! {
    #![proptest_config(config(300))]

    #[test]
    fn a_damaged_file_is_a_scenario_or_an_error(at in any::<prop::sample::Index>(), by in "\\PC{0,6}", cut in 0_usize..9) {
        let mut text: Vec<char> = include_str!("../../assets/scenarios/stiffness-loss.toml").chars().collect();
        let at = at.index(text.len() - cut);
        text.splice(at..at + cut, by.chars());
        check_file(&text.into_iter().collect::<String>()).map_err(TestCaseError::fail)?;
    }
}

fn with_filter(kind: FilterKind) -> Scenario {
    let filter = FilterSettings { fading: 1.0, kind, ..Scenario::default().filters[0].clone() };
    Scenario { duration: 10.0, filters: vec![filter], ..Scenario::default() }
}

fn checked(scenario: &Scenario) -> Run {
    check_scenario(scenario, 0).unwrap();
    finished(scenario)
}

fn remark(estimates: &Estimates, what: Trouble) -> Option<Remark> {
    estimates.remarks().iter().copied().find(|r| r.what == what)
}

#[test]
fn healthy_filters_have_no_remarks() {
    for name in "constant free-vibration hammer chirp stiffness-loss acceleration-only no-excitation".split(' ') {
        let run = finished(&built_in(name));
        assert_eq!(run.truth_stop(), None);
        for estimates in run.estimates() {
            assert_eq!(estimates.remarks(), [], "{name}, {}", estimates.name());
        }
    }
}

#[test]
fn forgetting_without_excitation_winds_up_and_is_remarked_once() {
    let mut scenario = built_in("no-excitation");
    scenario.filters.iter_mut().for_each(|filter| filter.fading = 1.02);
    let run = checked(&scenario);
    for estimates in run.estimates().iter().filter(|e| e.kind == FilterKind::EKF) {
        let limit = 1e3 * scenario.filters[0].initial_std[Channel::NATURAL_FREQUENCY];
        let far = (0..estimates.len()).find(|&k| estimates.std(k, 2) > limit).unwrap();
        let wound_up = remark(estimates, Trouble::WindUp(Channel::NATURAL_FREQUENCY)).unwrap();
        assert_eq!(wound_up.sample, far, "{}", estimates.name());
        assert!(far > 500 && wound_up.last > far, "{wound_up:?}");
        assert!(estimates.remarks().iter().filter(|r| r.what == wound_up.what).count() <= 2, "once an occasion");
        assert!(remark(estimates, Trouble::WindUp(Channel::DISPLACEMENT)).is_none_or(|r| r.sample > far));
    }
}

fn is_blind(scenario: &mut Scenario) {
    (scenario.sensors, scenario.filters[0].sensor_std) = (Vec::new(), Vec::new());
}

#[test]
fn a_filter_that_fails_stops_with_its_reason() {
    use FilterError::{ImpossibleMeasurement, NotFinite, SingularInnovation, TooLarge};
    type Case = (&'static str, &'static [FilterKind], fn(&mut Scenario), FilterError, std::ops::Range<usize>);
    let wind_up = |scenario: &mut Scenario| {
        is_blind(scenario);
        (scenario.force, scenario.filters[0].fading) = (Force::None, 3.0);
    };
    let certain = |scenario: &mut Scenario| {
        let filter = &mut scenario.filters[0];
        (filter.initial_std, filter.process_std, filter.sensor_std) = (Values::ZERO, Values::ZERO, vec![1e-200; 2]);
    };
    // The acceleration follows from displacement and velocity.
    let perfect = |scenario: &mut Scenario| {
        scenario.sensors.push(Sensor::new(Quantity::ACCELERATION, 0.0));
        let filter = &mut scenario.filters[0];
        (filter.sensor_std, filter.process_std) = (vec![1e-200; 3], Values::ZERO);
        filter.initial_std = values([0.1, 0.3, 0.0, 0.0]);
    };
    let coarse = |scenario: &mut Scenario| {
        is_blind(scenario);
        (scenario.dt, scenario.duration) = (0.5, 1000.0);
        scenario.filters[0].propagation = Some(Propagation::Euler);
    };
    let far = |scenario: &mut Scenario| {
        scenario.plant.initial.displacement = 1e160;
        scenario.filters[0].sensor_std = vec![1e-5, 1.0];
    };
    // The gain of a particle filter is a report only, so that its overflow affects no estimate.
    let scattered = |scenario: &mut Scenario| {
        scenario.filters[0].ensemble_size = 10;
        scenario.filters[0].initial_std = values([0.0, 1e153, 1e153, 0.0]);
    };
    let (all, ekf, any) = (&FilterKind::ALL[..], &[FilterKind::EKF][..], 0..usize::MAX);
    let cases: [Case; 9] = [
        // The variance triples at each sample.
        ("a variance that winds up until it overflows", ekf, wind_up, NotFinite, 640..650),
        ("sensors that cannot err and a state that is known", all, certain, SingularInnovation, 1..2),
        ("perfect sensors", ekf, perfect, SingularInnovation, 1..2),
        ("divergence", ekf, coarse, NotFinite, any.clone()),
        ("an immense σ", all, |s| s.filters[0].initial_std[Channel::DISPLACEMENT] = 1e200, TooLarge, 0..1),
        ("an immense Q", all, |s| s.filters[0].process_std[Channel::DISPLACEMENT] = 1e200, TooLarge, 0..1),
        ("an immense R", all, |s| s.filters[0].sensor_std[0] = 1e200, TooLarge, 0..1),
        ("a reading without a likelihood", all, far, ImpossibleMeasurement, any),
        ("particles too far apart for a covariance", &[FilterKind::PF], scattered, NotFinite, 1..2),
    ];
    for (name, kinds, change, reason, samples) in cases {
        for &kind in kinds {
            let mut scenario = with_filter(kind);
            change(&mut scenario);
            let stop = checked(&scenario).estimates()[0].stop();
            let stop = stop.unwrap_or_else(|| panic!("{name}, {}: it does not stop", kind.name()));
            assert!(stop.reason == reason && samples.contains(&stop.sample), "{name}, {}: {stop:?}", kind.name());
        }
    }
}

/// Beyond `|x| = ωₙ/√-μ` a softening spring pushes outwards.
#[test]
fn a_diverging_plant_ends_the_record_with_a_reason() {
    for (dt, displacement) in [(0.01, 1.0), (0.001, 0.36), (0.01, 0.36), (0.1, 0.36), (0.5, 0.36)] {
        let mut plant = Plant::default().with(Channel::CUBIC_STIFFNESS, -300.0);
        plant.kind = PlantKind::DUFFING;
        let plant = plant.with(Channel::NATURAL_FREQUENCY, 6.0);
        let mut scenario = Scenario { plant, dt, ..with_filter(FilterKind::UKF) };
        scenario.plant.initial.displacement = displacement;
        scenario.add_sensor(Sensor::new(Quantity::ACCELERATION, 0.5));
        let run = checked(&scenario);
        let TruthStop { sample, reason } = run.truth_stop().unwrap();
        assert!([Channel::DISPLACEMENT, Channel::VELOCITY].map(TruthError::Channel).contains(&reason), "{reason:?}");
        assert!(reason.to_string().contains("plant is unstable"));
        assert!(0 < sample && sample < scenario.samples(), "{sample}");
        assert_eq!((sample, sample, sample), (run.len(), run.samples(), run.record().len()), "dt {dt}");
    }
}

#[test]
fn a_force_and_a_sensor_that_overflow_end_the_record_and_are_named() {
    let force = Force::Step { amplitude: 1.7e308, at: 0.05 };
    let mut scenario = Scenario { force, ..with_filter(FilterKind::EKF) };
    scenario.plant.disturbance_std = 1e308;
    assert!(checked(&scenario).truth_stop().is_some());

    let mut scenario = with_filter(FilterKind::EKF);
    scenario.sensors[1].noise_std = 1.7e308;
    let reason = checked(&scenario).truth_stop().unwrap().reason;
    assert_eq!(reason, TruthError::Reading(Quantity::VELOCITY));
}

/// Every step of such a motion crosses kinks, so that halving the steps does not help.
#[test]
fn a_hysteresis_too_fast_for_any_step_takes_no_longer_than_another() {
    let mut plant = Plant::default().with(Channel::NATURAL_FREQUENCY, 1e9);
    plant.kind = PlantKind::BOUC_WEN;
    let scenario = Scenario { plant, dt: 1.0, duration: 20.0, filters: vec![], ..Scenario::default() };
    check_scenario(&scenario, 0).unwrap();
}

#[test]
fn missing_measurements_are_counted_and_a_run_of_them_is_remarked() {
    let scenario = with_filter(FilterKind::EKF);
    let is_missing = |sensor, k| sensor == 0 && ((200..230).contains(&k) || k == 300);
    let record = simulate(&scenario).with_gaps(is_missing);
    let estimates = &finished_on(&scenario, record).estimates()[0].clone();
    let missing = |sensor| estimates.innovations(sensor).skip(1).filter(|innovation| innovation.is_nan()).count();
    assert_eq!((missing(0), missing(1)), (31, 0));
    let what = Trouble::Missing(Quantity::DISPLACEMENT);
    assert_eq!(estimates.remarks(), [Remark { what, sample: 200, last: 229 }]);
}

#[test]
fn a_sensor_without_a_quantity_of_the_filters_plant_is_remarked() {
    let mut scenario = Scenario::default();
    scenario.set_plant(PlantKind::SHEAR_2);
    scenario.add_sensor(Sensor::new(Quantity::new(Aspect::DISPLACEMENT, 1), 0.01));
    scenario.filters.truncate(1);
    scenario.filters[0].plant = Some(PlantKind::SDOF);
    let run = checked(&scenario);
    let unknown = remark(&run.estimates()[0], Trouble::Unknown(Quantity::new(Aspect::DISPLACEMENT, 1))).unwrap();
    assert_eq!((unknown.sample, unknown.last), (1, run.len() - 1));
}

#[test]
fn particles_collapse_where_sensors_are_much_more_precise_than_they_are_many() {
    let mut scenario = with_filter(FilterKind::PF);
    let filter = &mut scenario.filters[0];
    filter.ensemble_size = 50;
    filter.sensor_std = vec![1e-6; 2];
    let run = checked(&scenario);
    let estimates = &run.estimates()[0];
    let collapse = remark(estimates, Trouble::Collapse).unwrap();
    for k in collapse.sample..collapse.sample + 10 {
        assert!(estimates.effective_samples()[k] < 2.0, "{k}");
    }
    assert!(estimates.effective_samples()[collapse.sample - 1].is_nan() || collapse.sample > 1);
}

#[test]
fn learnt_noise_that_vanishes_or_grows_is_remarked() {
    let adaptation = Adaptation { sensor_noise: true, process_noise: true, forgetting: 0.9, training: 0.0 };
    let mut scenario = Scenario { force: Force::None, ..with_filter(FilterKind::EKF) };
    scenario.sensors.iter_mut().for_each(|sensor| sensor.noise_std = 0.0);
    scenario.filters[0].adaptation = adaptation;
    let run = checked(&scenario);
    let vanishing = remark(&run.estimates()[0], Trouble::VanishingSensorNoise(Quantity::DISPLACEMENT));
    assert!(vanishing.is_some_and(|r| r.sample > 50), "{:?}", run.estimates()[0].remarks());

    let mut scenario = with_filter(FilterKind::EKF);
    scenario.filters[0].sensor_std = vec![1e-7; 2];
    scenario.filters[0].adaptation = Adaptation { process_noise: false, ..adaptation };
    let run = checked(&scenario);
    let growing = remark(&run.estimates()[0], Trouble::GrowingSensorNoise(Quantity::DISPLACEMENT));
    assert!(growing.is_some(), "{:?}", run.estimates()[0].remarks());
}

#[test]
fn a_likelihood_is_a_number_where_a_sensor_is_missing_and_s_is_singular_to_rounding() {
    // A gap of 24 in 256 leaves out a sensor in the middle, at the only step.
    check_scenario(&asset("../tests/hostile", "singular-with-a-gap"), 24).unwrap();
}
