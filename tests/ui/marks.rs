//! Two marked times: how they are set, what their table tells, and when they go.

use super::hand::{click_at, in_plot, whole};
use super::*;

pub(super) fn marks(screen: &Screen) -> [Option<f64>; 2] {
    RulerEnd::BOTH.map(|end| screen.state().ruler().time(end))
}

#[test]
fn shift_and_a_click_mark_two_times_whose_values_stand_in_a_table() {
    let mut screen = whole();
    for share in [0.25, 0.75] {
        let at = in_plot(&screen, share);
        click_at(&mut screen, at, Modifiers::SHIFT);
    }
    let [Some(a), Some(b)] = marks(&screen) else { panic!("{:?}", marks(&screen)) };
    assert!((a - 15.5).abs() < 2.0 && (b - 46.4).abs() < 2.0, "{a} {b}");
    assert_eq!(screen.state().session().time(), 20.0, "playback stays");
    let label = format!("Δt {:.3} s", b - a);
    assert!(screen.query_by_label_contains(&label).is_some(), "{label}");
    // A mark is dragged by its line.
    let at = in_plot(&screen, 0.75);
    let x = screen.get_by_label("Plot of the natural frequency").rect();
    let line = egui::pos2(at.x, x.top() + 20.0);
    drag(&mut screen, line, egui::vec2(-40.0, 0.0));
    let moved = marks(&screen)[1].unwrap();
    assert!(moved < b - 1.0, "{moved} instead of {b}");
    assert!(screen.state().axis().follows, "a mark was dragged, not the plot");
}

#[test]
fn marks_belong_to_their_record() {
    for other in ["Slow drift", "Measured: a circuit"] {
        let mut screen = screen(DESKTOP, Theme::Light);
        screen.state_mut().session_mut().set_mode(Mode::Whole);
        screen.state_mut().session_mut().seek(20.0);
        press(&mut screen, Key::A);
        assert_eq!(marks(&screen), [Some(20.0), None]);
        click(&mut screen, "Scenario");
        click(&mut screen, other);
        assert_eq!(marks(&screen), [None, None], "{other}");
    }
}
