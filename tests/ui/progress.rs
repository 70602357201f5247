//! Progress in the lessons, after a reload.

use super::lessons::{GUESS, built_in, click, is_enabled, lesson, study};
use super::*;

/// The screen that a reload of the page shows.
fn reloaded(memory: Memory) -> Screen {
    let mut screen = Harness::builder().with_size(DESKTOP).build_eframe(move |creation| {
        kalmanscope::theme::install(&creation.egui_ctx);
        App::restored(Some(&memory)).expect("the saved scenario can be run")
    });
    screen.run_steps(4);
    screen
}

fn saved(screen: &mut Screen) -> Memory {
    let mut memory = Memory::default();
    screen.state_mut().save(&mut memory);
    memory
}

#[test]
fn lesson_and_finished_lessons_survive_a_reload() {
    let first = built_in("Recursive estimation");
    let mut screen = lesson(DESKTOP, &first.title);
    study(&mut screen, &first);
    click(&mut screen, "Done");
    click(&mut screen, "Lessons");
    click(&mut screen, "Parameter initialisation");
    click(&mut screen, "Near the end of the 30 s.");
    let mut again = reloaded(saved(&mut screen));
    again.get_by_label(GUESS);
    click(&mut screen, GUESS);
    let framed = screen.state().axis().framed;
    let mut changed = reloaded(saved(&mut screen));
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
        let restored = reloaded(memory);
        let notice = restored.state().notice().expect("it is said");
        assert!(notice.contains("cannot be continued") && notice.contains("step"), "{notice}");
        assert!(restored.query_by_label("Leave the lesson").is_none());
    }
}
