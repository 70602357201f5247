//! The story above the plots, the few settings that it names, and the timeline at the foot.

use super::hand::click_at;
use super::*;

fn first_visit(size: Vec2) -> Screen {
    let mut screen = started(size, Theme::Light, |app, _| app);
    let session = screen.state_mut().session_mut();
    session.set_budget(Budget::Unlimited);
    session.set_mode(Mode::Whole);
    session.seek(20.0);
    session.pause();
    screen.run_steps(3);
    screen
}

fn story(screen: &Screen) -> String {
    let node = screen.get_by_label_contains("of its stiffness. fading EKF");
    node.accesskit_node().label().expect("the story is spoken")
}

#[test]
fn the_first_screen_says_what_happens_and_which_filter_to_believe() {
    for size in [DESKTOP, Vec2::new(1920.0, 1080.0), PHONE] {
        let screen = first_visit(size);
        let text = story(&screen);
        assert!(text.starts_with("At 8 s the spring loses 36 % of its stiffness."), "{text}");
        assert!(text.contains(
            "plain EKF, which forgets nothing (λ = 1.000), is still 1.4 % off, and does not know it (overconfident)."
        ));
        assert!(text.ends_with("Trust fading EKF."), "{text}");
    }
}

#[test]
fn a_number_in_the_text_is_a_setting() {
    let mut screen = first_visit(DESKTOP);
    screen.get_by_label("Loss of stiffness, in the text").set_value_accesskit(75.0);
    screen.run_steps(4);
    let Some(Signal::Step(step)) = scenario(&screen).plant.parameter(Channel::NATURAL_FREQUENCY) else {
        panic!("it is no step any more")
    };
    assert_eq!((step.from, step.to, step.at), (6.0, 3.0, 8.0));
    assert!(story(&screen).starts_with("At 8 s the spring loses 75 % of its stiffness."), "{}", story(&screen));
    undo(&mut screen);
    assert!(story(&screen).starts_with("At 8 s the spring loses 36 %"));
}

#[test]
fn a_change_is_compared_with_what_was_before() {
    let mut screen = first_visit(DESKTOP);
    screen.get_by_label("λ of plain EKF, in the text").set_value_accesskit(1.01);
    screen.run_steps(10);
    assert_eq!(scenario(&screen).filters[1].fading, 1.01);
    let text = story(&screen);
    assert!(text.contains("With λ = 1, the error of plain EKF in ωₙ was "), "{text}");
}

#[test]
fn a_first_visitor_sees_the_settings_that_the_story_names_and_the_way_to_all_others() {
    let mut screen = first_visit(DESKTOP);
    for name in ["Time of the change", "Loss of stiffness", "λ of fading EKF", "λ of plain EKF"] {
        screen.get_by_role_and_label(accesskit::Role::Slider, name);
    }
    assert!(screen.query_by_label("fading EKF fading factor").is_none());
    screen.get_by_role_and_label(accesskit::Role::Slider, "λ of plain EKF").set_value_accesskit(1.02);
    screen.run_steps(3);
    assert_eq!(scenario(&screen).filters[1].fading, 1.02);
    click(&mut screen, "All settings");
    screen.get_by_label("fading EKF fading factor");
    click(&mut screen, "Fewer settings");
    assert!(screen.query_by_label("fading EKF fading factor").is_none());
    // The choice outlasts the program.
    click(&mut screen, "All settings");
    let again = restored(&saved(&mut screen));
    let text = again.last_picture().line().expect("it can be written");
    assert!(text.contains("\"all_settings\":true"), "{text}");
}

#[test]
fn showing_a_number_beyond_its_range_does_not_change_it() {
    let mut screen = first_visit(DESKTOP);
    let mut wild = scenario(&screen).clone();
    wild.filters[0].fading = 1.4;
    set_scenario(&mut screen, wild.clone());
    assert_eq!(scenario(&screen), &wild);
}

