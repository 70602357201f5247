//! The plant's equation is typed.

use super::*;

fn equation(screen: &Screen) -> &str {
    scenario(screen).plant.kind.equation()
}

fn type_into(screen: &mut Screen, text: &str) {
    screen.get_by_label("Equation of motion").focus();
    screen.run_steps(2);
    screen.get_by_label("Equation of motion").type_text(text);
    screen.run_steps(2);
}

fn editor() -> Screen {
    let mut screen = workbench();
    choose(&mut screen, "Kind of plant", "equation of your own");
    screen.run_steps(3);
    screen
}

#[test]
fn an_equation_is_typed_and_identified() {
    let mut screen = editor();
    assert_eq!(equation(&screen), "x'' + 2 ζ ωₙ x' + ωₙ² x = f");
    // The parameters keep their numbers, and what is estimated is the same.
    assert!(matches!(parameter(&screen, "natural_frequency"), Some(Signal::Step(_))));
    type_into(&mut screen, " - mu x³");
    assert!(parameter(&screen, "mu").is_none(), "it is used when it is complete, not while it is typed");
    // A name is a parameter at once: truth and guess are apart, so that there is something to find.
    let number = |screen: &Screen, label: &str| screen.get_by_label(label).value();
    assert_eq!(number(&screen, "Truth of μ").as_deref(), Some("1"));
    assert_eq!(number(&screen, "Guess of μ").as_deref(), Some("1.3"));
    set(&mut screen, "Truth of μ", 2.0);
    set(&mut screen, "Guess of μ", 2.5);
    assert!(parameter(&screen, "mu").is_none());
    press(&mut screen, Key::Enter);
    screen.run_steps(20);
    assert_eq!(equation(&screen), "x'' + 2 ζ ωₙ x' + ωₙ² x = f - mu x³");
    assert_eq!(parameter(&screen, "mu"), Some(Signal::Constant(2.0)));
    let channel = scenario(&screen).channel("mu").expect("a channel");
    assert_eq!(scenario(&screen).filters[0].initial_mean[channel], 2.5);
    assert_eq!(scenario(&screen).assumed_parameters(), None, "it is named in the file");
    screen.get_by_label("It is in use.");
    for (label, value) in [("Parameter μ, value", 1.5), ("Truth of μ", 1.7)] {
        set(&mut screen, label, value);
        assert_eq!(parameter(&screen, "mu"), Some(Signal::Constant(value)), "{label}");
    }
    let session = screen.state().session();
    assert_eq!(session.problem(), None);
    let channels = session.run().estimates()[0].channels();
    assert!(channels.iter().any(|channel| channel.key() == "mu"), "{channels:?}");
}

#[test]
fn rows_come_and_go_with_the_names_and_a_mistake_is_said() {
    let mut screen = editor();
    let rows = |screen: &Screen| {
        let there = ["μ", "k₂", "q"].map(|symbol| screen.query_by_label(&format!("Guess of {symbol}")).is_some());
        there.into_iter().filter(|is| *is).count()
    };
    let is_usable = |screen: &Screen| !screen.get_by_label("Use it").accesskit_node().is_disabled();
    for (text, count, said, usable) in [
        ("", 0, None, true),
        (" - mu x³ + k2 sin(q x)", 3, None, true),
        (" - mu x³", 1, None, true),
        (" - mu sni(x)", 1, Some("“sni(” is no function: is it sin?"), false),
        (" - mu tanh(x) tau(x)", 1, None, true),
        (" - mu Sinh (x)", 1, Some("“Sinh(” is no function: is it sin?"), false),
        (" - mu X", 1, Some("X is a parameter here; the state is x."), true),
        (" - mu (2 x", 1, Some("an operator or `)` is expected here"), false),
        (" - mu x³ + k2 sin(q x)", 3, None, true),
    ] {
        let field = screen.get_by_label("Equation of motion");
        let _ = field.accesskit_node();
        field.focus();
        screen.run_steps(2);
        screen.key_press_modifiers(Modifiers::COMMAND, Key::A);
        screen.run_steps(2);
        screen.get_by_label("Equation of motion").type_text(&format!("x'' + ωₙ² x = f{text}"));
        screen.run_steps(2);
        assert_eq!((rows(&screen), is_usable(&screen)), (count, usable), "{text}");
        assert!(said.is_none_or(|said| screen.query_by_label_contains(said).is_some()), "{text}");
        if count == 3 {
            // Its number is remembered while the window is open.
            let value = screen.get_by_label("Guess of q").value();
            assert!(["1.3", "4"].contains(&value.as_deref().unwrap_or_default()), "{value:?}");
            set(&mut screen, "Guess of q", 4.0);
        }
    }
    assert_eq!(screen.get_by_label("Guess of q").value().as_deref(), Some("4"));
    click(&mut screen, "Use it");
    assert_eq!(equation(&screen), "x'' + ωₙ² x = f - mu x³ + k2 sin(q x)");
}

