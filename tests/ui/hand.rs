//! Gestures of a user who points at a time, compares pictures, drags settings in plots, and undoes.

use super::marks::marks;
use super::*;

pub(super) fn whole() -> Screen {
    let mut screen = screen(DESKTOP, Theme::Light);
    let session = screen.state_mut().session_mut();
    session.set_mode(Mode::Whole);
    session.pause();
    session.seek(20.0);
    screen.run_steps(3);
    screen
}

/// A position in the plot of the natural frequency, by the share of its width.
pub(super) fn in_plot(screen: &Screen, share: f32) -> egui::Pos2 {
    let rect = screen.get_by_label("Plot of the natural frequency").rect();
    egui::pos2(rect.left() + share * rect.width(), rect.center().y)
}

pub(super) fn click_at(screen: &mut Screen, at: egui::Pos2, modifiers: Modifiers) {
    screen.hover_at(at);
    // Long enough after any earlier click.
    screen.run_steps(60);
    for pressed in [true, false] {
        let button = egui::PointerButton::Primary;
        screen.event_modifiers(egui::Event::PointerButton { pos: at, button, pressed, modifiers }, modifiers);
        screen.run_steps(2);
    }
    screen.run_steps(2);
}

#[test]
fn a_natural_frequency_is_told_in_hertz_too() {
    let mut screen = whole();
    // Where there is no room for it, the pointer tells it.
    assert!(screen.query_by_label_contains("Hz)").is_none());
    let value = screen.get_by_label("6.000").rect().center();
    screen.hover_at(value);
    screen.run_steps(60);
    screen.get_by_label("truth: 6.000 (0.9549 Hz)");
    *screen.state_mut().layout_mut() = ViewLayout::column(&[ViewKind::Parameters]);
    screen.set_size(Vec2::new(2200.0, 800.0));
    screen.run_steps(3);
    screen.get_by_label("6.000 (0.9549 Hz)");
}

#[test]
fn a_click_in_a_plot_goes_to_that_time() {
    let mut screen = whole();
    let time = |screen: &Screen| screen.state().session().time();
    // Above the curves after the change: a click on one opens its filter.
    let plot = screen.get_by_label("Plot of the natural frequency").rect();
    let at = plot.lerp_inside(egui::vec2(0.75, 0.4));
    click_at(&mut screen, at, Modifiers::NONE);
    assert!((time(&screen) - 45.0).abs() < 3.0, "{}", time(&screen));
    assert_eq!(marks(&screen), [None, None]);
}

#[test]
fn the_picture_before_a_change_stays_until_it_is_forgotten() {
    let mut screen = whole();
    assert!(screen.query_by_label_contains("before:").is_none());
    let before = screen.state().session().run().estimates()[0].checksum();
    for value in [1.02, 1.03] {
        set(&mut screen, "EKF fading factor", value);
    }
    let of_session = screen.state().session().before().expect("there is a picture from before");
    assert_eq!(of_session.words, "EKF λ = 1.005");
    assert_eq!(of_session.estimates(1).expect("the EKF").checksum(), before);
    assert!(of_session.estimates(2).is_none(), "the UKF has not changed");
    screen.get_by_label_contains("before: EKF λ = 1.005").click();
    screen.run_steps(2);
    assert!(screen.state().session().before().is_none());
}

#[test]
fn settings_are_swapped_with_a_snapshot() {
    let mut screen = whole();
    let fading = |screen: &Screen| scenario(screen).filters[0].fading;
    press(&mut screen, Key::X);
    set(&mut screen, "EKF fading factor", 1.05);
    assert!(screen.query_by_label_contains("before: snapshot: EKF λ = 1.005").is_some());
    press(&mut screen, Key::X);
    assert_eq!(fading(&screen), 1.005);
    assert!(screen.query_by_label_contains("before: snapshot: EKF λ = 1.05").is_some());
    click(&mut screen, "Snapshot");
    assert_eq!(fading(&screen), 1.05);
}

#[test]
fn help_opens_on_a_tap() {
    let mut screen = whole();
    let first = view(ViewKind::Parameters).help[0];
    click(&mut screen, "About Parameters");
    assert!(screen.query_by_label(first).is_some());
}

#[test]
fn keys_work_while_a_button_has_the_focus() {
    let mut screen = whole();
    screen.get_by_label("Live").focus();
    screen.run_steps(2);
    assert_eq!(screen.state().session().mode(), Mode::Whole);
    press(&mut screen, Key::L);
    assert_eq!(screen.state().session().mode(), Mode::Live);
}

#[test]
fn a_sudden_change_is_dragged_where_it_is_seen() {
    let mut screen = whole();
    let step = |screen: &Screen| match scenario(screen).plant.parameter(Channel::NATURAL_FREQUENCY) {
        Some(Signal::Step(step)) => step,
        other => panic!("{other:?}"),
    };
    let before = step(&screen);
    let handle = screen.get_by_label("time and size of the change of the natural frequency").rect().center();
    drag(&mut screen, handle, egui::vec2(60.0, -40.0));
    let after = step(&screen);
    assert!(after.at > before.at + 2.0 && after.to > before.to + 0.1, "{before:?} {after:?}");
    assert_eq!(after.from, before.from);
    assert!(screen.state().axis().follows, "the axes follow again");
}

#[test]
fn a_guess_is_dragged_at_the_beginning() {
    let mut screen = workbench();
    screen.state_mut().session_mut().pause();
    set_scenario(&mut screen, Scenario::default());
    screen.state_mut().session_mut().seek(0.1);
    screen.run_steps(4);
    // Both guesses are alike, and the second filter's handle is above the first one's.
    let guess = |screen: &Screen| scenario(screen).filters[1].initial_mean[Channel::NATURAL_FREQUENCY];
    let before = guess(&screen);
    let handle = screen.get_by_label("UKF's guess of the natural frequency").rect().center();
    drag(&mut screen, handle, egui::vec2(0.0, -15.0));
    assert!(guess(&screen) > before, "{}", guess(&screen));
}