#[test]
fn a_click_on_the_timeline_goes_to_a_time() {
    for size in [DESKTOP, PHONE] {
        let mut screen = first_visit(size);
        let track = screen.get_by_label("Time").rect();
        assert!(track.top() > size.y - 100.0, "at the foot: {track}");
        screen.hover_at(track.center());
        screen.drag_at(track.center());
        screen.drop_at(track.center());
        screen.run_steps(3);
        assert!((screen.state().session().time() - 10.0).abs() < 0.5, "{}", screen.state().session().time());
    }
}

#[test]
fn a_name_in_the_text_opens_the_diagnosis_of_that_filter() {
    let mut screen = first_visit(DESKTOP);
    let place = screen.get_all_by_label("plain EKF").map(|node| node.rect()).min_by(|a, b| a.top().total_cmp(&b.top()));
    let at = place.expect("it is in the story").center();
    click_on(&mut screen, at);
    screen.get_by_label("Close the diagnosis");
    screen.get_by_label("Diagnosis of plain EKF");
    press(&mut screen, Key::Escape);
    assert!(screen.query_by_label("Close the diagnosis").is_none());
}

#[test]
fn a_filter_on_the_mass_is_selected_by_a_click_and_tuned_there() {
    let mut screen = first_visit(DESKTOP);
    click(&mut screen, "plain EKF on the mass");
    screen.get_by_label("Close the diagnosis");
    screen.get_by_label("λ of plain EKF, in the diagnosis").set_value_accesskit(1.01);
    screen.run_steps(3);
    assert_eq!(scenario(&screen).filters[1].fading, 1.01);
}

fn find(screen: &mut Screen, words: &str) {
    press(screen, Key::Slash);
    screen.get_by_label("Find by words").type_text(words);
    screen.run_steps(2);
}

#[test]
fn a_number_is_set_with_five_keys_and_its_digits() {
    let mut screen = first_visit(DESKTOP);
    find(&mut screen, "lam pl");
    screen.get_by_label("Fading factor λ, plain EKF, setting");
    press(&mut screen, Key::Enter);
    screen.get_by_label("Fading factor λ, plain EKF, new value").type_text("1.015");
    screen.run_steps(2);
    press(&mut screen, Key::Enter);
    assert_eq!(scenario(&screen).filters[1].fading, 1.015);
    assert!(screen.query_by_label("Fading factor λ, plain EKF, new value").is_none(), "it closes");
}

#[test]
fn a_text_that_is_no_number_is_refused_until_it_changes() {
    let mut screen = first_visit(DESKTOP);
    find(&mut screen, "lam pl");
    press(&mut screen, Key::Enter);
    screen.get_by_label("Fading factor λ, plain EKF, new value").type_text("much");
    screen.run_steps(2);
    assert!(screen.query_by_label("This is no number.").is_none(), "nothing was entered");
    screen.key_press(Key::Enter);
    screen.run_steps(30);
    screen.get_by_label("This is no number.");
    screen.get_by_label("Fading factor λ, plain EKF, new value").type_text("x");
    screen.run_steps(2);
    assert!(screen.query_by_label("This is no number.").is_none());
}

#[test]
fn a_choice_is_found_by_its_words_and_made() {
    let mut screen = first_visit(DESKTOP);
    assert_eq!(scenario(&screen).hold, Hold::Zero);
    find(&mut screen, "between linear");
    screen.get_by_label("Input between samples: linear, choice");
    screen.key_press(Key::Enter);
    screen.run_steps(20);
    assert_eq!(scenario(&screen).hold, Hold::First);
    assert!(screen.query_by_label("Find by words").is_none(), "it closes");
    assert_eq!(
        screen.state().session().before().map(|before| before.words.as_str()),
        Some("input between samples = held")
    );
}

