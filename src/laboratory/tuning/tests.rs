use std::rc::Rc;

use super::*;
use crate::laboratory::{Laboratory, MapChoice};
use crate::team::{Frames, Precision};
use kalmanscope_core::setting::Address;
use kalmanscope_core::{Axis, Channel, Quantity};
use kalmanscope_diagnosis::Measure;
use kalmanscope_lab::tune::Goal;

fn session() -> Session {
    let mut scenario = Scenario { duration: 4.0, ..Scenario::default() };
    scenario.filters[0].sensor_std.iter_mut().for_each(|std| *std *= 5.0);
    Session::new(scenario).unwrap()
}

fn laboratory(keys: &[&str]) -> Laboratory {
    let mut laboratory = Laboratory::new(Rc::new(Frames(Budget::Unlimited)));
    laboratory.tuning.choose(Some(choice(keys)));
    laboratory
}

fn choice(keys: &[&str]) -> TuneChoice {
    let part = part_of(session().scenario(), &[1]);
    let mut choice = TuneChoice { filter: 1, axes: Vec::new(), goal: Goal::Likelihood };
    keys.iter().for_each(|key| choice.toggle(key, &part));
    choice
}

const SENSORS: [&str; 2] = ["filters.*.sensor_std.displacement", "filters.*.sensor_std.velocity"];

#[test]
fn the_usual_choice_has_the_noise_of_sensors_and_a_factor_on_q() {
    let choice = TuneChoice::usual(session().scenario(), None).unwrap();
    let mut keys: Vec<&str> = choice.axes.iter().map(|axis| axis.key.as_str()).collect();
    keys.sort_unstable();
    assert_eq!((choice.filter, keys), (1, vec!["filters.*.process_std", SENSORS[0], SENSORS[1]]));
    assert_eq!(TuneChoice::usual(&Scenario { filters: Vec::new(), ..Scenario::default() }, None), None);
}

#[test]
fn a_tick_takes_those_away_that_would_set_the_same_number() {
    let part = part_of(session().scenario(), &[1]);
    let mut choice = choice(&SENSORS);
    choice.toggle("filters.*.sensor_std", &part);
    assert_eq!(choice.axes.len(), 1);
    choice.toggle("filters.*.sensor_std", &part);
    assert_eq!(choice.axes, []);
}

#[test]
fn a_change_of_the_settings_ends_the_search() {
    let mut session = session();
    let mut laboratory = laboratory(&[]);
    laboratory.tune(&session);
    assert_eq!(laboratory.tuning.problem.as_deref(), Some("Tick a setting to tune."));
    laboratory.tuning.choose(Some(choice(&SENSORS)));
    laboratory.tune(&session);
    laboratory.follow_tuning(&session, false, &Context::default());
    assert!(laboratory.tuning.progress().is_some(), "out of sight it rests");
    let mut scenario = session.scenario().clone();
    scenario.filters[0].fading = 1.01;
    session.set_scenario(scenario);
    laboratory.follow_tuning(&session, true, &Context::default());
    assert!(laboratory.tuning.progress().is_none() && laboratory.tuning.result.as_ref().is_none());
    assert!(laboratory.tuning.problem.as_deref().unwrap().contains("have changed"));
}

#[test]
fn the_search_begins_at_the_best_cell_of_a_map_of_its_settings() {
    let session = session();
    let mut laboratory = laboratory(&[]);
    let axes = [("filters.*.sensor_std", 4), ("filters.*.process_std", 3)];
    let part = part_of(session.scenario(), &[1]);
    let axis = |(key, count): (&str, usize)| Axis::usual(&Address::parse(&part, key).unwrap(), &part, count);
    let measure = Measure::rmse(Channel::NATURAL_FREQUENCY);
    laboratory.choose(Some(MapChoice {
        axes: axes.map(axis),
        measure,
        filter: 1,
        second: None,
        precision: Precision::default(),
    }));
    laboratory.follow(&session, true, false, &Context::default());
    let survey = laboratory.shown().unwrap();
    assert!(survey.sheet.is_complete());
    let likelihood = |cell: usize| survey.value(cell, 0, Measure::LOG_LIKELIHOOD).unwrap();
    let best = (0..12).max_by(|a, b| likelihood(*a).total_cmp(&likelihood(*b))).unwrap();
    let (expected, score) = (survey.ensemble.values(best), likelihood(best));
    laboratory.tuning.choose(Some(choice(&["filters.*.process_std", "filters.*.sensor_std"])));
    laboratory.tune(&session);
    let second = &laboratory.tuning.path()[1];
    assert!((second.values[0] / expected[1] - 1.0).abs() < 1e-9 && (second.values[1] / expected[0] - 1.0).abs() < 1e-9);
    assert!((second.score / score - 1.0).abs() < 1e-9);
    // The path in the map goes from the setting on screen over the best cell, whatever a factor is relative to.
    let survey = laboratory.shown().unwrap();
    let (filter, points) = laboratory.tuning.path_in(survey).unwrap();
    let are_close = |a: [f64; 2], b: [f64; 2]| a.iter().zip(b).all(|(a, b)| (a / b - 1.0).abs() < 1e-9);
    assert_eq!(filter, 0);
    assert!(
        are_close(points[0], survey.present(session.scenario())) && are_close(points[1], [expected[0], expected[1]])
    );
    laboratory.tuning.choose(Some(choice(&SENSORS)));
    laboratory.tune(&session);
    assert_eq!(laboratory.tuning.path_in(laboratory.shown().unwrap()), None, "the axes are not tuned");
}

#[test]
fn an_impossible_choice_is_told() {
    let session = session();
    let scenario = session.scenario();
    let usual = TuneChoice::usual(scenario, None).unwrap();
    let error = |choice: &TuneChoice| choice.check(scenario).unwrap_err();
    assert_eq!(usual.check(scenario), Ok(()));
    assert!(error(&TuneChoice { filter: 99, ..usual.clone() }).contains("filter number 99"));
    assert!(
        error(&TuneChoice { goal: Goal::FreeRun(Quantity::ACCELERATION), ..usual.clone() }).contains("acceleration")
    );
    let with = |key: &str| {
        let axis = Axis { key: key.to_owned(), ..usual.axes[0].clone() };
        TuneChoice { axes: usual.axes.iter().cloned().chain([axis]).collect(), ..usual.clone() }
    };
    assert!(error(&with(SENSORS[0])).contains("set twice"));
    assert!(error(&with("seed")).contains("not a setting of a filter"));
    assert!(!error(&with("filters.*.speed")).is_empty());
}
