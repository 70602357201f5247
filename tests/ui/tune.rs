//! Tuning: a search on screen, its result, and taking it.

use kalmanscope_core::{Pass, Run};

use super::*;

/// A paused screen of a record whose first filter takes its sensors for five times noisier than they are.
fn tune(size: Vec2, theme: Theme) -> Screen {
    let mut screen = super::screen(size, theme);
    *screen.state_mut().layout_mut() = Layout::column(&[ViewKind::Tune]);
    let mut wrong = Scenario { duration: 10.0, ..Scenario::default() };
    wrong.filters[0].sensor_std.iter_mut().for_each(|std| *std *= 5.0);
    let session = screen.state_mut().session_mut();
    session.set_scenario(wrong);
    session.set_mode(Mode::Whole);
    session.pause();
    screen.run_steps(90);
    screen
}

/// The log likelihood of the first filter's run over the whole record.
fn likelihood(scenario: &Scenario) -> f64 {
    let mut run = Run::new(scenario).expect("it is possible");
    run.finish();
    let mut scores = kalmanscope_core::Scores::new(&Pass::history(scenario, 0).expect("it is possible"), run.record());
    let mut pass = Pass::new(scenario, 0, run.record()).expect("it is possible");
    pass.follow(run.record(), run.record().len(), &mut scores.against(run.record()));
    scores.log_likelihood()
}

#[test]
fn tuning_improves_the_likelihood_and_is_taken_and_undone_in_one_step() {
    let mut screen = tune(DESKTOP, Theme::Light);
    let before = scenario(&screen).clone();
    screen.get_by_label("Tune").click();
    screen.run_steps(4);
    assert!(screen.query_by_label("Path of the search").is_some());
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
    screen.get_by_label("Undo").click();
    screen.run_steps(4);
    assert_eq!(scenario(&screen), &before);
    assert!(screen.query_by_label("Use these values").is_some(), "they can be taken again");
}

#[test]
fn another_change_makes_the_result_old() {
    let mut screen = tune(DESKTOP, Theme::Light);
    screen.get_by_label("Tune").click();
    screen.run_steps(4);
    set(&mut screen, "EKF fading factor", 1.02);
    assert!(screen.query_by_label("Use these values").is_none());
    assert!(screen.query_by_label_contains("tune again").is_some());
}
