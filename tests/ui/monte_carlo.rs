//! Monte Carlo: the statistics of many seeds on screen.

use std::rc::Rc;

use kalmanscope::laboratory::SeedChoice;
use kalmanscope::team::Frames;
use kalmanscope_core::Source;
use kalmanscope_core::scenario::Law;
use kalmanscope_lab::{MonteCarlo, RunVerdicts, Runner, Slice};

use super::*;

fn monte_carlo(scenario: Scenario, seeds: usize) -> Screen {
    let team = Rc::new(Frames(Budget::Unlimited));
    let mut screen = started(DESKTOP, Theme::Light, |app, _| app.working_with(team));
    *screen.state_mut().layout_mut() = ViewLayout::column(&[ViewKind::MonteCarlo]);
    show_whole(&mut screen, scenario);
    screen.state_mut().session_mut().seek(5.0);
    screen.state_mut().laboratory.seeds.choose(SeedChoice { seeds, ..SeedChoice::default() });
    screen.run_steps(5);
    screen
}

fn short() -> Scenario {
    Scenario { duration: 5.0, ..Scenario::default() }
}

#[test]
fn the_statistics_are_those_of_the_seeds_run_alone() {
    let screen = monte_carlo(short(), 30);
    let seeds = &screen.state().laboratory.seeds;
    assert_eq!((seeds.progress(), seeds.state.problem.as_deref()), (None, None));
    let shown = &seeds.shown().expect("there are some").statistics;
    let ensemble =
        MonteCarlo::ensemble(scenario(&screen).clone(), vec![0, 1], 30, shown.samples().len(), RunVerdicts::Not);
    let ensemble = ensemble.expect("it is possible");
    let runner = Runner::new(ensemble.clone(), Source::Simulated).expect("it is possible");
    let mut expected = MonteCarlo::new(&ensemble);
    for seed in 0..30 {
        expected.take(&ensemble, &Slice { cells: vec![seed], rows: runner.rows(&[seed]) });
    }
    assert_eq!(shown.done(), 30);
    for nth in [0, 1] {
        assert!(shown.nees(nth).eq(expected.nees(nth)) && shown.nis(nth).eq(expected.nis(nth)));
        assert_eq!(shown.finals(nth, 2), expected.finals(nth, 2));
        assert_eq!(shown.diverged(nth), expected.diverged(nth));
    }
    for label in ["Plot of the mean NEES", "Plot of the mean NIS"] {
        assert!(screen.query_by_label(label).is_some(), "{label}");
    }
    assert!(screen.query_by_label_contains("Plot of the error of ωₙ").is_some());
    assert!(screen.query_by_label_contains("Plot of the last estimate of ωₙ").is_some());
    assert!(screen.query_by_label_contains("30 seeds").is_some());
}

#[test]
fn seeds_and_parameter_are_chosen_and_the_pointer_shows_numbers() {
    let mut screen = monte_carlo(short(), 12);
    set(&mut screen, "Seeds", 20.0);
    assert_eq!(screen.state().laboratory.seeds.shown().expect("there are some").statistics.done(), 20);
    choose(&mut screen, "Parameter of the errors", "ζ, damping ratio");
    assert!(screen.query_by_label_contains("Plot of the error of ζ").is_some());
    let chart = screen.get_by_label("Plot of the mean NIS").rect();
    screen.hover_at(chart.center());
    screen.run_steps(40);
    assert!(screen.query_by_label_contains("s, 20 seeds").is_some());
    assert_eq!(screen.query_all_by_label_contains(", 95 % in ").count(), 2, "a line for each filter");
}

#[test]
fn a_filter_that_is_hidden_is_not_run() {
    let mut screen = monte_carlo(short(), 12);
    press(&mut screen, Key::Num1);
    let runs = screen.state().laboratory.seeds.shown().expect("there are some");
    assert_eq!((&runs.filters[..], runs.statistics.done()), (&[2][..], 12));
}

#[test]
fn a_measured_record_has_one_noise() {
    let mut screen = monte_carlo(short(), 12);
    let mut scenarios = kalmanscope_lessons::BUILT_IN.iter().filter_map(|built_in| built_in.scenario().ok());
    let measured = scenarios.find(|scenario| scenario.record.is_some()).expect("there is one");
    set_scenario(&mut screen, measured);
    assert!(screen.state().session().is_measured());
    assert!(screen.query_by_label_contains("This record is measured").is_some());
}

#[test]
fn a_population_is_drawn_in_the_view() {
    let mut drawn = short();
    drawn.draw.insert("plant.natural_frequency".to_owned(), Law::Lognormal([6.0, 0.2]));
    let screen = monte_carlo(drawn, 30);
    assert!(screen.query_by_label_contains("drawn: true ωₙ lognormal (6, 0.2)").is_some());
    assert!(screen.query_by_label_contains("Plot of the last error of ωₙ").is_some());
    assert_eq!(screen.query_all_by_label_contains("ωₙ within 1 %: ").count(), 2);
    let statistics = screen.state().laboratory.seeds.shown().expect("there are some").statistics.clone();
    let truths: Vec<f64> = statistics.last_errors(0, 2).iter().map(|last| last.truth).collect();
    assert!(truths.iter().any(|truth| (truth - truths[0]).abs() > 0.5), "{truths:?}");
}

#[test]
fn each_run_gets_its_verdict_if_one_wants_it() {
    let mut screen = monte_carlo(short(), 12);
    let verdicts = |screen: &Screen| -> usize {
        screen.state().laboratory.seeds.shown().expect("there are some").statistics.verdicts(0).iter().sum()
    };
    assert_eq!(verdicts(&screen), 0);
    click(&mut screen, "verdicts");
    screen.run_steps(5);
    assert_eq!(verdicts(&screen), 12);
    assert!(screen.query_all_by_label_contains("100 % ").count() >= 1);
}

#[test]
fn the_causes_of_bad_verdicts_are_counted() {
    let text = include_str!("../../assets/populations/input-gain.toml");
    let wrong = Scenario { duration: 20.0, ..Scenario::from_toml(text).expect("it is a scenario") };
    let mut screen = monte_carlo(wrong, 10);
    click(&mut screen, "causes");
    screen.run_steps(5);
    let choice = screen.state().laboratory.seeds.choice;
    assert!(choice.causes && choice.verdicts);
    let statistics = screen.state().laboratory.seeds.shown().expect("there are some").statistics.clone();
    let named: usize = statistics.causes(0).0.iter().sum();
    assert!(named >= 8, "{named} of 10");
    assert!(screen.query_by_label_contains("causes of bad verdicts: 1").is_some(), "100 % of one cause");
    // Without verdicts there are no causes.
    click(&mut screen, "verdicts");
    screen.run_steps(5);
    assert!(!screen.state().laboratory.seeds.choice.causes);
    assert!(screen.query_by_label_contains("causes of bad verdicts").is_none());
}
