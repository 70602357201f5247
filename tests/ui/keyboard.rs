//! Everything by keyboard alone: a lesson, a tuning, a comparison.

use super::*;

fn tab_to(screen: &mut Screen, label: &str) {
    for _ in 0..250 {
        press(screen, Key::Tab);
        if screen.query_all_by_label(label).any(|node| node.accesskit_node().is_focused()) {
            return;
        }
    }
    panic!("{label} cannot be reached by Tab");
}

#[test]
fn a_filter_is_tuned_and_compared_by_keyboard() {
    let mut screen = screen(DESKTOP, Theme::Light);
    press(&mut screen, Key::Space);
    assert!(!screen.state().session().playing());
    press(&mut screen, Key::L);
    press(&mut screen, Key::X);
    let fading = |screen: &Screen| scenario(screen).filters[0].fading;
    let before = fading(&screen);
    tab_to(&mut screen, "EKF fading factor");
    for _ in 0..5 {
        press(&mut screen, Key::ArrowRight);
    }
    assert!(fading(&screen) > before, "an arrow turns the number that has the focus");
    assert_eq!(screen.state().session().mode(), Mode::Whole, "and does not step through the record");
    let after = fading(&screen);
    // Letters have their effect while a slider has the focus.
    press(&mut screen, Key::X);
    assert_eq!(fading(&screen), before);
    press(&mut screen, Key::X);
    assert_eq!(fading(&screen), after);
    press(&mut screen, Key::Home);
    press(&mut screen, Key::A);
    screen.state_mut().session_mut().seek(30.0);
    press(&mut screen, Key::B);
    assert!(screen.query_by_label_contains("Δt 30.00").is_some());
    press(&mut screen, Key::B);
    assert_eq!(super::marks::marks(&screen)[1], None, "the same key takes the mark away");
}

#[test]
fn the_list_of_keys_fits_into_any_window_and_is_closed_by_a_button() {
    for size in [DESKTOP, Vec2::new(1000.0, 560.0), PHONE, Vec2::new(844.0, 390.0), Vec2::new(360.0, 420.0)] {
        let mut screen = screen(size, Theme::Light);
        press(&mut screen, Key::Questionmark);
        screen.run_steps(10);
        let window = egui::Rect::from_min_size(egui::Pos2::ZERO, size);
        for line in ["play or pause", "copy a link to this picture", "zoom in", "turn it"] {
            // Without a scroll where there is room.
            if size != DESKTOP {
                screen.get_by_label(line).scroll_to_me();
                screen.run_steps(30);
            }
            let rect = screen.get_by_label(line).rect();
            assert!(window.contains_rect(rect), "{line}: {rect} of {size}");
        }
        let close = screen.get_by_label("Close window");
        assert!(window.contains_rect(close.rect()), "{} of {size}", close.rect());
        close.click();
        screen.run_steps(4);
        assert!(screen.query_by_label("play or pause").is_none(), "{size}");
    }
}
