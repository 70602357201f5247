//! The phone: drawers that leave the plots their room, menus that scroll, and fingers from the first frame.

use egui::{Event, PointerButton, Pos2, TouchPhase, pos2};
use kalmanscope::theme;

use super::*;

const SIDE: Vec2 = Vec2::new(844.0, 390.0);

/// The share of the window that a lesson or settings leave to the plots.
const FOR_PLOTS: f32 = 0.45;

pub(super) fn phone(size: Vec2) -> Screen {
    let mut screen = screen(size, Theme::Light);
    theme::expect_fingers(&screen.ctx);
    screen.run_steps(4);
    screen
}

/// Tells of a finger as a browser does: of its touch, and of a pointer that follows it.
pub(super) fn touch(screen: &mut Screen, phase: TouchPhase, pos: Pos2) {
    let (device_id, id, force) = (egui::TouchDeviceId(0), egui::TouchId(0), None);
    screen.event(Event::Touch { device_id, id, phase, pos, force });
    let button = |pressed| {
        let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
        Event::PointerButton { pos, button, pressed, modifiers }
    };
    match phase {
        TouchPhase::Start => {
            screen.event(Event::PointerMoved(pos));
            screen.event(button(true));
        }
        TouchPhase::Move => screen.event(Event::PointerMoved(pos)),
        TouchPhase::End | TouchPhase::Cancel => {
            screen.event(button(false));
            screen.event(Event::PointerGone);
        }
    }
    screen.run_steps(2);
}

pub(super) fn tap(screen: &mut Screen, label: &str) {
    let at = screen.get_by_label(label).rect().center();
    touch(screen, TouchPhase::Start, at);
    touch(screen, TouchPhase::End, at);
    screen.run_steps(20);
}

pub(super) fn swipe(screen: &mut Screen, from: Pos2, way: Vec2) {
    touch(screen, TouchPhase::Start, from);
    for step in 1..=8 {
        touch(screen, TouchPhase::Move, from + way * (step as f32 / 8.0));
    }
    touch(screen, TouchPhase::End, from + way);
    screen.run_steps(60);
}

fn plots(screen: &Screen, drawer: &str) -> f32 {
    let legend = screen.get_by_label("Show truth").rect();
    screen.get_by_label_contains(&format!("Make the {drawer} ")).rect().top() - legend.bottom()
}

fn lesson(size: Vec2, title: &str) -> Screen {
    let mut screen = phone(size);
    tap(&mut screen, "Lessons");
    screen.get_by_label(title).scroll_to_me();
    screen.run_steps(20);
    tap(&mut screen, title);
    screen
}

#[test]
fn a_swipe_on_a_lesson_scrolls_its_text_and_leaves_the_plots_their_room() {
    for size in [PHONE, Vec2::new(390.0, 664.0)] {
        let mut screen = lesson(size, "Recursive estimation");
        tap(&mut screen, "Show me");
        let before = plots(&screen, "lesson");
        assert!(before >= FOR_PLOTS * size.y, "{before} of {size}");
        let text = "The filter corrects the guess of 8 rad/s within about a second, and then the band shrinks. By 30 s it is less than a hundredth of its initial width.";
        let top = |screen: &Screen| screen.get_by_label(text).rect().top();
        let (at, buttons) = (top(&screen), screen.get_by_label("Next").rect());
        for way in [-200.0, -200.0, 90.0, -300.0] {
            swipe(&mut screen, pos2(150.0, buttons.top() - 40.0), egui::vec2(0.0, way));
            assert_eq!(plots(&screen, "lesson"), before, "after a swipe by {way} of {size}");
        }
        assert!(top(&screen) < at - 30.0, "the text has not moved: {at}, {}", top(&screen));
        assert_eq!(screen.get_by_label("Next").rect(), buttons);
        tap(&mut screen, "Next");
        assert_eq!(plots(&screen, "lesson"), before, "in the next step of {size}");
        let plot = screen.get_by_label("Plot of the natural frequency").rect();
        assert!(plot.height() > 80.0, "{plot} of {size}");
    }
}

#[test]
fn a_drawer_has_two_heights() {
    let mut screen = lesson(PHONE, "Recursive estimation");
    let high = plots(&screen, "lesson");
    tap(&mut screen, "Make the lesson lower");
    let low = plots(&screen, "lesson");
    assert!(low > high + 80.0, "{high}, {low}");
    assert!(screen.get_by_label("Next").rect().bottom() <= PHONE.y, "the way on is in sight");
    // A drag of the title goes to the nearer height.
    let title = screen.get_by_label("Recursive estimation").rect().center();
    swipe(&mut screen, title, egui::vec2(0.0, -20.0));
    assert_eq!(plots(&screen, "lesson"), low);
    swipe(&mut screen, title, egui::vec2(0.0, -300.0));
    assert_eq!(plots(&screen, "lesson"), high, "it never covers more of the plots");
}

