//! Usual gestures: keys, wheels, double clicks, large type, a drawer on the phone.

use egui::{Event, Modifiers, MouseWheelSource, MouseWheelUnit, TouchPhase};

use super::*;

pub(super) fn double_click(screen: &mut Screen, label: &str) {
    let at = screen.get_by_label(label).rect().center();
    screen.hover_at(at);
    // Long enough after any earlier click.
    screen.run_steps(60);
    for _ in 0..2 {
        screen.drag_at(at);
        screen.step();
        screen.drop_at(at);
        screen.step();
    }
    screen.run_steps(3);
}

#[test]
fn a_double_click_takes_a_number_back_to_what_it_was() {
    let mut screen = workbench();
    let numbers = |screen: &Screen| {
        let filter = &scenario(screen).filters[0];
        (filter.fading, filter.initial_std[Channel::NATURAL_FREQUENCY], scenario(screen).sensors[0].noise_std)
    };
    let before = numbers(&screen);
    for (control, double_clicked) in [
        ("EKF fading factor", "EKF fading factor, value"),
        ("EKF initial std of natural frequency", "EKF initial std of natural frequency"),
        ("Noise of the displacement sensor", "Noise of the displacement sensor"),
    ] {
        set(&mut screen, control, 1.03);
        assert_ne!(numbers(&screen), before, "{control}");
        double_click(&mut screen, double_clicked);
        assert_eq!(numbers(&screen), before, "{control}");
    }
    // Another scenario resets the initial values.
    click(&mut screen, "Scenario");
    click(&mut screen, kalmanscope_lessons::BUILT_IN[3].title);
    let opened = numbers(&screen);
    set(&mut screen, "Noise of the displacement sensor", 0.2);
    double_click(&mut screen, "Noise of the displacement sensor");
    assert_eq!(numbers(&screen), opened);
}

#[test]
fn the_wheel_turns_a_number_only_with_alt() {
    let mut screen = workbench();
    let fading = |screen: &Screen| scenario(screen).filters[0].fading;
    let before = fading(&screen);
    let at = screen.get_by_label("EKF fading factor, value").rect().center();
    screen.hover_at(at);
    screen.run_steps(2);
    let turn = |screen: &mut Screen, modifiers: Modifiers| {
        let (unit, phase, source) = (MouseWheelUnit::Point, TouchPhase::Move, MouseWheelSource::Unknown);
        let delta = Vec2::new(0.0, 20.0);
        screen.event(Event::ModifiersChanged(modifiers));
        screen.event(Event::MouseWheel { unit, delta, phase, source, modifiers });
        screen.run_steps(15);
        screen.event(Event::ModifiersChanged(Modifiers::NONE));
        screen.run_steps(2);
    };
    turn(&mut screen, Modifiers::NONE);
    assert_eq!(fading(&screen), before);
    turn(&mut screen, Modifiers::ALT);
    assert!(fading(&screen) > before + 0.01, "{} after {before}", fading(&screen));
}

#[test]
fn keys_have_the_listed_effects() {
    let mut screen = screen(DESKTOP, Theme::Light);
    let session = |screen: &Screen| {
        let session = screen.state().session();
        (session.playing(), session.mode(), session.speed())
    };
    press(&mut screen, Key::Space);
    assert_eq!(session(&screen), (false, Mode::Live, 2.0));
    press(&mut screen, Key::Plus);
    press(&mut screen, Key::L);
    assert_eq!(session(&screen), (false, Mode::Whole, 5.0));
    for _ in 0..9 {
        press(&mut screen, Key::Minus);
    }
    assert_eq!(session(&screen).2, 0.1);
    screen.state_mut().session_mut().seek(10.0);
    press(&mut screen, Key::ArrowLeft);
    assert_eq!(screen.state().session().position(), 999);
    press(&mut screen, Key::ArrowRight);
    assert_eq!(screen.state().session().position(), 1000);
    press(&mut screen, Key::R);
    assert_eq!(screen.state().session().position(), 0);

    let shown =
        |screen: &Screen| screen.query_by_label("Duration").is_some() || screen.query_by_label("Record").is_some();
    assert!(shown(&screen));
    press(&mut screen, Key::S);
    assert!(!shown(&screen));
    press(&mut screen, Key::S);
    assert!(shown(&screen));

    press(&mut screen, Key::Questionmark);
    for line in ["play or pause", "presenter mode: large type", "undo the last change of a setting"] {
        assert!(screen.query_by_label(line).is_some(), "{line} is not in the list");
    }
    press(&mut screen, Key::Escape);
    assert!(screen.query_by_label("play or pause").is_none());

    let toggle = |screen: &Screen| screen.get_by_label("Show UKF").accesskit_node().toggled();
    let before = toggle(&screen);
    press(&mut screen, Key::Num2);
    assert_ne!(toggle(&screen), before);
}

