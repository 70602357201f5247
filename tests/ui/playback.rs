//! Playback, the common time axis, built-in scenarios and saved sessions.

use super::*;

/// The scale eases, but not while a mass is beyond its end: after a jump, or where frames are slow.
#[test]
fn the_mass_stays_in_its_drawing() {
    let mut screen = started(DESKTOP, Theme::Light, |app, _| app);
    screen.ctx.all_styles_mut(|style| style.animation_time = 0.1);
    let session = screen.state_mut().session_mut();
    session.set_budget(Budget::Unlimited);
    session.play_from_start();
    for time in [0.0, 0.41, 1.0, 15.0] {
        screen.state_mut().session_mut().seek(time);
        screen.run_steps(2);
        let picture = screen.get_by_label_contains("The oscillator: springs").rect();
        let slices: Vec<_> = screen.get_all_by_label_contains("on the mass").map(|slice| slice.rect()).collect();
        assert!(slices.iter().all(|slice| picture.contains_rect(*slice)), "at {time} s: {slices:?} in {picture}");
    }
}

#[test]
fn the_transport_buttons_work() {
    let mut screen = screen(DESKTOP, Theme::Dark);
    let position = |screen: &Screen| screen.state().session().position();
    let begin = position(&screen);
    screen.run_steps(30);
    assert!(
        position(&screen) > begin + 50,
        "it plays by itself, {} samples in half a second",
        position(&screen) - begin
    );
    click(&mut screen, "Pause");
    let paused = position(&screen);
    screen.run_steps(10);
    assert_eq!(position(&screen), paused);
    click(&mut screen, "Step");
    assert_eq!(position(&screen), paused + 1);
    press(&mut screen, Key::ArrowRight);
    assert_eq!(position(&screen), paused + 2);
    set(&mut screen, "Time", 20.0);
    assert_eq!(position(&screen), 2000);
    assert_eq!(screen.state().session().run().len(), 2001);
    click(&mut screen, "Whole record");
    assert_eq!(screen.state().session().run().len(), 6001);
    // At the end it begins again.
    set(&mut screen, "Time", 60.0);
    click(&mut screen, "Play");
    assert!(position(&screen) < 1000);
    click(&mut screen, "Pause");
    click(&mut screen, "Restart");
    assert_eq!(position(&screen), 0);
    click(&mut screen, "Live");
    assert_eq!(screen.state().session().run().len(), 1);
    choose(&mut screen, "Speed", "10×");
    assert_eq!(screen.state().session().speed(), 10.0);
}

const KEY: &str = "kalmanscope";

fn edited() -> (App, Memory) {
    let mut edited = Scenario { seed: 5, force: Force::None, ..Scenario::default() };
    edited.plant.set(Channel::NATURAL_FREQUENCY, Signal::Constant(3.0));
    edited.add_sensor(kalmanscope_core::Sensor::new(Quantity::ACCELERATION, 0.2));
    let mut app = App::with_scenario(edited).expect("the scenario can be run");
    app.session_mut().set_mode(Mode::Whole);
    app.session_mut().set_speed(5.0);
    app.layout_mut().toggle(ViewKind::Gain);
    let mut memory = Memory::default();
    app.save(&mut memory);
    (app, memory)
}

#[test]
fn settings_survive() {
    let (mut app, memory) = edited();
    let mut restored = restored(&memory);
    assert_eq!(restored.layout_mut().shown(), app.layout_mut().shown());
    let session = restored.session();
    assert_eq!((session.scenario(), session.mode(), session.speed()), (app.session().scenario(), Mode::Whole, 5.0));
    assert_eq!(restored.notice(), None);
}

#[test]
fn a_choice_about_a_filter_that_is_gone_does_not_make_the_session_unreadable() {
    let mut screen = screen(DESKTOP, Theme::Light);
    show(&mut screen, &[ViewKind::Tune, ViewKind::Map]);
    *screen.state_mut().layout_mut() = ViewLayout::column(&[ViewKind::States]);
    let mut fewer = scenario(&screen).clone();
    fewer.filters.remove(0);
    set_scenario(&mut screen, fewer.clone());
    let restored = restored(&saved(&mut screen));
    assert_eq!((restored.notice(), restored.session().scenario()), (None, &fewer));
}

#[test]
fn a_session_that_cannot_be_read_is_reported_until_dismissed_and_kept() {
    let broken = edited().1.0[KEY].replacen("dt = 0.01", "dt = -1.0", 1);
    let mut memory = Memory::default();
    memory.set_string(KEY, broken.clone());
    let mut screen = reloaded(&memory, |app, _| app);
    let notice = screen.state().notice().expect("it is said");
    assert!(notice.contains("The last session cannot be opened: ") && notice.contains("`dt` is -1"), "{notice}");
    assert!(notice.contains("kalmanscope-unreadable"), "{notice}");
    click(&mut screen, "Dismiss");
    assert_eq!(screen.state().notice(), None);
    screen.state_mut().save(&mut memory);
    assert_eq!(memory.0["kalmanscope-unreadable"], broken);
    assert_eq!(restored(&memory).notice(), None, "what is saved now can be read");
}

#[test]
fn a_paused_screen_comes_to_rest() {
    let mut screen = screen(DESKTOP, Theme::Light);
    click(&mut screen, "Pause");
    screen.hover_at(egui::pos2(600.0, 400.0));
    screen.run_steps(3);
    screen.remove_cursor();
    assert!(screen.try_run().is_ok(), "nothing moves, but frame after frame is drawn");
}

#[test]
fn pointing_and_zooming_work() {
    let mut screen = screen(DESKTOP, Theme::Light);
    let session = screen.state_mut().session_mut();
    session.toggle_play();
    session.seek(20.0);
    screen.run_steps(3);
    let plot = screen.get_by_label("Plot of the displacement").rect();
    screen.hover_at(plot.center());
    screen.run_steps(3);
    let pointed = screen.state().axis().pointed.expect("the user points at a plot");
    assert!((5.0..15.0).contains(&pointed), "{pointed} s is not in the middle of the plot");
    screen.drag_at(plot.center());
    screen.run_steps(2);
    screen.hover_at(plot.center() + Vec2::new(80.0, 30.0));
    screen.run_steps(2);
    screen.drop_at(plot.center() + Vec2::new(80.0, 30.0));
    screen.run_steps(3);
    assert!(!screen.state().axis().follows, "a dragged axis stays where it is put");
    click(&mut screen, "Restart");
    assert!(screen.state().axis().follows, "a new start is seen from its start");
}

#[test]
fn every_built_in_scenario_opens_and_plays() {
    let mut screen = screen(DESKTOP, Theme::Light);
    for entry in kalmanscope_lessons::BUILT_IN {
        click(&mut screen, "Scenario");
        screen.get_by_label(entry.title).scroll_to_me();
        screen.run_steps(20);
        screen.get_by_label(entry.title).click();
        screen.run_steps(10);
        assert_eq!(scenario(&screen), &entry.scenario().expect("tested with the library"), "{}", entry.title);
        assert!(screen.state().session().playing());
    }
}