#[test]
fn a_fault_is_said_and_the_equation_from_before_stays() {
    let mut screen = editor();
    let before = equation(&screen).to_owned();
    type_into(&mut screen, " + (2 x");
    assert!(screen.query_by_label_contains("an operator or `)` is expected here, at character 35").is_some());
    press(&mut screen, Key::Enter);
    assert_eq!((equation(&screen), screen.state().session().problem()), (&*before, None));
    type_into(&mut screen, ")");
    press(&mut screen, Key::Enter);
    assert_eq!(equation(&screen), "x'' + 2 ζ ωₙ x' + ωₙ² x = f + (2 x)");
}

/// Presses the equation over the oscillator, which comes behind that of the settings.
fn edit(screen: &mut Screen) {
    screen.get_all_by_label("Edit the equation").last().expect("the equation").click();
    screen.run_steps(4);
}

/// A screen with an equation of a file, whose `k` is named and whose `c` is not.
fn of_file(text: &str) -> Screen {
    let mut screen = workbench();
    screen.state_mut().open_file("own.toml", Ok(text.as_bytes().to_vec()));
    screen.run_steps(10);
    screen
}

const OF_FILE: &str = "duration = 10.0\n[plant]\nequation = \"x'' + c x' + k x = f\"\nparameters = { k = { guess = 30.0 } }\n\
                       [[filters]]\nkind = \"ekf\"\n";

#[test]
fn the_equation_over_the_oscillator_opens_the_editor() {
    let mut screen = of_file(OF_FILE);
    assert!(screen.query_by_label("Equation of motion").is_none());
    edit(&mut screen);
    assert!(screen.query_by_label("Equation of motion").is_some());
    // A built-in plant's equation can be gone on with.
    let mut screen = workbench();
    edit(&mut screen);
    assert_eq!(scenario(&screen).plant.kind, PlantKind::SDOF, "nothing changes by looking");
    type_into(&mut screen, " - x³");
    press(&mut screen, Key::Enter);
    assert_eq!(equation(&screen), "x'' + 2 ζ ωₙ x' + ωₙ² x = f - x³");
}

#[test]
fn a_file_that_leaves_a_parameter_unnamed_is_told_so() {
    let screen = of_file(OF_FILE);
    let notice = screen.state().notice().map(str::to_owned).unwrap_or_default();
    assert!(notice.starts_with("Of the equation, c (guess 1) is taken for a parameter"), "{notice}");
    let named = OF_FILE.replace("{ k =", "{ c = {}, k =");
    assert_eq!(of_file(&named).state().notice(), None);
}