#[test]
fn presenter_mode_is_large_and_leaves_the_room_to_the_plots() {
    let mut screen = screen(DESKTOP, Theme::Light);
    let share = |screen: &Screen| {
        let plot = screen.get_by_label("Plot of the displacement").rect();
        plot.area() / screen.ctx.content_rect().area()
    };
    let before = (screen.ctx.zoom_factor(), share(&screen));
    click(&mut screen, "More");
    click(&mut screen, "Presenter mode");
    assert!(screen.ctx.zoom_factor() > 1.3 * before.0);
    // The bar hides while the pointer is elsewhere.
    screen.hover_at(egui::pos2(400.0, 300.0));
    screen.run_steps(5);
    assert!(screen.query_by_label("Settings").is_none());
    assert!(share(&screen) > before.1, "{} after {}", share(&screen), before.1);
    assert!(screen.query_by_label("EKF fading factor").is_none());
    screen.hover_at(egui::pos2(400.0, 5.0));
    screen.run_steps(5);
    screen.get_by_label("Settings").click();
    screen.run_steps(20);
    assert!(screen.query_by_label("EKF fading factor").is_some());
    // It gives back the zoom of before, though Ctrl+0 is pressed meanwhile.
    screen.ctx.set_zoom_factor(1.0);
    screen.run_steps(4);
    press(&mut screen, Key::P);
    assert_eq!(screen.ctx.zoom_factor(), before.0);
}

#[test]
fn filters_keep_their_colours_when_others_go() {
    let mut screen = workbench();
    let colors = |screen: &Screen| {
        let estimates = screen.state().session().run().estimates();
        estimates.iter().map(|e| (e.name().to_owned(), e.color())).collect::<HashMap<_, _>>()
    };
    click(&mut screen, "Duplicate EKF");
    let before = colors(&screen);
    assert_eq!(before.values().collect::<std::collections::HashSet<_>>().len(), 3, "{before:?}");
    click(&mut screen, "Remove EKF");
    let after = colors(&screen);
    assert!(after.iter().all(|(name, color)| before[name] == *color), "{before:?}, then {after:?}");
    click(&mut screen, "Colour of UKF");
    click(&mut screen, "purple");
    assert_eq!(colors(&screen)["UKF"], kalmanscope_core::FilterColor::Purple);
}

#[test]
fn scores_name_their_units_and_what_they_are_measured_from() {
    let mut screen = workbench();
    screen.state_mut().session_mut().set_mode(Mode::Live);
    *screen.state_mut().layout_mut() = ViewLayout::column(&[ViewKind::Scores]);
    screen.state_mut().session_mut().seek(20.0);
    screen.run_steps(3);
    assert!(screen.query_by_label("ωₙ RMSE, last third [rad/s]").is_some());
    assert!(screen.query_by_label("ωₙ settled from the start [s]").is_some());
    screen.state_mut().session_mut().set_mode(Mode::Whole);
    screen.run_steps(3);
    assert!(screen.query_by_label("ωₙ settled after the change [s]").is_some());
    assert!(screen.query_by_label("ζ settled after the change [s]").is_some(), "the loss disturbs ζ too");
    let session = screen.state().session();
    let settled = session.diagnostics()[0].settled(Channel::NATURAL_FREQUENCY).expect("the EKF follows the loss");
    let delay = session.run().record().time_of(settled) - 30.0;
    assert!((1.0..10.0).contains(&delay), "{delay}");
    assert!(screen.query_all_by_label(&kalmanscope::text::significant(delay, 3)).next().is_some(), "{delay}");
}

