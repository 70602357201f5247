//! The screen of a lesson's step, its question, and the way from lesson to lesson.

use kalmanscope_lessons::{Lesson, LessonStep};

use super::*;

pub(crate) fn lesson(size: Vec2, title: &str) -> Screen {
    let mut screen = screen(size, Theme::Light);
    click(&mut screen, "Lessons");
    // The menu is longer than a phone is high.
    screen.get_by_label(title).scroll_to_me();
    screen.run_steps(8);
    click(&mut screen, title);
    screen
}

fn shown(screen: &Screen, plots: &[&str]) -> Vec<bool> {
    plots.iter().map(|plot| screen.query_by_label(&format!("Plot of the {plot}")).is_some()).collect()
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
fn a_question_and_its_choices_are_in_sight_on_a_phone() {
    let mut questions = 0;
    for lesson in kalmanscope_lessons::lessons() {
        let lesson = lesson.expect("a built-in lesson can be read");
        let Some(question) = &lesson.steps[0].question else { continue };
        questions += 1;
        let mut screen = self::lesson(PHONE, &lesson.title);
        screen.run_steps(4);
        let steps = screen.get_by_label("Next").rect();
        for text in question.choices.iter().chain([&question.ask]) {
            let rect = screen.get_by_label(text).rect();
            assert!(rect.bottom() <= steps.top() + 1.0, "{}: “{text}” is hidden at {rect}", lesson.title);
            assert!(rect.top() > 0.5 * PHONE.y, "{}: “{text}” is above the panel at {rect}", lesson.title);
        }
    }
    assert!(questions >= 6, "{questions} lessons begin with a question");
}

#[test]
fn a_frame_without_an_end_reaches_as_far_as_the_record() {
    let mut screen = lesson(DESKTOP, "Recursive estimation");
    click(&mut screen, "Show me");
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
    press(&mut screen, Key::ArrowRight);
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
    let mut wide = lesson(Vec2::new(1700.0, 900.0), "Fading memory and a sudden loss");
    assert!(wide.query_by_label("Truth").is_some());
    click(&mut wide, "Fewer settings");
    let width = |screen: &Screen| screen.get_by_label("All settings").rect();
    let before = width(&wide);
    click(&mut wide, "Show me");
    click(&mut wide, "Next");
    assert_eq!(width(&wide), before, "no step changes the panel");
}

pub(crate) fn is_enabled(screen: &Screen, label: &str) -> bool {
    !screen.get_by_label(label).accesskit_node().is_disabled()
}

fn reveal(screen: &mut Screen, step: &LessonStep) {
    let skip = step.question.as_ref().map(|_| "Show me");
    for label in skip.into_iter().chain(step.change.as_ref().map(|change| change.label.as_str())) {
        // On a phone it may have to be scrolled to.
        screen.get_by_label(label).click_accesskit();
        screen.run_steps(4);
    }
}

pub(crate) fn study(screen: &mut Screen, lesson: &Lesson) {
    for (number, step) in lesson.steps.iter().enumerate() {
        reveal(screen, step);
        if number + 1 < lesson.steps.len() {
            click(screen, "Next");
        }
    }
}

pub(crate) fn built_in(title: &str) -> Lesson {
    let lessons = kalmanscope_lessons::lessons().into_iter().filter_map(Result::ok);
    lessons.into_iter().find(|lesson| lesson.title == title).expect(title)
}

const GUESS: &str = "Guess 14 ± 2 rad/s";

/// From the first answer to the next lesson, which has no question, and out of it.
#[test]
fn a_lesson_has_the_focus_and_is_taken_by_its_keys_alone() {
    let first = built_in("Recursive estimation");
    let mut screen = lesson(DESKTOP, &first.title);
    let is_at = |screen: &Screen, step: usize| {
        let text = format!("{}, step {step} of {}", first.title, first.steps.len());
        screen.get_by_label(&text).accesskit_node().is_focused()
    };
    assert!(is_at(&screen, 1));
    for key in [Key::Space, Key::Space, Key::N, Key::N] {
        press(&mut screen, key);
    }
    assert!(is_at(&screen, 2), "the answer is shown, and then the next step");
    press(&mut screen, Key::Tab);
    assert!(screen.get_by_label("Record for 60 s instead of 30 s").accesskit_node().is_focused());
    press(&mut screen, Key::Backspace);
    assert!(is_at(&screen, 1));
    for _ in 0..8 {
        press(&mut screen, Key::N);
    }
    assert!(screen.query_by_label("Leave the lesson").is_none(), "it is finished");
    click(&mut screen, "Lessons");
    screen.get_by_label("Recursive estimation, finished");
    click(&mut screen, "Noise reduction");
    press(&mut screen, Key::Q);
    click(&mut screen, "Lessons");
    assert!(screen.query_by_label("Noise reduction, finished").is_none(), "a lesson is finished by its end only");
}

#[test]
fn a_question_comes_before_the_change_and_its_effect() {
    let mut screen = lesson(DESKTOP, "Parameter initialisation");
    let shows = |screen: &Screen, label: &str| screen.query_by_label(label).is_some();
    assert!(!shows(&screen, GUESS) && !shows(&screen, "What happens"));
    assert!(shows(&screen, "Answer the question first, or press “Show me”.") && !is_enabled(&screen, "Next"));
    click(&mut screen, "Near the end of the 30 s.");
    assert!(shows(&screen, GUESS) && !shows(&screen, "What happens") && !shows(&screen, "Your answer"));
    assert!(shows(&screen, "Press “Guess 14 ± 2 rad/s” first.") && !is_enabled(&screen, "Next"));
    let next = screen.get_by_label("Next").rect().center();
    screen.hover_at(next);
    screen.run_steps(60);
    let reasons = screen.get_all_by_label("Press “Guess 14 ± 2 rad/s” first.");
    assert_eq!(reasons.count(), 2, "the reason is below the button and beside the pointer");
    click(&mut screen, GUESS);
    assert!(shows(&screen, "What happens") && is_enabled(&screen, "Next"));
    assert!(shows(&screen, "Not this time, and many would say so. The answer is: “After about a second.”"));
    assert!(shows(&screen, "Near the end of the 30 s. (your answer)"));
    assert!(screen.query_by_label_contains("Four σ are improbable at first").is_some());
    let mut screen = lesson(DESKTOP, "Parameter initialisation");
    click(&mut screen, "Never: it excludes such a value.");
    // The choice is free until the change is made.
    click(&mut screen, "After about a second.");
    click(&mut screen, GUESS);
    screen.get_by_label("That is right.");
    screen.get_by_label("After about a second. (right, your answer)");
}

#[test]
fn the_record_waits_for_the_answer() {
    let mut screen = lesson(DESKTOP, "Fading memory and a sudden loss");
    screen.run_steps(30);
    let session = screen.state().session();
    assert_eq!((session.mode(), session.playing(), session.position()), (Mode::Live, false, 2990));
    assert_eq!(screen.state().axis().framed, None);
    click(&mut screen, "Be wrong for seconds, within a narrow band.");
    assert_eq!(screen.state().session().mode(), Mode::Whole);
    assert_eq!(screen.state().axis().framed, Some((20.0, 60.0)));
    screen.get_by_label("That is right.");
}

#[test]
fn the_setting_that_a_step_changes_is_lit() {
    let mut screen = lesson(Vec2::new(1700.0, 1400.0), "Fading memory and a sudden loss");
    let lit = |screen: &Screen, path: &str| screen.query_by_label(&format!("The step is about {path}")).is_some();
    let steps = built_in("Fading memory and a sudden loss").steps;
    assert!(!lit(&screen, "filters.EKF.fading"));
    reveal(&mut screen, &steps[0]);
    click(&mut screen, "Next");
    assert!(lit(&screen, "filters.EKF.fading") && !lit(&screen, "filters.EKF.eta"));
    click(&mut screen, "λ = 1.005");
    let row = screen.get_by_label("The step is about filters.EKF.fading").rect();
    assert!(row.contains(screen.get_by_label("EKF fading factor, value").rect().center()));
    // The filter is meant, whatever it is called.
    super::identity::rename(&mut screen, "EKF", " 7");
    let name = scenario(&screen).filters[0].name.clone();
    assert!(name != "EKF" && lit(&screen, &format!("filters.{name}.fading")), "{name}");
    click(&mut screen, "Leave the lesson");
    assert!(!lit(&screen, &format!("filters.{name}.fading")));
}

#[test]
fn the_way_on_stays_where_it_is_from_question_to_answer_to_change() {
    let mut screen = lesson(DESKTOP, "Fading memory and a sudden loss");
    let place = |screen: &Screen, label: &str| screen.get_by_label(label).rect().center().y;
    let before = place(&screen, "Next");
    click(&mut screen, "Show me");
    assert_eq!(place(&screen, "Next"), before, "after the answer");
    click(&mut screen, "Next");
    assert_eq!(place(&screen, "Next"), before, "before the change");
    click(&mut screen, "λ = 1.005");
    assert_eq!(place(&screen, "Next"), before, "after the change");
    click(&mut screen, "Next");
    click(&mut screen, "λ = 1.02");
    click(&mut screen, "Next");
    assert_eq!(place(&screen, "Done"), before, "a click too many ends the lesson, and does not begin another");
}

#[test]
fn the_menu_has_all_lessons_in_sight_on_a_desktop() {
    let mut screen = screen(DESKTOP, Theme::Light);
    click(&mut screen, "Lessons");
    for lesson in kalmanscope_lessons::lessons() {
        let title = lesson.expect("a built-in lesson can be read").title;
        let rect = screen.get_by_label(&title).rect();
        assert!(rect.bottom() <= DESKTOP.y && rect.height() >= 22.0, "{title}: {rect}");
    }
}

#[test]
fn lesson_and_finished_lessons_survive_a_reload() {
    let first = built_in("Recursive estimation");
    let mut screen = lesson(DESKTOP, &first.title);
    study(&mut screen, &first);
    click(&mut screen, "Next: Predict and update, step by step");
    screen.get_by_label("1 of 4");
    click(&mut screen, "Lessons");
    click(&mut screen, "Parameter initialisation");
    click(&mut screen, "Near the end of the 30 s.");
    let mut again = reloaded(&saved(&mut screen), |app, _| app);
    again.get_by_label(GUESS);
    click(&mut screen, GUESS);
    let framed = screen.state().axis().framed;
    let mut changed = reloaded(&saved(&mut screen), |app, _| app);
    changed.get_by_label("1 of 4");
    changed.get_by_label("Near the end of the 30 s. (your answer)");
    assert!(is_enabled(&changed, "Next"));
    assert_eq!(scenario(&changed), scenario(&screen));
    assert_eq!((changed.state().axis().framed, changed.state().notice()), (framed, None));
    click(&mut changed, "Lessons");
    changed.get_by_label("Recursive estimation, finished");
    click(&mut again, GUESS);
    assert_eq!(scenario(&again), scenario(&screen));
}

#[test]
fn a_place_in_an_unknown_lesson_is_ignored_in_words() {
    let mut screen = lesson(DESKTOP, "Parameter initialisation");
    for (part, other) in
        [("\"lesson\":\"Parameter initialisation\"", "\"lesson\":\"Old\""), ("\"step\":0", "\"step\":9")]
    {
        let mut memory = saved(&mut screen);
        let text = memory.get_string("kalmanscope").expect("it is saved");
        assert!(text.contains(part), "{text}");
        memory.set_string("kalmanscope", text.replace(part, other));
        let restored = reloaded(&memory, |app, _| app);
        let notice = restored.state().notice().expect("it is said");
        assert!(notice.contains("cannot be continued") && notice.contains("step"), "{notice}");
        assert!(restored.query_by_label("Leave the lesson").is_none());
    }
}
