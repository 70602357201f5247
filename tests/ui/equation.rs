//! The plant's equation is typed.

use super::*;

/// The equation of the true plant.
fn equation(screen: &Screen) -> &'static str {
    scenario(screen).plant.kind.equation()
}

fn type_into(screen: &mut Screen, text: &str) {
    screen.get_by_label("Equation of motion").focus();
    screen.run_steps(2);
    screen.get_by_label("Equation of motion").type_text(text);
    screen.run_steps(2);
}

#[test]
fn an_equation_is_typed_and_identified() {
    let mut screen = workbench();
    choose(&mut screen, "Kind of plant", "equation of your own");
    assert_eq!(equation(&screen), "x'' + 2 ζ ωₙ x' + ωₙ² x = f");
    // The parameters keep their numbers, and what is estimated is the same.
    assert!(matches!(parameter(&screen, "natural_frequency"), Some(Signal::Step(_))));
    type_into(&mut screen, " - mu x³");
    assert!(parameter(&screen, "mu").is_none(), "it is taken with Enter, not while it is typed");
    screen.key_press(Key::Enter);
    screen.run_steps(20);
    assert_eq!(equation(&screen), "x'' + 2 ζ ωₙ x' + ωₙ² x = f - mu x³");
    assert_eq!(parameter(&screen, "mu"), Some(Signal::Constant(1.0)));
    set(&mut screen, "Parameter μ, value", 1.5);
    assert_eq!(parameter(&screen, "mu"), Some(Signal::Constant(1.5)));
    let session = screen.state().session();
    assert_eq!(session.problem(), None);
    let channels = session.run().estimates()[0].channels();
    assert!(channels.iter().any(|channel| channel.key() == "mu"), "{channels:?}");
}

#[test]
fn a_fault_is_said_and_the_equation_from_before_stays() {
    let mut screen = workbench();
    choose(&mut screen, "Kind of plant", "equation of your own");
    let before = equation(&screen);
    type_into(&mut screen, " + (2 x");
    assert!(screen.query_by_label_contains("an operator or `)` is expected here, at character 35").is_some());
    screen.key_press(Key::Enter);
    screen.run_steps(5);
    assert_eq!((equation(&screen), screen.state().session().problem()), (before, None));
    type_into(&mut screen, ")");
    screen.key_press(Key::Enter);
    screen.run_steps(5);
    assert_eq!(equation(&screen), "x'' + 2 ζ ωₙ x' + ωₙ² x = f + (2 x)");
}

/// A parameter of the truth by its key.
fn parameter(screen: &Screen, key: &str) -> Option<Signal> {
    let plant = &scenario(screen).plant;
    let channel = plant.parameters().find(|channel| channel.key() == key)?;
    plant.parameter(channel)
}
