//! Scenarios that were once judged wrongly, each with the verdict that it must have.

use kalmanscope_core::setting::Edit;
use kalmanscope_core::{Channel, Diagnostics, Run, Scenario, simulate};
use kalmanscope_diagnosis::Verdict;
use kalmanscope_diagnosis::VerdictKind::{
    self, Collapsed, Consistent, Overconfident, Recovered, Underconfident, WoundUp,
};

use crate::run::{asset, bound, finished, finished_on};
use crate::situations::largest_error;
use crate::{diagnosis, remedies};

fn finding(name: &str) -> Scenario {
    asset("../diagnosis/tests/findings", name)
}

fn verdicts(scenario: &Scenario, place: usize) -> [Verdict; 2] {
    let alone = Scenario { filters: vec![scenario.filters[place].clone()], ..scenario.clone() };
    let run = finished(&alone);
    let without = run.record().clone().with_truth(Vec::new()).unwrap();
    [run.record(), &without].map(|record| diagnosis(&run.estimates()[0], record).verdict.unwrap())
}

fn with_seed(scenario: &Scenario, seed: u64) -> Scenario {
    Scenario { seed, ..scenario.clone() }
}

#[track_caller]
fn assert_kind(verdict: &Verdict, allowed: &[VerdictKind]) {
    assert!(allowed.contains(&verdict.kind), "{verdict}");
}

#[test]
fn a_collapsed_sample_is_not_underconfident() {
    let mut scenario = finding("pf-collapse");
    let [known, unknown] = verdicts(&scenario, scenario.filters.len() - 1);
    assert_kind(&known, &[Collapsed]);
    assert_kind(&unknown, &[Collapsed]);
    assert!(known.reason.contains(" falls "), "{known}");
    scenario.filters.drain(..scenario.filters.len() - 1);
    let run = finished(&scenario);
    let found = diagnosis(&run.estimates()[0], run.record());
    assert!(found.evidence.iter().any(|one| one.counts && one.speaks_for == Collapsed), "{:?}", found.verdict);
}

#[test]
fn a_reading_that_is_no_reading_is_never_underconfidence() {
    let scenario = finding("overload");
    // One displacement is as large as a code for a missing value.
    let change = |sensor, k, value| if (sensor, k) == (0, 300) { 1e10 } else { value };
    let run = finished_on(&scenario, simulate(&scenario).without_truth().with_measured(change));
    let verdict = diagnosis(&run.estimates()[0], run.record()).verdict.unwrap();
    assert_kind(&verdict, &[VerdictKind::Lost, VerdictKind::Diverged, Overconfident]);
}

#[test]
fn one_reading_changes_nothing_that_is_said_of_the_rest() {
    let scenario = finding("overload");
    let run = finished(&scenario);
    let (estimates, record) = (&run.estimates()[0], run.record());
    // A filter that has not seen the reading, but whose first innovation is immense.
    let mut sure = scenario.clone();
    sure.filters[0].initial_std[Channel::DISPLACEMENT] = 1e-12;
    sure.plant.initial.displacement = 0.1;
    let with_surprise = finished(&sure);
    let rest = 600..estimates.len();
    let of = |run: &Run| Diagnostics::new(&run.estimates()[0], run.record()).nis_within(rest.clone()).per_degree();
    assert!((of(&with_surprise) - 1.0).abs() < 0.1 && (of(&run) - 1.0).abs() < 0.1);
    assert_kind(&diagnosis(estimates, record).verdict.unwrap(), &[Consistent]);
}

#[test]
fn what_is_lost_at_the_end_is_not_forgiven() {
    let scenario = finding("late-step");
    for at in [40.0, 47.0, 50.0, 52.0, 55.0, 58.0] {
        for seed in 1..=3 {
            let mut scenario = with_seed(&scenario, seed);
            let step = kalmanscope_core::signal::Step { from: 6.0, to: 4.8, at };
            scenario.plant.set(Channel::NATURAL_FREQUENCY, kalmanscope_core::Signal::Step(step));
            let [known, _] = verdicts(&scenario, 0);
            assert_kind(&known, &[Overconfident, VerdictKind::Diverged]);
        }
    }
}

/// With a start that is too sure, sensors that are trusted too little, and fading without an input, whether or not the truth is known.
#[test]
fn every_seed_has_one_of_the_right_verdicts() {
    for (name, seeds, places, allowed) in [
        ("start-too-sure", None, 1, &[Recovered, Consistent][..]),
        ("r-hundredfold", Some(1..=4), 2, &[Underconfident]),
        ("wind-up", Some(1..=12), 2, &[WoundUp, VerdictKind::Diverged, VerdictKind::Lost]),
    ] {
        let scenario = finding(name);
        for seed in seeds.unwrap_or(scenario.seed..=scenario.seed) {
            for verdict in (0..places).flat_map(|place| verdicts(&with_seed(&scenario, seed), place)) {
                assert_kind(&verdict, allowed);
                assert!(name != "wind-up" || !verdict.reason.contains("surprise"), "{verdict}");
            }
        }
    }
}

