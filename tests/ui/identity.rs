//! Filters keep their identity when others are added or removed.

use kalmanscope_core::FilterSettings;

use super::*;

fn shown(screen: &Screen) -> Vec<(String, bool)> {
    let on = |name: &str| {
        let label = format!("Show {name}");
        let entry = screen.get_by_label(&label);
        entry.accesskit_node().toggled() == Some(accesskit::Toggled::True)
    };
    scenario(screen).filters.iter().map(|filter| (filter.name.clone(), on(&filter.name))).collect()
}

fn names(entries: &[(&str, bool)]) -> Vec<(String, bool)> {
    entries.iter().map(|(name, on)| ((*name).to_owned(), *on)).collect()
}

#[test]
fn a_hidden_filter_stays_hidden_when_another_goes() {
    let mut screen = workbench();
    click(&mut screen, "Add a filter");
    click(&mut screen, "Show UKF");
    assert_eq!(shown(&screen), names(&[("EKF", true), ("UKF", false), ("EKF 2", true)]));
    click(&mut screen, "Remove EKF");
    assert_eq!(shown(&screen), names(&[("UKF", false), ("EKF 2", true)]));
    press(&mut screen, Key::Num1);
    assert_eq!(shown(&screen), names(&[("UKF", true), ("EKF 2", true)]), "the key is that of the filter's place");
    // A new filter inherits nothing.
    click(&mut screen, "Show UKF");
    click(&mut screen, "Remove UKF");
    click(&mut screen, "Add a filter");
    assert_eq!(shown(&screen), names(&[("EKF 2", true), ("EKF", true)]));
}

#[test]
fn another_scenario_is_shown_with_all_its_filters() {
    let mut screen = workbench();
    click(&mut screen, "Show UKF");
    click(&mut screen, "Show measured");
    click(&mut screen, "Scenario");
    click(&mut screen, kalmanscope_lessons::BUILT_IN[2].title);
    assert!(shown(&screen).iter().all(|(_, on)| *on));
}

#[test]
fn removing_a_filter_changes_nothing_about_the_others() {
    let mut scenario = Scenario { duration: 5.0, ..Scenario::default() };
    let sensor_std = scenario.true_sensor_std();
    let sampled = FilterSettings { kind: FilterKind::ENKF, ensemble_size: 30, sensor_std, ..FilterSettings::default() };
    scenario.filters.push(FilterSettings { name: "EnKF".to_owned(), smoother: false, ..sampled });
    scenario.filters[1].smoother = true;
    let mut app = App::with_scenario(scenario).expect("the scenario can be run");
    let session = app.session_mut();
    session.set_mode(Mode::Whole);
    session.want(kalmanscope::session::Wanted::default());
    let numbers = |session: &kalmanscope::session::Session| -> HashMap<u32, (u64, u64, usize)> {
        let both = session.run().estimates().iter().zip(session.diagnostics());
        both.map(|(e, d)| (e.id(), (e.checksum(), d.log_likelihood().to_bits(), d.len()))).collect()
    };
    let before = numbers(session);
    assert_eq!(before.len(), 3);
    let mut fewer = session.scenario().clone();
    fewer.filters.remove(0);
    session.set_scenario(fewer);
    let after = numbers(session);
    assert_eq!(after.len(), 2);
    assert!(after.iter().all(|(id, numbers)| before[id] == *numbers), "{before:?}, then {after:?}");
    assert_eq!(session.smoothed().iter().map(kalmanscope_core::Estimates::id).collect::<Vec<_>>(), [2]);
}

/// Gives a filter another name by its field.
pub(super) fn rename(screen: &mut Screen, before: &str, more: &str) {
    let label = format!("Name of {before}");
    screen.get_by_label(&label).focus();
    screen.run_steps(2);
    screen.get_by_label(&label).type_text(more);
    screen.run_steps(4);
}

#[test]
fn a_renamed_filter_stays_hidden_and_open_and_knows_where_its_numbers_began() {
    let mut screen = workbench();
    click(&mut screen, "Show UKF");
    let color = |screen: &Screen| screen.state().session().run().estimates()[1].color();
    let (before, colored) = (scenario(&screen).filters[1].clone(), color(&screen));
    set(&mut screen, "UKF fading factor", 1.03);
    set(&mut screen, "UKF process std of velocity", 0.7);
    rename(&mut screen, "UKF", " of mine");
    let name = scenario(&screen).filters[1].name.clone();
    assert_ne!(name, "UKF");
    assert_eq!(shown(&screen), names(&[("EKF", true), (&name, false)]));
    assert_eq!(color(&screen), colored);
    // Its section is open, and a double click takes a number back to where it began.
    super::habits::double_click(&mut screen, &format!("{name} fading factor, value"));
    assert_eq!(scenario(&screen).filters[1].fading, before.fading);
    super::habits::double_click(&mut screen, &format!("{name} process std of velocity"));
    assert_eq!(scenario(&screen).filters[1].process_std, before.process_std);
}