/// The table of filters, where one filter differs in one number.
fn side_by_side() -> Screen {
    let mut screen = whole();
    show(&mut screen, &[ViewKind::Filters]);
    set(&mut screen, "UKF: process std of natural frequency", 0.003);
    screen
}

#[test]
fn page_keys_go_from_view_to_view() {
    let mut screen = whole();
    let about = |view: ViewKind| format!("About {}", kalmanscope::views::view(view).name);
    let shown = |screen: &Screen| {
        ViewKind::ALL.into_iter().filter(|kind| screen.query_by_label(&about(*kind)).is_some()).collect::<Vec<_>>()
    };
    let all = shown(&screen);
    assert_eq!(all.len(), 3);
    for expected in all.iter().map(|kind| vec![*kind]).chain([all.clone()]) {
        press(&mut screen, Key::PageDown);
        assert_eq!(shown(&screen), expected);
    }
    press(&mut screen, Key::PageUp);
    assert_eq!(shown(&screen), [all[2]]);
}

#[test]
fn a_number_beyond_its_limit_says_so_for_a_moment() {
    let mut screen = workbench();
    set(&mut screen, "Sampling time", 1e-9);
    assert_eq!(scenario(&screen).dt, 0.002);
    assert!(screen.query_by_label("at least 0.002 s").is_some());
    screen.run_steps(5 * 60);
    assert!(screen.query_by_label("at least 0.002 s").is_none());
}

#[test]
fn a_stranger_sees_something_happen_within_five_seconds() {
    let mut screen = started(DESKTOP, Theme::Light, |app, _| app);
    screen.state_mut().session_mut().set_budget(Budget::Unlimited);
    screen.run_steps(5 * 60);
    let session = screen.state().session();
    let Some(Signal::Step(step)) = session.scenario().plant.parameter(Channel::NATURAL_FREQUENCY) else {
        panic!("the first screen shows a sudden change");
    };
    assert!(session.time() > step.at + 1.0, "{} s", session.time());
    let last = session.index();
    let estimate = |filter: usize| session.run().estimates()[filter].canonical_mean(last, 2);
    assert!(estimate(1) - estimate(0) > 0.3, "the filters go apart: {} {}", estimate(0), estimate(1));
    // At the end the change is still in sight.
    screen.run_steps(20 * 60);
    let session = screen.state().session();
    assert!(!session.playing() && screen.state().axis().followed(session).0 < step.at);
}

#[test]
fn where_no_view_is_shown_arrangements_are_offered() {
    let mut screen = whole();
    for kind in [ViewKind::Oscillator, ViewKind::Parameters, ViewKind::States] {
        screen.state_mut().layout_mut().toggle(kind);
    }
    screen.run_steps(3);
    click(&mut screen, "Compare");
    assert!(screen.query_by_label("About Scores").is_some());
}

#[test]
fn a_number_dropped_on_another_filters_makes_it_the_same() {
    let mut screen = side_by_side();
    let before = scenario(&screen).filters[0].clone();
    let place = |screen: &Screen, label: &str| screen.get_by_label(label).rect().center();
    let from = place(&screen, "Same as UKF: process std of natural frequency");
    // A number of another row stays as it is.
    let wrong = place(&screen, "EKF: fading factor");
    drag(&mut screen, from, wrong - from);
    assert_eq!(scenario(&screen).filters[0], before);
    let to = place(&screen, "EKF: process std of natural frequency");
    drag(&mut screen, from, to - from);
    let mut expected = before;
    expected.process_std[Channel::NATURAL_FREQUENCY] = 0.003;
    assert_eq!(scenario(&screen).filters[0], expected);
}

#[test]
fn a_measured_scenario_shows_what_was_measured() {
    let mut screen = screen(DESKTOP, Theme::Light);
    click(&mut screen, "Scenario");
    click(&mut screen, "Measured: a circuit");
    assert!(screen.query_by_label("About Measured and predicted").is_some());
    assert!(screen.query_by_label("About Parameters").is_some(), "the other views stay");
}

#[test]
fn a_record_in_volts_has_no_metres_in_any_view() {
    let circuit = kalmanscope_lessons::BUILT_IN.iter().find(|entry| entry.title == "Measured: a circuit");
    let scenario = circuit.expect("it is built in").scenario().expect("it can be read");
    let mut screen = screen(Vec2::new(1280.0, 1600.0), Theme::Light);
    show_whole(&mut screen, scenario);
    screen.run_steps(20);
    for kind in ViewKind::ALL {
        show(&mut screen, &[kind]);
        for metres in ["[m]", "[m/s]", "[m/s²]", " m/s"] {
            let label = screen.query_all_by_label_contains(metres).next().map(|node| format!("{node:?}"));
            assert_eq!(label, None, "{}", view(kind).name);
        }
    }
    show(&mut screen, &[ViewKind::Matrices]);
    assert!(screen.query_all_by_label("V").next().is_some(), "e is in volts");
}

#[test]
fn a_message_about_something_done_goes_by_itself() {
    let mut screen = screen(DESKTOP, Theme::Light);
    screen.state_mut().session_mut().pause();
    press(&mut screen, Key::C);
    assert!(screen.state().notice().is_some_and(|notice| notice.contains("clipboard")));
    screen.run_steps(60 * 7);
    assert!(screen.state().notice().is_some(), "there is time to read it");
    screen.run_steps(60 * 2);
    assert_eq!(screen.state().notice(), None);
}