#[test]
fn a_number_is_tuned_with_its_curve_in_sight() {
    let mut screen = phone(PHONE);
    screen.state_mut().session_mut().set_mode(Mode::Whole);
    screen.run_steps(4);
    assert!(screen.query_by_label("About Oscillator").is_some() && screen.query_by_label("Restart").is_some());
    tap(&mut screen, "Settings");
    for hidden in ["About Oscillator", "Pause", "Play", "Restart", "Time"] {
        assert!(screen.query_by_label(hidden).is_none(), "{hidden} takes room");
    }
    let curves = |screen: &Screen| {
        let drawer = screen.get_by_label("Make the settings lower").rect().top();
        ["natural frequency", "damping ratio"].map(|name| {
            let plot = screen.get_by_label(&format!("Plot of the {name}")).rect();
            assert!(plot.height() > 80.0 && plot.bottom() <= drawer, "{name}: {plot} above {drawer}");
            plot
        })
    };
    let before = curves(&screen);
    let slider = screen.get_by_label("EKF fading factor").rect();
    swipe(&mut screen, slider.left_center() + egui::vec2(15.0, 0.0), egui::vec2(60.0, 0.0));
    assert!(scenario(&screen).filters[0].fading > 1.005, "{}", scenario(&screen).filters[0].fading);
    assert_eq!(curves(&screen), before, "nothing has moved");
    let [filter, chip] = ["Show EKF", "before: EKF λ = 1.005 ×"].map(|label| screen.get_by_label(label).rect());
    assert!((filter.center().y - chip.center().y).abs() < 12.0, "one row: {filter} {chip}");
    assert!(chip.right() <= PHONE.x, "the chip is in sight: {chip}");
    screen.run_steps(90);
    tap(&mut screen, "Undo");
    assert_eq!(scenario(&screen).filters[0].fading, 1.005);
    tap(&mut screen, "Close the settings");
    assert!(screen.query_by_label("About Oscillator").is_some() && screen.query_by_label("Restart").is_some());
}

#[test]
fn every_menu_leaves_its_button_in_sight_and_its_last_entry_is_reached() {
    let lessons = kalmanscope_lessons::lessons();
    let last_lesson = lessons.last().and_then(|lesson| lesson.as_ref().ok()).expect("a lesson").title.clone();
    for size in [PHONE, SIDE] {
        for (button, last) in [
            ("Scenario", "Copy as text"),
            ("Views", "Predict and update"),
            ("Lessons", last_lesson.as_str()),
            ("Export", "Session file"),
        ] {
            let mut screen = phone(size);
            tap(&mut screen, button);
            let is_in_sight = |screen: &Screen| {
                let rect = screen.get_by_label(last).rect();
                rect.bottom() <= size.y && rect.top() >= screen.get_by_label(button).rect().bottom()
            };
            for _ in 0..12 {
                if !is_in_sight(&screen) {
                    let x = screen.get_by_label(last).rect().center().x;
                    swipe(&mut screen, pos2(x, 0.75 * size.y), egui::vec2(0.0, -0.4 * size.y));
                }
            }
            assert!(is_in_sight(&screen), "{button} at {size}: {last} at {}", screen.get_by_label(last).rect());
            // The menu does not lie over its button.
            tap(&mut screen, button);
            assert!(screen.query_by_label(last).is_none(), "{button} at {size} does not close by its button");
        }
    }
}

#[test]
fn the_first_touch_moves_nothing_where_fingers_are_expected() {
    let mut screen = started(PHONE, Theme::Light, |app, ctx| {
        theme::expect_fingers(ctx);
        app
    });
    screen.state_mut().session_mut().set_budget(Budget::Unlimited);
    screen.run_steps(2);
    screen.state_mut().session_mut().pause();
    screen.run_steps(2);
    let labels = ["Restart", "Lessons", "Show measured", "About Parameters", "Plot of the natural frequency"];
    let places = |screen: &Screen| labels.map(|label| screen.get_by_label(label).rect());
    let before = places(&screen);
    assert!(before[0].height() >= 39.5 && before[1].height() >= 39.5, "{before:?}");
    touch(&mut screen, TouchPhase::Start, pos2(200.0, 820.0));
    touch(&mut screen, TouchPhase::End, pos2(200.0, 820.0));
    screen.run_steps(4);
    assert_eq!(places(&screen), before);
}

#[test]
fn a_lesson_on_a_phone_on_its_side_leaves_plots_in_sight() {
    let mut screen = lesson(SIDE, "Recursive estimation");
    tap(&mut screen, "Show me");
    let plot = screen.get_by_label("Plot of the natural frequency").rect();
    assert!(plot.height() > 110.0 && plot.bottom() <= SIDE.y, "{plot}");
    tap(&mut screen, "Next");
    assert!(screen.get_by_label("Plot of the natural frequency").rect().height() > 110.0);
}

#[test]
fn a_finger_that_is_held_reads_values_and_the_page_stays() {
    let mut screen = phone(PHONE);
    let session = screen.state_mut().session_mut();
    session.set_mode(Mode::Whole);
    session.pause();
    screen.run_steps(10);
    let plot = screen.get_by_label("Plot of the natural frequency").rect();
    let before = screen.state().session().time();
    touch(&mut screen, TouchPhase::Start, plot.center());
    screen.run_steps(120);
    for step in 1..=8 {
        touch(&mut screen, TouchPhase::Move, plot.center() + egui::vec2(5.0 * step as f32, -8.0 * step as f32));
    }
    screen.run_steps(4);
    assert_eq!(screen.get_by_label("Plot of the natural frequency").rect(), plot, "the page does not scroll");
    let time = screen.state().pointed().expect("the finger points at a time");
    assert!((35.0..42.0).contains(&time), "{time}");
    touch(&mut screen, TouchPhase::End, plot.center());
    screen.run_steps(4);
    assert_eq!(screen.state().session().time(), before, "nothing was clicked");
}