#[test]
fn smoothed_estimates_are_shown_of_the_whole_record() {
    let mut screen = workbench();
    open_options(&mut screen);
    click(&mut screen, "EKF: hindsight");
    assert!(screen.state().session().smoothed().is_empty(), "there is none before the record is complete");
    screen.state_mut().session_mut().set_mode(Mode::Whole);
    screen.run_steps(3);
    let [smoothed] = screen.state().session().smoothed() else { panic!("one filter has hindsight") };
    assert_eq!((smoothed.id(), smoothed.name(), smoothed.len()), (1, "EKF, smoothed", 6001));
}

#[test]
fn hindsight_with_a_look_ahead_goes_along() {
    let mut screen = workbench();
    open_options(&mut screen);
    assert!(screen.query_by_label("EKF look-ahead of hindsight").is_none(), "there is no hindsight");
    click(&mut screen, "EKF: hindsight");
    set(&mut screen, "EKF look-ahead of hindsight", 0.5);
    assert_eq!(scenario(&screen).filters[0].look_ahead, 0.5);
    screen.state_mut().session_mut().toggle_play();
    screen.run_steps(60);
    screen.state_mut().session_mut().toggle_play();
    screen.run_steps(3);
    let session = screen.state().session();
    let [smoothed] = session.smoothed() else { panic!("one filter has hindsight") };
    assert!(session.run().done() > 60);
    assert_eq!(smoothed.len(), session.run().done() - 50);
}

#[test]
fn a_plot_can_be_seen_alone() {
    let mut screen = screen(DESKTOP, Theme::Light);
    let plots = |screen: &Screen| {
        let shown = |name: &str| screen.query_by_label(&format!("Plot of the {name}")).map(|plot| plot.rect());
        [shown("natural frequency"), shown("damping ratio"), shown("displacement")]
    };
    let click = |screen: &mut Screen| {
        let beside_the_settings = |rect: egui::Rect| rect.left() > 340.0;
        let symbol = screen.get_all_by_label("ζ").map(|node| node.rect()).find(|rect| beside_the_settings(*rect));
        let at = symbol.expect("the plot of ζ has a heading").center();
        click_on(screen, at);
    };
    let before = plots(&screen);
    click(&mut screen);
    let [frequency, damping, displacement] = plots(&screen);
    assert!(frequency.is_none() && displacement == before[2]);
    assert!(damping.expect("it is alone").width() > 1.9 * before[1].expect("it is there").width());
    click(&mut screen);
    assert_eq!(plots(&screen), before);
}

#[test]
fn a_finger_on_a_plot_scrolls_and_does_not_zoom() {
    let mut screen = screen(PHONE, Theme::Light);
    let touch = |screen: &Screen, phase, pos| {
        let (device_id, id, force) = (egui::TouchDeviceId(0), egui::TouchId(0), None);
        screen.event(Event::Touch { device_id, id, phase, pos, force });
    };
    let plot = screen.get_by_label("Plot of the displacement").rect().center();
    touch(&screen, TouchPhase::Start, plot);
    touch(&screen, TouchPhase::End, plot);
    screen.run_steps(3);
    screen.hover_at(plot);
    screen.drag_at(plot);
    screen.run_steps(2);
    screen.hover_at(plot - Vec2::new(40.0, 30.0));
    screen.run_steps(2);
    screen.drop_at(plot - Vec2::new(40.0, 30.0));
    screen.run_steps(3);
    assert!(screen.state().axis().follows);
}

#[test]
fn the_views_menu_stays_open_while_views_are_chosen() {
    let mut screen = screen(DESKTOP, Theme::Light);
    click(&mut screen, "Views");
    for (name, tab) in [("Kalman gain", ViewKind::Gain), ("Planes", ViewKind::Phase)] {
        click(&mut screen, name);
        assert!(screen.state_mut().layout_mut().shown().contains(&tab), "{name}");
    }
    // The menu may cover the tabs.
    click(&mut screen, "Views");
    show(&mut screen, &[ViewKind::Phase]);
    click(&mut screen, view(ViewKind::ParameterPlane).name);
    let shown = screen.state_mut().layout_mut().shown();
    assert!(shown.contains(&ViewKind::ParameterPlane) && !shown.contains(&ViewKind::Phase), "{shown:?}");
    click(&mut screen, "Views");
    click(&mut screen, "Planes");
    assert!(!screen.state_mut().layout_mut().shown().contains(&ViewKind::ParameterPlane), "no tab is left");
}
