//! Links: what one screen shows, another shows too.

use std::process::Command;

use egui::{Event, OutputCommand};
use kalmanscope::laboratory::{Choices, SeedChoice};
use kalmanscope::request::LegendEntry;
use kalmanscope::share::MARK;

use super::*;

fn copied(screen: &Screen) -> Option<String> {
    screen.output().platform_output.commands.iter().find_map(|command| match command {
        OutputCommand::CopyText(text) => Some(text.clone()),
        _ => None,
    })
}

pub(super) fn copy(screen: &mut Screen) -> String {
    // In a single frame: the next one has other output.
    screen.input_mut().events.push(Event::Key {
        key: Key::C,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers: Modifiers::NONE,
    });
    screen.step();
    copied(screen).expect("a link is copied")
}

fn paste(screen: &mut Screen, text: &str) {
    screen.event(Event::Paste(text.to_owned()));
    screen.run_steps(4);
}

fn checksum(screen: &Screen) -> u64 {
    screen.state().session().run().checksum()
}

fn unusual(mode: Mode) -> Screen {
    let mut screen = screen(DESKTOP, Theme::Dark);
    let state = screen.state_mut();
    let mut scenario = Scenario::default();
    (scenario.seed, scenario.duration, scenario.filters[1].fading) = (77, 20.0, 1.02);
    state.session_mut().set_scenario(scenario);
    *state.layout_mut() = ViewLayout::column(&[ViewKind::States, ViewKind::Phase, ViewKind::Innovations]);
    state.session_mut().set_mode(mode);
    state.session_mut().pause();
    state.session_mut().seek(13.37);
    state.session_mut().set_speed(0.25);
    screen.run_steps(4);
    // The truth and the first filter are hidden, the present time is marked as A.
    screen.get_by_label("Show truth").click();
    for key in [Key::Num1, Key::A] {
        press(&mut screen, key);
    }
    screen
}

#[test]
fn another_screen_shows_the_same_picture_with_the_same_bits() {
    for mode in [Mode::Live, Mode::Whole] {
        let mut one = unusual(mode);
        let link = copy(&mut one);
        assert!(link.starts_with(MARK) && link.len() < 400, "{} characters: {link}", link.len());
        let notice = one.state().notice().expect("it is said");
        assert_eq!(notice, "A link to this picture is in the clipboard.");

        let mut other = screen(DESKTOP, Theme::Light);
        assert_ne!(checksum(&other), checksum(&one));
        paste(&mut other, &format!(" https://example.org/kalmanscope/{link}\n"));
        assert_eq!(other.state().notice(), None);
        assert_eq!(other.state().picture(), one.state().picture());
        assert_eq!(checksum(&other), checksum(&one));
        let session = other.state().session();
        assert_eq!((session.mode(), session.position(), session.playing()), (mode, 1337, false));
        assert_eq!((session.speed(), other.state().ruler().time(RulerEnd::A)), (0.25, Some(13.37)));
        let hidden = [LegendEntry::Truth, LegendEntry::Filter(1)];
        assert_eq!(other.state().picture().hidden, hidden);
        assert_eq!(copy(&mut other), link, "the link to the picture of a link is that link");
    }
}

#[test]
fn the_menu_copies_a_link_of_the_page() {
    let mut screen = screen(DESKTOP, Theme::Light);
    *screen.state_mut() = App::with_scenario(Scenario::default()).expect("it runs").at_page("https://example.org/k/");
    screen.run_steps(2);
    click(&mut screen, "Export");
    screen.get_by_label("Copy link").click();
    let link = (0..4).find_map(|_| {
        screen.step();
        copied(&screen)
    });
    let link = link.expect("a link is copied");
    assert!(link.starts_with(&format!("https://example.org/k/{MARK}1.")), "{link}");
}

#[test]
fn a_link_and_a_saved_session_keep_what_is_chosen_in_the_laboratory_where_it_is_shown() {
    let views = [ViewKind::Map, ViewKind::MonteCarlo, ViewKind::Tune, ViewKind::Sensors];
    let mut one = screen(DESKTOP, Theme::Light);
    show_whole(&mut one, Scenario { duration: 5.0, ..Scenario::default() });
    show(&mut one, &views);
    one.state_mut().laboratory.seeds.choose(SeedChoice { seeds: 44, ..SeedChoice::default() });
    choose(&mut one, "Score", "log likelihood");
    choose(&mut one, "Goal of the tuning", "a mean NIS as expected");
    let chosen = one.state().picture().laboratory;
    assert!(chosen.map.is_some() && chosen.tuning.is_some() && chosen.seeds.is_some_and(|seeds| seeds.seeds == 44));
    let other = opened(&one.state().link().expect("it is short"));
    assert_eq!((other.state().notice(), other.state().picture().laboratory), (None, chosen.clone()));
    let again = restored(&saved(&mut one));
    assert_eq!((again.notice(), again.last_picture().laboratory), (None, chosen));
    show(&mut one, &[ViewKind::States]);
    assert_eq!(one.state().picture().laboratory, Choices::default(), "without the views a link says nothing of them");
}