#[test]
fn views_scenarios_lessons_and_commands_are_found_by_words() {
    for (text, entry) in [
        ("innov", "Innovations, view"),
        ("bouc", "Bouc-Wen hysteresis, scenario"),
        ("fading sudden", "Fading memory and a sudden loss, lesson"),
        ("presenter", "Presenter mode: large type, command"),
        ("zeta guess", "Guess of ζ, fading EKF, setting"),
        ("std force", "Std of the force, setting"),
        ("euler plain", "Steps: Euler, plain EKF, choice"),
        ("zeta sigma", "σ of the guess of ζ, fading EKF, setting"),
        ("compare", "Compare, arrangement"),
        ("csv", "Estimates (CSV), export"),
        ("dark", "Dark theme, command"),
        ("residual", "Innovations, view"),
    ] {
        let mut screen = first_visit(DESKTOP);
        find(&mut screen, text);
        screen.get_by_label(entry);
        press(&mut screen, Key::Escape);
        assert!(screen.query_by_label("Find by words").is_none());
    }
    let mut screen = first_visit(DESKTOP);
    find(&mut screen, "guess");
    let rows = screen.query_all_by_label_contains(", setting").map(|node| node.rect());
    assert_eq!(rows.filter(|rect| rect.bottom() <= 400.0).count(), 10);
    press(&mut screen, Key::Escape);
    find(&mut screen, "innov");
    press(&mut screen, Key::Enter);
    screen.get_by_label("About Innovations");
}

/// A place on a plot where the pointer is a hand, which it is over a line of a filter.
fn on_a_line(screen: &mut Screen, plot: &str) -> egui::Pos2 {
    let rect = screen.get_by_label(plot).rect();
    let x = rect.left() + 0.9 * rect.width();
    let places = (0..rect.height() as usize / 3).map(|row| egui::pos2(x, rect.top() + 3.0 * row as f32));
    for place in places {
        screen.hover_at(place);
        screen.run_steps(2);
        if screen.output().platform_output.cursor_icon == egui::CursorIcon::PointingHand {
            return place;
        }
    }
    panic!("no line of {plot} is under the pointer");
}

#[test]
fn a_click_on_a_line_selects_its_filter_and_elsewhere_goes_to_a_time() {
    let mut screen = first_visit(DESKTOP);
    let line = on_a_line(&mut screen, "Plot of the natural frequency");
    click_at(&mut screen, line, Modifiers::NONE);
    screen.run_steps(4);
    screen.get_by_label("Close the diagnosis");
    assert_eq!(screen.state().session().time(), 20.0, "the time stays");
    press(&mut screen, Key::Escape);
    let rect = screen.get_by_label("Plot of the natural frequency").rect();
    click_at(&mut screen, egui::pos2(line.x, rect.top() + 4.0), Modifiers::NONE);
    screen.run_steps(4);
    assert!(screen.query_by_label("Close the diagnosis").is_none());
    assert!(screen.state().session().time() < 20.0, "a click beside the line goes to its time");
}

#[test]
fn the_edge_of_a_band_selects_its_filter_too() {
    let mut screen = first_visit(DESKTOP);
    let rect = screen.get_by_label("Plot of the natural frequency").rect();
    // The filters are not sure yet, and their bands are wide.
    let rows = (0..rect.height() as usize / 3).map(|row| egui::pos2(rect.left() + 12.0, rect.top() + 3.0 * row as f32));
    let places: Vec<egui::Pos2> = rows.collect();
    let selecting = |screen: &mut Screen| -> Vec<egui::Pos2> {
        let is_hand = |place: &&egui::Pos2| {
            screen.hover_at(**place);
            screen.run_steps(2);
            screen.output().platform_output.cursor_icon == egui::CursorIcon::PointingHand
        };
        places.iter().filter(is_hand).copied().collect()
    };
    let with_bands = selecting(&mut screen);
    click(&mut screen, "Show ±2σ");
    let without = selecting(&mut screen);
    let edge = with_bands.iter().find(|place| !without.contains(place)).expect("an edge is away from all lines");
    click(&mut screen, "Show ±2σ");
    click_at(&mut screen, *edge, Modifiers::NONE);
    screen.run_steps(4);
    screen.get_by_label("Close the diagnosis");
}
