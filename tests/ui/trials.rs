//! The laboratory of one's own oscillator: trials are added, weighed, shared and saved.

use egui::Event;

use super::*;

/// A paused screen with the view alone, over a whole record of the default oscillator.
fn trials(size: Vec2) -> Screen {
    let mut screen = screen(size, Theme::Light);
    *screen.state_mut().layout_mut() = Layout::column(&[ViewKind::Trials]);
    whole(&mut screen, Scenario { duration: 40.0, ..Scenario::default() });
    screen
}

fn whole(screen: &mut Screen, scenario: Scenario) {
    let session = screen.state_mut().session_mut();
    session.set_scenario(scenario);
    session.set_mode(Mode::Whole);
    session.pause();
    screen.run_steps(6);
}

fn add(screen: &mut Screen) {
    screen.get_by_label("Add this run").click();
    screen.run_steps(3);
}

/// The scenario of an oscillator with stiffness k and mass m₀ + m, in the units of the default one.
fn weighed(mass: f64, seed: u64) -> Scenario {
    let mut scenario = Scenario { duration: 40.0, seed, ..Scenario::default() };
    scenario.plant.set(Channel::NATURAL_FREQUENCY, f64::sqrt(24.0 / (0.5 + mass)));
    scenario
}

#[test]
fn without_trials_it_says_what_to_build() {
    let screen = trials(DESKTOP);
    for name in ["On a rubber band", "At the end of a ruler", "On a plank", "Beside a fork"] {
        assert!(screen.query_by_label(name).is_some(), "{name}");
    }
}

#[test]
fn several_masses_tell_the_stiffness_that_was_simulated() {
    let mut screen = trials(DESKTOP);
    for (place, mass) in [0.0, 0.1, 0.2, 0.3].into_iter().enumerate() {
        whole(&mut screen, weighed(mass, 7 + place as u64));
        add(&mut screen);
        let mut rows = screen.state().laboratory().trials().rows().to_vec();
        assert_eq!(rows.len(), place + 1);
        rows[place].mass = mass;
        screen.state_mut().laboratory_mut().trials_mut().keep(rows);
    }
    screen.run_steps(3);
    let spring = kalmanscope_lab::Spring::of(screen.state().laboratory().trials().rows()).expect("the masses differ");
    assert!((spring.stiffness.mean - 24.0).abs() < 2.0 * spring.stiffness.band(), "{spring:?}");
    assert!(spring.stiffness.band() < 2.0, "{spring:?}");
    assert!(screen.query_by_label_contains("swing beside the added mass").is_some());
    assert!(screen.query_by_label("Plot of the period squared over added mass").is_some());
}

#[test]
fn a_plant_without_such_a_frequency_says_why_there_is_nothing_to_add() {
    let mut screen = trials(DESKTOP);
    let mut scenario = Scenario { duration: 10.0, ..Scenario::default() };
    scenario.set_plant(PlantKind::SHEAR_2);
    whole(&mut screen, scenario);
    add(&mut screen);
    assert!(screen.state().laboratory().trials().rows().is_empty());
}

#[test]
fn links_of_a_class_are_collected_once() {
    let mut links = String::new();
    for seed in 1..4 {
        let mut student = trials(DESKTOP);
        whole(&mut student, weighed(0.0, seed));
        add(&mut student);
        links += &format!("Student {seed}: {}\n", student.state().link().expect("it is short enough"));
    }
    let mut teacher = trials(DESKTOP);
    let without = teacher.state().link().expect("it is short enough");
    for expected in [3, 3] {
        teacher.event(Event::Paste(format!("{links}{without}\nhttps://host/#link=1.xyz\n")));
        teacher.run_steps(4);
        assert_eq!(teacher.state().laboratory().trials().rows().len(), expected);
    }
    assert!(teacher.query_by_label_contains("Links: 5, new trials: 0, there already, or without room: 3").is_some());
    assert!(teacher.query_by_label_contains("damaged links: 1.").is_some());
    assert!(teacher.query_by_label_contains("3 trials:").is_some());
    // A link to the teacher's picture brings all of them, beside those that are there.
    let link = teacher.state().link().expect("it is short enough");
    let mut other = trials(DESKTOP);
    add(&mut other);
    other.state_mut().open_address(&link);
    other.run_steps(4);
    assert_eq!(other.state().laboratory().trials().rows().len(), 4);
}

#[test]
fn trials_are_kept_for_the_next_start_and_removed_ones_come_back() {
    let mut screen = trials(PHONE);
    add(&mut screen);
    let kept = screen.state().laboratory().trials().rows().to_vec();
    assert_eq!(kept.len(), 1);
    let text = screen.state().saved().text().expect("it can be written");
    screen.get_by_label("Remove row 1").click();
    screen.run_steps(3);
    assert!(screen.state().laboratory().trials().rows().is_empty());
    let saved: serde_json::Value = serde_json::from_str(&text).expect("it is JSON");
    assert_eq!(saved["trials"].as_array().map(Vec::len), Some(1));
    screen.get_by_label("Bring back").click();
    screen.run_steps(3);
    assert_eq!(screen.state().laboratory().trials().rows(), kept);
}
