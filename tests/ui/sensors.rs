//! Which sensor next: the sentence, its menus, and a sensor that is added and comes true.

use super::*;

fn compare(size: Vec2) -> Screen {
    let mut scenario = Scenario { duration: 10.0, ..Scenario::default() };
    scenario.set_sensors(&[Quantity::DISPLACEMENT]);
    scenario.filters.truncate(1);
    let mut screen = screen(size, Theme::Light);
    show_whole(&mut screen, scenario);
    show(&mut screen, &[ViewKind::Sensors]);
    screen
}

#[test]
fn a_sensor_is_added_and_the_comparison_follows() {
    let mut screen = compare(DESKTOP);
    assert!(screen.query_by_label_contains("sensor would narrow ωₙ most: ±").is_some());
    assert!(screen.query_by_label("Today's sensors").is_some());
    click(&mut screen, "Add: velocity");
    assert_eq!(scenario(&screen).measured(), [Quantity::DISPLACEMENT, Quantity::VELOCITY]);
    assert!(screen.query_by_label("Add: velocity").is_none() && screen.query_by_label("Add: acceleration").is_some());
    click(&mut screen, "Add: acceleration");
    assert!(screen.query_by_label_contains("No sensor is left to add").is_some());
    click(&mut screen, "Place of the new sensor");
    click(&mut screen, "alone");
    assert!(screen.query_by_label_contains("alone would give ωₙ best").is_some());
    // An undo takes back what is changed within a second.
    screen.run_steps(90);
    click(&mut screen, "Use alone: acceleration");
    assert_eq!(scenario(&screen).measured(), [Quantity::ACCELERATION]);
    click(&mut screen, "Undo");
    assert_eq!(scenario(&screen).sensors.len(), 3);
}

#[test]
fn a_narrow_view_has_the_chosen_parameter() {
    let mut screen = compare(PHONE);
    click(&mut screen, "Parameter to narrow");
    click(&mut screen, "ζ");
    click(&mut screen, "Duration of the record");
    click(&mut screen, "20 s, ×2");
    assert!(screen.query_by_label_contains("narrow ζ most, with 2 times the duration: ±").is_some());
    let add = screen.get_by_label("Add: velocity").rect();
    assert!(add.right() <= PHONE.x, "{add}");
}
