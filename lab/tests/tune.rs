use std::sync::Arc;

use kalmanscope_core::setting::Address;
use kalmanscope_core::{Axis, Channel, FilterKind, Quantity, Scenario, Signal, Task, simulate};
use kalmanscope_diagnosis::VerdictKind;
use kalmanscope_lab::EnsembleError;
use kalmanscope_lab::tune::{Goal, TuneRemark, Tuned, Tuner};

fn scenario(seed: u64) -> Scenario {
    let text = format!(
        "seed = {seed}\nduration = 60.0\n[plant]\nnatural_frequency = 6.0\ndisturbance_std = 2.0\n[[sensors]]\n\
         measures = \"displacement\"\nnoise_std = 0.02\n[[filters]]\nkind = \"ekf\"\nsensor_std = [0.1]\n\
         [filters.initial_mean]\nnatural_frequency = 6.5\n[filters.process_std]\ndisplacement = 0.0\nvelocity = 0.002\n\
         natural_frequency = 0.0\ndamping_ratio = 0.0\n"
    );
    Scenario::from_toml(&text).unwrap()
}

fn axes() -> Vec<Axis> {
    let axes =
        ["filters.EKF.sensor_std.displacement=0.0002:2:2:log", "filters.EKF.process_std.velocity=0.00002:2:2:log"];
    axes.map(|text| Axis::parse(text).unwrap()).to_vec()
}

fn tune(scenario: Scenario, axes: Vec<Axis>, goal: Goal) -> Tuned {
    let record = Arc::new(simulate(&scenario));
    let mut tuner = Tuner::new(scenario, 0, record, axes, goal, None).unwrap();
    while !tuner.advance(&mut || false) {
        assert!((0.0..=1.0).contains(&tuner.progress()));
    }
    tuner.finish()
}

#[test]
fn the_likelihood_finds_the_true_noise() {
    let (mut sensors, mut process) = (Vec::new(), Vec::new());
    for seed in 501..=520 {
        let scenario = scenario(seed);
        let (r, q) = scenario.true_noise();
        let tuned = tune(scenario, axes(), Goal::Likelihood);
        let filter = &tuned.scenario.filters[0];
        sensors.push(filter.sensor_std[0] / r[0]);
        process.push(filter.process_std[Channel::VELOCITY] / q[Channel::VELOCITY]);
        assert_eq!(tuned.verdict, Some(VerdictKind::Consistent), "seed {seed}: {:?}", tuned.remarks);
        assert!(tuned.runs < 300, "{}", tuned.runs);
        assert!(tuned.path.windows(2).all(|pair| pair[0].score < pair[1].score));
        assert_eq!(tuned.remarks, [], "seed {seed}");
    }
    assert!(sensors.iter().all(|ratio| (0.9..1.1).contains(&(ratio * ratio))), "R: {sensors:?}");
    assert!(process.iter().all(|ratio| (0.5..2.0).contains(&(ratio * ratio))), "Q: {process:?}");
}

#[test]
fn the_result_says_where_the_record_does_not_tell_a_setting() {
    let calm = Scenario { duration: 20.0, ..scenario(1) };
    let mut axes = axes();
    axes[1] = Axis::parse("filters.EKF.initial_std.displacement=1e-7:1e-5:2:log").unwrap();
    let tuned = tune(calm, axes, Goal::Likelihood);
    let key = "filters.EKF.initial_std.displacement";
    let is_told = |remark: &TuneRemark| matches!(remark, TuneRemark::Flat(of) | TuneRemark::Edge(of) if of == key);
    assert!(tuned.remarks.iter().any(is_told), "{:?}", tuned.remarks);
}

#[test]
fn the_likelihood_of_a_wrong_model_is_not_believed() {
    let mut scenario = scenario(3);
    scenario.plant.set(Channel::NATURAL_FREQUENCY, Signal::Constant(6.0));
    scenario.plant.disturbance_std = 0.0;
    scenario.filters[0].input_delay = 12;
    let tuned = tune(scenario, axes()[..1].to_vec(), Goal::Likelihood);
    assert!(tuned.remarks.iter().any(|remark| matches!(remark, TuneRemark::Inconsistent(..))), "{:?}", tuned.remarks);
}

