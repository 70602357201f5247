use egui::Context;
use kalmanscope_core::{Axis, Channel, FilterSettings, Scenario, Spacing};
use kalmanscope_diagnosis::Measure;

use super::*;
use crate::session::{Budget, Mode};
use crate::team::{Frames, Precision};

fn session() -> Session {
    Session::new(Scenario { duration: 2.0, ..Scenario::default() }).unwrap()
}

fn slow() -> Laboratory {
    let mut laboratory = Laboratory::new(Rc::new(Frames(Budget::Pieces(1))));
    laboratory.choose(Some(choice()));
    laboratory
}

fn choice() -> MapChoice {
    let axes = ["filters.*.initial_mean.natural_frequency=2:14:5", "filters.*.process_std=0.1:10:3:log"];
    let axes = axes.map(|text| Axis::parse(text).unwrap());
    MapChoice {
        axes,
        measure: Measure::rmse(Channel::NATURAL_FREQUENCY),
        filter: 1,
        second: None,
        precision: Precision::default(),
    }
}

fn follow(laboratory: &mut Laboratory, session: &Session, frames: usize) {
    let ctx = Context::default();
    (0..frames).for_each(|_| laboratory.follow(session, true, false, &ctx));
}

fn followed(frames: usize) -> (Session, Laboratory) {
    let (session, mut laboratory) = (session(), slow());
    follow(&mut laboratory, &session, frames);
    (session, laboratory)
}

fn done(laboratory: &Laboratory) -> usize {
    laboratory.shown().unwrap().sheet.done()
}

fn with(session: &mut Session, change: impl FnOnce(&mut Scenario)) {
    let mut scenario = session.scenario().clone();
    change(&mut scenario);
    session.set_scenario(scenario);
}

fn ekf(scenario: &mut Scenario) -> &mut FilterSettings {
    &mut scenario.filters[0]
}

#[test]
fn a_moved_dot_restarts_nothing() {
    let (mut session, mut laboratory) = followed(7);
    let moved = laboratory.shown().unwrap().with(session.scenario(), [20.0, 8.0]).unwrap();
    session.edit(&moved).unwrap();
    follow(&mut laboratory, &session, 1);
    assert_eq!((done(&laboratory), laboratory.is_shown_old()), (8, false), "it continues");
    let [x, y] = laboratory.shown().unwrap().present(session.scenario());
    assert!((x - 20.0).abs() < 1e-12 && (y - 8.0).abs() < 1e-9, "{x} {y}");
}

#[test]
fn another_filter_or_its_colour_changes_no_map() {
    let (mut session, mut laboratory) = followed(4);
    with(&mut session, |scenario| {
        scenario.filters[1].fading = 1.02;
        scenario.filters[0].color = Some(kalmanscope_core::FilterColor::ALL[3]);
    });
    follow(&mut laboratory, &session, 1);
    assert_eq!(done(&laboratory), 5);
}

#[test]
fn an_edit_restarts_and_the_old_map_stays_until_the_new_one_covers() {
    let (mut session, mut laboratory) = followed(20);
    let fading = |laboratory: &Laboratory| laboratory.shown().unwrap().ensemble.scenario().filters[0].fading;
    with(&mut session, |scenario| ekf(scenario).fading = 1.03);
    let mut frames = 0;
    loop {
        follow(&mut laboratory, &session, 1);
        frames += 1;
        assert!(laboratory.shown().unwrap().sheet.covers_all(), "there always is a whole picture");
        if !laboratory.is_shown_old() {
            break;
        }
        assert_eq!((fading(&laboratory), done(&laboratory)), (1.005, 15));
        assert!(frames < 15, "the new map covers long before it is complete");
    }
    assert_eq!((fading(&laboratory), done(&laboratory)), (1.03, frames));
    follow(&mut laboratory, &session, 20);
    assert_eq!(laboratory.progress(), None);
}