#[test]
fn undo_brings_the_settings_before_a_link_back() {
    let link = copy(&mut unusual(Mode::Live));
    let mut screen = screen(DESKTOP, Theme::Light);
    let before = scenario(&screen).clone();
    paste(&mut screen, &link);
    assert_eq!(scenario(&screen).seed, 77);
    undo(&mut screen);
    assert_eq!(scenario(&screen), &before);
}

#[test]
fn a_link_that_cannot_be_opened_is_one_sentence_and_changes_nothing() {
    let link = copy(&mut unusual(Mode::Live));
    let mut screen = unusual(Mode::Whole);
    let before = (screen.state().picture(), checksum(&screen));
    let cut = link[..link.len() - 5].to_owned();
    for (address, sentence) in [
        (cut, "The link cannot be opened: it is damaged: a part of it is missing or changed."),
        ("?lesson=none".to_owned(), "There is no lesson “none”. The lessons are recursive-estimation, "),
        (
            "?lesson=sudden-loss&step=9".to_owned(),
            "There is no step “9” of the lesson “sudden-loss”: it has the steps 1 to ",
        ),
        ("?scenario=<b>".to_owned(), "There is no scenario “<b>”. The scenarios are forgetting, stiffness-loss, "),
    ] {
        paste(&mut screen, &address);
        let notice = screen.state().notice().expect("it is said").to_owned();
        assert!(notice.contains(sentence), "{notice}");
        assert_eq!((screen.state().picture(), checksum(&screen)), before, "{address}");
    }
    click(&mut screen, "Dismiss");
    paste(&mut screen, "a text that is no address");
    assert_eq!(screen.state().notice(), None);
    assert_eq!((screen.state().picture(), checksum(&screen)), before);
}

#[test]
fn an_address_opens_a_lesson_or_a_scenario() {
    let mut screen = screen(DESKTOP, Theme::Light);
    paste(&mut screen, "https://example.org/?scenario=duffing");
    assert_eq!(scenario(&screen).plant.kind, PlantKind::DUFFING);
    for name in ["31-sudden-loss", "sudden-loss"] {
        paste(&mut screen, &format!("https://example.org/?lesson={name}&step=2"));
        screen.get_by_label("2 of 4");
        paste(&mut screen, "?scenario=duffing");
    }
}

#[test]
fn an_embedded_screen_has_plots_and_transport_only_and_leaves_the_saved_session() {
    let mut screen = Harness::builder()
        .with_size(Vec2::new(700.0, 420.0))
        .build_eframe(|creation| App::embedded(creation).expect("the default scenario can be run"));
    screen.run_steps(3);
    for label in ["Play", "Pause"] {
        if let Some(button) = screen.query_by_label(label) {
            assert!(button.rect().top() > 300.0, "at the foot: {}", button.rect());
        }
    }
    for label in ["Time", "Explore", "Live", "Whole record"] {
        screen.get_by_label(label);
    }
    for label in ["Settings", "Scenario", "Views", "Lessons", "More", "Undo"] {
        assert!(screen.query_by_label(label).is_none(), "{label}");
    }
    press(&mut screen, Key::S);
    assert!(screen.query_by_label("Record").is_none(), "there are no settings");
    assert_eq!(saved(&mut screen).get_string("kalmanscope"), None);
}

#[test]
fn the_program_says_why_its_arguments_cannot_be_used() {
    for (argument, sentence) in [
        ("https://example.org/#link=1.AAAA", "error: The link cannot be opened: it is damaged"),
        ("?scenario=none", "error: There is no scenario “none”"),
        ("file.toml", "error: “file.toml” is neither a file nor an address"),
        ("--kep", "error: unexpected argument '--kep' found"),
        ("?scenario=duffing more", "error: unexpected argument 'more' found"),
        ("--listen", "error: a value is required for '--listen <SOURCE>'"),
        ("--listen - none.toml", "error: none.toml cannot be read: "),
    ] {
        let arguments = argument.split(' ');
        let output =
            Command::new(env!("CARGO_BIN_EXE_kalmanscope")).args(arguments).output().expect("it can be started");
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(message.starts_with(sentence), "{message}");
        assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{argument}");
    }
}
