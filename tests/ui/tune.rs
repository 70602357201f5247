//! Tuning: a search on screen, its result, and taking it.

use kalmanscope_core::{Pass, Run};

use super::*;

fn tune() -> Screen {
    let mut screen = screen(DESKTOP, Theme::Light);
    *screen.state_mut().layout_mut() = ViewLayout::column(&[ViewKind::Tune]);
    let mut wrong = Scenario { duration: 10.0, ..Scenario::default() };
    wrong.filters[0].sensor_std.iter_mut().for_each(|std| *std *= 5.0);
    show_whole(&mut screen, wrong);
    screen.run_steps(90);
    screen
}

fn likelihood(scenario: &Scenario) -> f64 {
    let mut run = Run::new(scenario).expect("it is possible");
    run.finish();
    let mut scores = kalmanscope_core::Scores::new(&Pass::history(scenario, 0).expect("it is possible"), run.record());
    let mut pass = Pass::new(scenario, 0, run.record()).expect("it is possible");
    pass.follow(run.record(), run.record().len(), &mut scores.against(run.record()));
    scores.outcome().log_likelihood
}

#[test]
fn tuning_improves_the_likelihood_and_is_taken_and_undone_in_one_step() {
    let mut screen = tune();
    let before = scenario(&screen).clone();
    click(&mut screen, "Tune");
    assert!(screen.query_by_label("Plot of the path of the search").is_some());
    screen.get_by_label("Use these values").click();
    screen.run_steps(90);
    let after = scenario(&screen).clone();
    assert!(likelihood(&after) > likelihood(&before) + 100.0);
    let (true_std, _) = after.true_noise();
    for (tuned, truth) in after.filters[0].sensor_std.iter().zip(true_std) {
        assert!((0.8..1.25).contains(&(tuned / truth)), "{tuned} instead of {truth}");
    }
    assert_eq!(after.filters[1], before.filters[1]);
    assert!(screen.query_by_label("These values are in use.").is_some());
    click(&mut screen, "Undo");
    assert_eq!(scenario(&screen), &before);
    assert!(screen.query_by_label("Use these values").is_some(), "they can be taken again");
}

#[test]
fn another_change_makes_the_result_old() {
    let mut screen = tune();
    click(&mut screen, "Tune");
    set(&mut screen, "EKF fading factor", 1.02);
    assert!(screen.query_by_label("Use these values").is_none());
    assert!(screen.query_by_label_contains("tune again").is_some());
}

#[test]
fn a_search_and_its_result_survive_a_new_name() {
    let mut screen = tune();
    let call = |screen: &mut Screen, name: &str| {
        let mut renamed = scenario(screen).clone();
        name.clone_into(&mut renamed.filters[0].name);
        set_scenario(screen, renamed);
    };
    screen.state_mut().session_mut().set_budget(Budget::Pieces(4));
    click(&mut screen, "Tune");
    assert!(screen.query_by_label("Stop tuning").is_some(), "the search goes on");
    call(&mut screen, "first");
    assert!(screen.query_by_label("Stop tuning").is_some(), "the search goes on");
    screen.state_mut().session_mut().set_budget(Budget::Unlimited);
    screen.run_steps(4);
    call(&mut screen, "second");
    click(&mut screen, "Use these values");
    assert_eq!(scenario(&screen).filters[0].name, "second");
    assert!(screen.query_by_label("These values are in use.").is_some());
}