#[test]
fn a_number_of_a_scaled_table_that_changes_alone_restarts() {
    let (mut session, mut laboratory) = followed(20);
    with(&mut session, |scenario| ekf(scenario).process_std[Channel::VELOCITY] *= 2.0);
    follow(&mut laboratory, &session, 20);
    let survey = laboratory.shown().unwrap();
    let [_, factor] = survey.present(session.scenario());
    assert!((factor - 1.0).abs() < 1e-12, "{factor}");
    assert_eq!(survey.ensemble.scenario().filters[0].process_std, session.scenario().filters[0].process_std);
    assert!(survey.sheet.is_complete());
}

#[test]
fn a_factor_keeps_its_base_when_something_else_changes() {
    let (mut session, mut laboratory) = followed(20);
    let moved = laboratory.shown().unwrap().with(session.scenario(), [6.0, 4.0]).unwrap();
    session.edit(&moved).unwrap();
    with(&mut session, |scenario| scenario.seed += 1);
    follow(&mut laboratory, &session, 20);
    let [_, factor] = laboratory.shown().unwrap().present(session.scenario());
    assert!((factor - 4.0).abs() < 1e-9, "the dot stays where it is: {factor}");
}

#[test]
fn it_rests_out_of_sight_or_stopped_and_continues_later() {
    let (mut session, mut laboratory) = followed(5);
    laboratory.follow(&session, false, false, &Context::default());
    assert_eq!((done(&laboratory), laboratory.is_working()), (5, false));
    follow(&mut laboratory, &session, 1);
    assert!(laboratory.set_stopped(true));
    follow(&mut laboratory, &session, 5);
    assert_eq!((done(&laboratory), laboratory.is_working()), (6, false));
    assert!(laboratory.set_stopped(false));
    follow(&mut laboratory, &session, 1);
    assert_eq!(done(&laboratory), 7);
    laboratory.set_stopped(true);
    with(&mut session, |scenario| scenario.seed += 1);
    follow(&mut laboratory, &session, 2);
    assert!(!laboratory.state.is_stopped, "another scenario begins");
}

#[test]
fn another_score_is_shown_at_once_unless_it_needs_every_estimate() {
    let (session, mut laboratory) = followed(20);
    laboratory.choose(Some(MapChoice { measure: Measure::LOG_LIKELIHOOD, ..choice() }));
    follow(&mut laboratory, &session, 1);
    assert_eq!(done(&laboratory), 15);
    laboratory.choose(Some(MapChoice { measure: Measure::VERDICT, ..choice() }));
    follow(&mut laboratory, &session, 1);
    assert_eq!(done(&laboratory), 1);
    follow(&mut laboratory, &session, 20);
    laboratory.choose(Some(choice()));
    follow(&mut laboratory, &session, 1);
    assert_eq!(done(&laboratory), 15, "what has been computed serves the other scores too");
}

#[test]
fn the_usual_map_is_of_a_guess_and_q() {
    let session = session();
    let mut laboratory = Laboratory::new(Rc::new(Frames(Budget::Pieces(1))));
    follow(&mut laboratory, &session, 1);
    let choice = laboratory.choice.as_ref().unwrap();
    let keys = choice.axes.each_ref().map(|axis| axis.key.as_str());
    assert_eq!(keys, ["filters.*.initial_mean.natural_frequency", "filters.*.process_std"]);
    assert_eq!(choice.measure, Measure::rmse(Channel::NATURAL_FREQUENCY));
    assert_eq!(choice.axes[1].spacing, Spacing::Logarithmic);
    assert!(choice.check(session.scenario()).is_ok());
}

#[test]
fn a_filter_that_is_removed_gives_way_to_another() {
    let (mut session, mut laboratory) = followed(3);
    with(&mut session, |scenario| _ = scenario.filters.remove(0));
    follow(&mut laboratory, &session, 3);
    assert_eq!(laboratory.choice.as_ref().unwrap().filter, 2);
    with(&mut session, |scenario| scenario.filters.clear());
    follow(&mut laboratory, &session, 1);
    assert!(laboratory.state.problem.as_deref().unwrap().contains("no filter") && laboratory.shown().is_none());
}