#[test]
fn a_wrong_parameter_is_not_diluted_by_right_ones() {
    let [known, _] = verdicts(&finding("kappa4-five-sigma"), 0);
    assert_kind(&known, &[Overconfident]);
    assert!(known.reason.contains("stiffness 4"), "{known}");

    let ramp = finding("slow-ramp");
    for seed in 1..=6 {
        let scenario = with_seed(&ramp, seed);
        let run = finished(&scenario);
        let (estimates, record) = (&run.estimates()[0], run.record());
        let off = largest_error(estimates, record);
        let verdict = diagnosis(estimates, record).verdict.unwrap();
        assert!(off < 4.0 || verdict.kind == Overconfident, "{off}σ off in the last fifth: {verdict}");
    }
}

#[test]
fn consistent_beside_numbers_that_say_otherwise_is_explained() {
    let scenario = finding("pf-at-rest");
    let [known, _] = verdicts(&scenario, scenario.filters.len() - 1);
    let is_said = known.kind == Overconfident || known.reason.contains("perhaps by chance");
    assert!(is_said || !known.kind.is_good(), "{known}");
}

#[test]
fn the_disturbance_that_an_accelerometer_feels_is_part_of_its_noise() {
    let scenario = finding("accelerometer-disturbance");
    let (sensor_std, _) = scenario.true_noise();
    assert!((sensor_std[1] - libm::hypot(0.5, 2.0)).abs() < 1e-12 && sensor_std[0] == 0.01);
    let [wrong, right] = [0, 1].map(|place| verdicts(&scenario, place));
    assert_kind(&wrong[0], &[Overconfident]);
    assert_kind(&right[0], &[Consistent]);
    assert_kind(&right[1], &[Consistent]);
    // The bound has the same R: the wrong filter's σ is below what can be.
    let run = finished(&scenario);
    let estimates = &run.estimates()[0];
    let bound = bound(&scenario, 0, run.record());
    let (last, place) = (estimates.len() - 1, estimates.place(Channel::NATURAL_FREQUENCY).unwrap());
    assert!(estimates.std(last, place) < 0.6 * bound.std(last, bound.place(Channel::NATURAL_FREQUENCY).unwrap()));
}

#[test]
fn the_cause_of_a_felt_disturbance_is_named_and_its_remedy_helps() {
    let mut scenario = finding("accelerometer-disturbance");
    scenario.filters.truncate(1);
    let run = finished(&scenario);
    let remedies = remedies(&run, 0, run.record());
    assert_eq!(remedies[0].first.cause.key, "felt_disturbance", "{remedies:?}");
    assert_eq!(remedies[0].after.as_ref().unwrap().kind, Consistent);
    // A white force explains the readings of the accelerometer, which a larger R forgets: it is the better remedy.
    assert_eq!(remedies[0].edits[0].toml_line(), "augment = [\"white_force\"]", "{remedies:?}");
    let likelihood = |scenario: &Scenario| {
        let run = finished(scenario);
        Diagnostics::new(&run.estimates()[0], run.record()).log_likelihood()
    };
    let mut inflated = scenario.clone();
    inflated.filters[0].sensor_std[1] = 2.06;
    let turned = Edit::apply_all(&remedies[0].edits, &scenario).unwrap();
    assert_eq!(turned.filters[0].sensor_std, scenario.filters[0].sensor_std);
    let [with_force, with_noise] = [&turned, &inflated].map(likelihood);
    assert!(with_force > with_noise + 100.0, "{with_force} with a white force, {with_noise} with a larger R");
}

#[test]
fn sensors_that_are_wrong_in_contrary_directions_do_not_cancel() {
    let mut scenario = finding("r-hundredfold");
    scenario.filters.truncate(1);
    scenario.filters[0].sensor_std = vec![0.01 / 1.9_f64.sqrt() / 1.3, 0.06 * 10.0_f64.sqrt()];
    for seed in 1..=4 {
        for verdict in verdicts(&with_seed(&scenario, seed), 0) {
            assert_kind(&verdict, &[Overconfident, Underconfident]);
        }
    }
    // Whatever is not white but harmless is said beside the verdict.
    let [_, unknown] = verdicts(&finding("accelerometer-disturbance"), 1);
    assert!(unknown.reason.contains("not quite white") || unknown.kind == Consistent, "{unknown}");
}
