//! The screen of a lesson's step.

use super::*;

fn click(screen: &mut Screen, label: &str) {
    screen.get_by_label(label).click();
    screen.run_steps(4);
}

fn lesson(size: Vec2, title: &str) -> Screen {
    let mut screen = screen(size, Theme::Light);
    click(&mut screen, "Lessons");
    click(&mut screen, title);
    screen
}

fn shown(screen: &Screen, plots: &[&str]) -> Vec<bool> {
    plots.iter().map(|plot| screen.query_by_label(&format!("Plot of the {plot}")).is_some()).collect()
}

#[test]
fn a_step_shows_the_part_of_the_record_that_it_is_about_and_stands_still() {
    let mut screen = lesson(DESKTOP, "Noise reduction");
    let (from, to) = screen.state().axis().framed.expect("the step is about a moment");
    assert!(to - from < 1.0);
    assert!(!screen.state().session().playing());
    assert_eq!(screen.state().session().time(), to);
    click(&mut screen, "Leave the lesson");
    assert_eq!(screen.state().axis().framed, None);
}

#[test]
fn a_step_shows_the_channels_that_it_is_about_until_all_are_wanted() {
    let mut screen = lesson(DESKTOP, "Noise reduction");
    let plots = ["displacement", "velocity", "error of the displacement", "error of the natural frequency"];
    assert_eq!(shown(&screen, &plots), [true, false, true, false]);
    click(&mut screen, "only x ×");
    assert_eq!(shown(&screen, &plots), [true; 4]);
    click(&mut screen, "Next");
    assert_eq!(shown(&screen, &plots), [true, false, true, false]);
    click(&mut screen, "Leave the lesson");
    assert_eq!(shown(&screen, &plots), [true; 4]);
}

#[test]
fn a_frame_without_an_end_reaches_as_far_as_the_record() {
    let mut screen = lesson(DESKTOP, "Recursive estimation");
    click(&mut screen, "Next");
    assert_eq!(screen.state().axis().framed, Some((5.0, 30.0)));
    click(&mut screen, "Record for 60 s instead of 30 s");
    assert_eq!(screen.state().axis().framed, Some((5.0, 60.0)));
}

#[test]
fn single_steps_are_the_users() {
    let mut screen = lesson(DESKTOP, "Predict and update, step by step");
    screen.run_steps(60);
    assert_eq!((screen.state().session().time(), screen.state().session().playing()), (0.0, false));
    screen.key_press(Key::ArrowRight);
    screen.run_steps(3);
    assert_eq!(screen.state().session().position(), 1);
    let (from, to) = screen.state().axis().followed(screen.state().session());
    assert!(from == 0.0 && to < 0.2, "{to}");
    click(&mut screen, "Next");
    assert!(screen.state().session().playing(), "the next step is played");
}

#[test]
fn a_lesson_has_the_room_of_the_settings_unless_they_are_wanted() {
    let mut screen = lesson(DESKTOP, "Fading memory and a sudden loss");
    assert!(screen.query_by_label("Truth").is_none());
    click(&mut screen, "Settings");
    screen.run_steps(20);
    assert!(screen.query_by_label("Truth").is_some());
    let wide = lesson(Vec2::new(1700.0, 900.0), "Fading memory and a sudden loss");
    assert!(wide.query_by_label("Truth").is_some());
}

#[test]
fn known_channels_have_no_chart_of_errors() {
    let screen = lesson(DESKTOP, "Sensitivity to assumptions");
    let plots = ["error of the displacement", "error of the natural frequency"];
    assert_eq!(shown(&screen, &plots), [true, false]);
}

#[test]
fn on_a_phone_the_views_are_in_the_order_of_the_step() {
    let screen = lesson(PHONE, "Computational cost");
    let top = |view: &str| screen.get_by_label(&format!("About {view}")).rect().top();
    assert!(top("Errors") < top("States"));
}