#[test]
fn other_goals_are_met_too() {
    for goal in [Goal::Consistency, Goal::FreeRun(Quantity::DISPLACEMENT)] {
        let tuned = tune(scenario(4), axes(), goal);
        assert!(tuned.path.last().unwrap().score > tuned.path[0].score, "{goal:?}");
    }
}

#[test]
fn only_numbers_of_filters_are_tuned() {
    let scenario = scenario(1);
    let record = Arc::new(simulate(&scenario));
    let axes = vec![Axis::parse("plant.damping_ratio=0:1:2").unwrap()];
    assert!(Address::parse(&scenario, "plant.damping_ratio").is_ok());
    assert!(matches!(Tuner::new(scenario, 0, record, axes, Goal::Likelihood, None), Err(EnsembleError::Fixed(_))));
}

#[test]
fn values_that_are_known_to_be_good_are_where_the_search_begins() {
    let scenario = scenario(5);
    let record = Arc::new(simulate(&scenario));
    let path = Tuner::new(scenario, 0, record, axes(), Goal::Likelihood, Some(&[0.02, 0.02])).unwrap().path();
    assert_eq!(path.len(), 2);
    assert!((path[1].values[0] / 0.02 - 1.0).abs() < 1e-12 && path[1].score > path[0].score);
}

/// The logarithm of σ has the standard deviation 1/√(2 n) from n readings of noise alone.
#[test]
fn the_band_of_a_noise_is_that_of_theory() {
    let mut scenario = scenario(6);
    scenario.plant.disturbance_std = 0.0;
    scenario.plant.set(Channel::NATURAL_FREQUENCY, Signal::Constant(6.0));
    let damping = scenario.plant.parameter(Channel::DAMPING_RATIO).unwrap().at(0.0);
    let filter = &mut scenario.filters[0];
    filter.kind = FilterKind::KF;
    filter.initial_mean[Channel::NATURAL_FREQUENCY] = 6.0;
    filter.initial_mean[Channel::DAMPING_RATIO] = damping;
    for channel in [Channel::DISPLACEMENT, Channel::VELOCITY] {
        (filter.initial_std[channel], filter.process_std[channel]) = (0.0, 0.0);
    }
    let readings = scenario.samples() - 1;
    let tuned = tune(scenario, axes()[..1].to_vec(), Goal::Likelihood);
    let [low, high] = tuned.bands.unwrap()[0];
    let width = (high / low).ln() / 4.0;
    let theory = 1.0 / (2.0 * readings as f64).sqrt();
    assert!((width / theory - 1.0).abs() < 0.02, "{width} in place of {theory}");
    let best = tuned.path.last().unwrap().values[0];
    assert!(((low * high).sqrt() / best - 1.0).abs() < 1e-9);
}

#[test]
fn bands_are_of_a_maximum_of_the_likelihood_only() {
    let bands = (8..18).map(|seed| tune(scenario(seed), axes(), Goal::Likelihood).bands.unwrap());
    let is_inside = |bands: &Vec<[f64; 2]>| bands.iter().all(|[low, high]| (*low..=*high).contains(&0.02));
    assert!(bands.filter(is_inside).count() >= 7, "σ of the sensor, and of the force's impulse in a step, are 0.02");
    assert_eq!(tune(scenario(7), axes(), Goal::Consistency).bands, None);
    let beyond = vec![Axis::parse("filters.EKF.sensor_std.displacement=0.05:0.5:2:log").unwrap()];
    let tuned = tune(scenario(7), beyond, Goal::Likelihood);
    let end = TuneRemark::Edge("filters.EKF.sensor_std.displacement".to_owned());
    assert!(tuned.bands.is_none() && tuned.remarks.contains(&end), "{:?}", tuned.remarks);
    assert!(end.to_string().contains("widen the range"), "{end}");
}