#[test]
fn an_impossible_choice_is_refused_with_a_reason() {
    let scenario = session().scenario().clone();
    let with_axis = |text: &str| {
        let [_, y] = choice().axes;
        MapChoice { axes: [Axis::parse(text).unwrap(), y], ..choice() }
    };
    for (choice, reason) in [
        (with_axis("seed=1:999:999"), "may have 256"),
        (with_axis("filters.*.mass=1:2:3"), "filters.*.mass"),
        (with_axis("filters.*.process_std.velocity=1:2:3"), "both axes"),
        (MapChoice { second: Some(7), ..choice() }, "filter number 7"),
    ] {
        let error = choice.check(&scenario).unwrap_err();
        assert!(error.contains(reason), "{error}");
    }
    assert_eq!(choice().check(&scenario), Ok(()));
}

#[test]
fn every_ready_made_scenario_has_a_map() {
    for built_in in kalmanscope_lessons::BUILT_IN {
        let session = Session::new(built_in.scenario().unwrap()).unwrap();
        let mut laboratory = Laboratory::new(Rc::new(Frames(Budget::Pieces(1))));
        follow(&mut laboratory, &session, 1);
        assert_eq!(laboratory.state.problem.as_deref(), None, "{}", built_in.title);
        // A frame is a millisecond: a cell takes some of them.
        let mut frames = 1;
        while done(&laboratory) < 2 {
            follow(&mut laboratory, &session, 1);
            assert_eq!(laboratory.edition, 1, "{}: nothing begins again", built_in.title);
            frames += 1;
            assert!(frames < 10_000, "{}", built_in.title);
        }
        let choice = laboratory.choice.as_ref().unwrap();
        if session.is_measured() {
            assert!(choice.axes.iter().all(|axis| axis.key.starts_with("filters.")), "{}", built_in.title);
            assert_eq!(choice.measure, Measure::NIS, "{}", built_in.title);
        }
        let [x, y] = laboratory.shown().unwrap().present(session.scenario());
        assert!(x.is_finite() && y.is_finite(), "{}: there is a dot", built_in.title);
    }
}

#[test]
fn a_record_that_is_too_long_has_no_map() {
    let long = Scenario { duration: 3600.0, ..Scenario::default() };
    let session = Session::new(long).unwrap();
    let mut laboratory = slow();
    follow(&mut laboratory, &session, 2);
    let problem = laboratory.state.problem.as_deref().unwrap();
    assert!(problem.contains("360001 samples") && laboratory.shown().is_none(), "{problem}");
}

#[test]
fn a_map_varies_the_gain_of_a_measured_input_and_stays_as_the_dot_moves() {
    let built_in = kalmanscope_lessons::BUILT_IN.iter().map(|built_in| built_in.scenario().unwrap());
    let is_driven = |scenario: &Scenario| scenario.record.as_ref().is_some_and(|mapping| mapping.input.is_some());
    let scenarios: Vec<Scenario> = built_in.filter(is_driven).collect();
    assert!(!scenarios.is_empty());
    for scenario in scenarios {
        let mut session = Session::new(scenario).unwrap();
        session.set_mode(Mode::Whole);
        let gain = |session: &Session| session.scenario().record.as_ref().unwrap().input.as_ref().unwrap().gain;
        let own = gain(&session);
        let axis = |text: &str| Axis::parse(text).unwrap();
        let across = axis(&format!("record.input.gain={}:{}:3:log", 0.5 * own, 2.0 * own));
        let axes = [across, axis("filters.*.process_std=0.5:2:3:log")];
        assert!(candidates(session.scenario(), true).contains(&axes[0].key), "the menu offers it");
        let usual = MapChoice::usual(session.scenario(), session.run().record(), true, 3).unwrap();
        let mut laboratory = Laboratory::new(Rc::new(Frames(Budget::Unlimited)));
        laboratory.choose(Some(MapChoice { axes, measure: Measure::NIS, ..usual }));
        follow(&mut laboratory, &session, 20);
        assert_eq!((laboratory.state.problem.as_deref(), done(&laboratory)), (None, 9));
        let opened = laboratory.shown().unwrap().with(session.scenario(), [0.5 * own, 2.0]).unwrap();
        session.edit(&opened).unwrap();
        assert_eq!(gain(&session), 0.5 * own);
        follow(&mut laboratory, &session, 2);
        let survey = laboratory.shown().unwrap();
        assert_eq!((survey.sheet.done(), laboratory.is_working()), (9, false), "nothing begins again");
        assert_eq!(survey.present(session.scenario())[0], 0.5 * own);
    }
}