#[test]
fn parameters_are_edited_and_a_change_is_taken_back() {
    let mut screen = of_file(OF_FILE);
    edit(&mut screen);
    // A state that rests is one to go back to.
    screen.run_steps(120);
    let own = |screen: &Screen, key: &str| {
        let settings = scenario(screen).plant.kind.own_equation().expect("an equation").settings();
        settings.parameter(key).cloned().unwrap_or_default()
    };
    let guess = |screen: &Screen, key: &str| {
        let channel = scenario(screen).channel(key).expect("a channel");
        let filter = &scenario(screen).filters[0];
        (filter.initial_mean[channel], filter.initial_std[channel])
    };
    assert_eq!(guess(&screen, "k"), (30.0, 15.0));
    let before = scenario(&screen).clone();
    let width = |screen: &Screen| screen.get_by_label("Equation of motion").rect().width();
    let wide = width(&screen);
    set(&mut screen, "Guess of k", 40.0);
    assert_eq!((own(&screen, "k").guess, guess(&screen, "k")), (Some(40.0), (40.0, 20.0)));
    set(&mut screen, "σ of the guess of k", 3.0);
    assert_eq!((own(&screen, "k").std, guess(&screen, "k")), (Some(3.0), (40.0, 3.0)));
    for (field, text) in [("Name of k", "stiffness"), ("Unit of k", "1/s²")] {
        screen.get_by_label(field).focus();
        screen.run_steps(2);
        screen.get_by_label(field).type_text(text);
        screen.run_steps(2);
        press(&mut screen, Key::Enter);
    }
    let channel = *scenario(&screen).plant.kind.channels().last().expect("k");
    assert_eq!((channel.name(), channel.unit()), ("stiffness", "1/s²"));
    assert!(screen.query_by_label("Stiffness, value").is_some(), "the settings show its name");
    assert_eq!(width(&screen), wide, "the window keeps its width");
    // An impossible number is said and not taken.
    set(&mut screen, "Guess of k", 1e40);
    assert!(screen.query_by_label_contains("the numbers of `k` are impossible").is_some());
    assert_eq!(own(&screen, "k").guess, Some(40.0));
    screen.run_steps(120);
    let is_back = (0..8).any(|_| {
        undo(&mut screen);
        scenario(&screen) == &before
    });
    assert!(is_back, "{:?}", scenario(&screen).plant.kind);
    let shown = screen.get_by_label("Guess of k").value();
    assert_eq!(shown.as_deref(), Some("30"), "the editor goes along");
}

/// The accessible name says which picture shows the estimates: a mass, a pendulum or a circuit.
fn drawn(screen: &Screen) -> Option<&'static str> {
    let on = ["on the mass", "on the pendulum", "in the circuit"].into_iter();
    on.filter(|on| screen.query_all_by_label_contains(on).next().is_some()).last()
}

#[test]
fn a_typed_pendulum_is_drawn_as_one() {
    for (equation, on) in [("x'' + 9 sin(x) = f", "on the pendulum"), ("x'' + 9 x = f", "on the mass")] {
        let text = format!("duration = 5.0\nplant = {{ equation = \"{equation}\" }}\n[[filters]]\nkind = \"ekf\"\n");
        assert_eq!(drawn(&of_file(&text)), Some(on), "{equation}");
    }
}

#[test]
fn every_equation_of_the_gallery_is_shown_and_edited_on_any_screen() {
    for entry in std::fs::read_dir("assets/equations").expect("the gallery") {
        let path = entry.expect("a file").path();
        for size in [DESKTOP, PHONE] {
            let mut screen = screen(size, Theme::Dark);
            let text = std::fs::read(&path).map_err(|error| error.to_string());
            screen.state_mut().open_file("gallery.toml", text);
            screen.run_steps(10);
            if let Some(place) = screen.query_all_by_label("Edit the equation").last() {
                assert!(place.rect().height() >= 36.0, "{path:?}: {} is too low for a finger", place.rect());
                place.click();
                screen.run_steps(5);
                let field = screen.get_by_label("Equation of motion").rect();
                assert!(field.left() >= 0.0 && field.right() <= size.x, "{path:?}: {field}");
            } else {
                panic!("{path:?} at {size}: no equation over the oscillator");
            }
            assert_eq!(screen.state().notice(), None, "{path:?}");
            assert_eq!(
                drawn(&screen),
                match path.file_stem().and_then(|stem| stem.to_str()) {
                    Some("pendulum") => Some("on the pendulum"),
                    Some("rlc-circuit") => Some("in the circuit"),
                    Some("van-der-pol") => None,
                    _ => Some("on the mass"),
                },
                "{path:?}"
            );
        }
    }
}

fn parameter(screen: &Screen, key: &str) -> Option<Signal> {
    let plant = &scenario(screen).plant;
    let channel = plant.parameters().find(|channel| channel.key() == key)?;
    plant.parameter(channel)
}
