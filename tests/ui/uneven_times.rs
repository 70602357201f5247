//! Measured records whose times are uneven.

use std::fmt::Write as _;

use super::files::drop_file;
use super::records::rows;
use super::*;

/// The import of a file with two of three rows, each at a time of its own.
fn irregular() -> Screen {
    let mut screen = screen(Vec2::new(1280.0, 1000.0), Theme::Light);
    let mut text = "time,force,x (mm)\n".to_owned();
    for (k, [t, f, x]) in rows().into_iter().enumerate().filter(|(k, _)| k % 3 > 0) {
        writeln!(text, "{:.4},{f:.5},{x:.5}", t + 0.001 * (k * 7 % 13) as f64).expect("memory");
    }
    drop_file(&mut screen, "irregular.csv", text.as_bytes());
    screen.run_steps(3);
    screen
}

#[test]
fn irregular_times_are_kept_unless_even_steps_are_asked_for() {
    let mut screen = irregular();
    screen.get_by_label_contains("the filters take each reading at its own time");
    screen.get_by_label("Part, band and rate").click();
    screen.run_steps(30);
    screen.get_by_label("at even steps").click();
    screen.run_steps(30);
    screen.get_by_label_contains("even steps of");
    screen.get_by_label("at even steps").click();
    screen.run_steps(30);
    screen.get_by_label("Open the record").click();
    screen.run_steps(6);
    let session = screen.state_mut().session_mut();
    assert!(session.run().record().clocks().is_some());
    let said =
        |screen: &Screen| screen.query_all_by_label_contains("each reading counts at the sample after it").count();
    let mut scenario = session.scenario().clone();
    scenario.filters[0].jump = true;
    session.set_scenario(scenario);
    screen.run_steps(6);
    assert_eq!(said(&screen), 1);
}

/// The steps at which filters tell what they know are the user's choice, where readings keep their times.
#[test]
fn the_steps_of_a_record_with_its_own_times_are_chosen() {
    let mut screen = irregular();
    screen.get_by_label("Part, band and rate").click();
    screen.run_steps(30);
    screen.get_by_label("steps of").click();
    screen.run_steps(30);
    // Steps that are too short are refused, and can be made longer.
    set(&mut screen, "steps of [s]", 0.0);
    screen.run_steps(30);
    screen.get_by_label_contains("samples, but at most");
    set(&mut screen, "steps of [s]", 0.25);
    screen.run_steps(30);
    screen.get_by_label("Open the record").click();
    screen.run_steps(6);
    let record = screen.state().session().run().record();
    let readings = record.clocks().expect("it keeps its times").readings[0].times.len();
    assert!((record.dt() - 0.25).abs() < 1e-12 && readings > record.len(), "{readings} in {}", record.len());
}