#[test]
fn a_map_of_a_growing_record_is_of_one_length() {
    let circuit = kalmanscope_lessons::BuiltIn::named("circuit").unwrap().scenario().unwrap();
    let measured = Session::new(circuit.clone()).unwrap();
    let record = measured.run().record().clone();
    let mut scenario = circuit;
    scenario.record.as_mut().unwrap().file = "measured now".to_owned();
    scenario.record.as_mut().unwrap().hash = String::new();
    let part = |length: usize| std::sync::Arc::new(record.part(0..length));
    let mut session = Session::new(Scenario::default()).unwrap();
    session.follow_live(scenario, part(200));
    session.advance(0.0);
    assert!(session.is_live());
    let usual = MapChoice::usual(session.scenario(), session.run().record(), true, 3).unwrap();
    let mut laboratory = Laboratory::new(Rc::new(Frames(Budget::Unlimited)));
    laboratory.choose(Some(usual));
    let mut editions = Vec::new();
    for length in [200, 220, 249, 250, 300] {
        session.lengthen(part(length));
        assert_eq!(session.run().record().len(), length);
        follow(&mut laboratory, &session, 20);
        assert_eq!(laboratory.state.problem.as_deref(), None);
        assert!(laboratory.shown().unwrap().sheet.is_complete(), "{length} samples");
        editions.push(laboratory.edition);
    }
    editions.dedup();
    assert!((2..=3).contains(&editions.len()), "it begins again at 250 samples alone: {editions:?}");
}

#[test]
fn a_map_of_a_filter_by_its_name_stays_when_that_changes() {
    let mut session = session();
    let mut laboratory = Laboratory::new(Rc::new(Frames(Budget::Unlimited)));
    let axes = ["filters.UKF.fading=1:1.1:3", "filters.*.process_std=0.1:10:3:log"];
    let axes = axes.map(|text| Axis::parse(text).unwrap());
    let chosen = MapChoice { axes, second: Some(1), filter: 2, ..choice() };
    chosen.check(session.scenario()).unwrap();
    laboratory.choose(Some(chosen));
    follow(&mut laboratory, &session, 2);
    let edition = laboratory.edition;
    assert_eq!((laboratory.state.problem.as_deref(), done(&laboratory)), (None, 9));
    with(&mut session, |scenario| scenario.filters[1].name = "Mine".to_owned());
    session.advance(0.0);
    follow(&mut laboratory, &session, 2);
    assert_eq!((laboratory.edition, laboratory.is_working()), (edition, false), "nothing begins again");
    assert_eq!(laboratory.choice.as_ref().unwrap().axes[0].key, "filters#2.fading");
    let table = laboratory.shown().unwrap().to_csv();
    assert!(table.starts_with("filters.Mine.fading,filters.*.process_std,Mine."), "{table}");
    let both = ["filters.UKF.fading=1:1.1:3", "filters#2.fading=1:1.2:3"].map(|text| Axis::parse(text).unwrap());
    let chosen = MapChoice { axes: both, filter: 2, ..choice() };
    let problem = chosen.check(self::session().scenario()).unwrap_err();
    assert!(problem.contains("both axes of the map set `filters.UKF.fading`"), "{problem}");
}
