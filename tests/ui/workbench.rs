//! Lessons, views, filters side by side, undo and messages about problems.

use super::*;

#[test]
fn every_lesson_can_be_taken_from_beginning_to_end() {
    let mut screen = workbench();
    let lessons: Vec<_> = kalmanscope_lessons::lessons().into_iter().map(Result::unwrap).collect();
    assert!(lessons.len() >= 12);
    for lesson in &lessons {
        click(&mut screen, "Lessons");
        click(&mut screen, &lesson.title);
        for (i, step) in lesson.steps.iter().enumerate() {
            assert!(screen.query_by_label(&step.look).is_some(), "{}, step {}", lesson.title, i + 1);
            if step.question.is_some() {
                assert!(screen.query_by_label(&step.why).is_none(), "{} gives the answer away", lesson.title);
                click(&mut screen, "Show me");
            }
            if let Some(change) = &step.change {
                let before = scenario(&screen).clone();
                assert!(screen.query_by_label(&step.why).is_none(), "{} gives its secret away", lesson.title);
                click(&mut screen, &change.label);
                assert_ne!(&before, scenario(&screen), "{}: {} changes nothing", lesson.title, change.label);
            }
            assert_eq!(scenario(&screen), &lesson.scenario_at(i).unwrap(), "{}, step {}", lesson.title, i + 1);
            assert_eq!((screen.state().session().problem(), screen.state().notice()), (None, None));
            assert!(screen.query_by_label(&step.why).is_some(), "{}, step {}", lesson.title, i + 1);
            for check in step.checks.iter().filter(|check| check.is_of_verdict()) {
                let chip = verdict(&screen, &check.filter);
                assert!(chip.is_some(), "{}, step {}: no verdict is in sight", lesson.title, i + 1);
            }
            let next = if i + 1 < lesson.steps.len() { "Next" } else { "Done" };
            click(&mut screen, next);
        }
        assert!(screen.query_by_label("Leave the lesson").is_none());
    }
}

#[test]
fn every_view_can_be_shown_enlarged_and_hidden() {
    let mut screen = workbench();
    screen.state_mut().session_mut().set_mode(Mode::Whole);
    for kind in ViewKind::ALL {
        let name = view(kind).name;
        for arrangement in Arrangement::ALL {
            *screen.state_mut().layout_mut() = ViewLayout::of(arrangement);
            let shown = screen.state_mut().layout_mut().shown().contains(&kind);
            screen.state_mut().layout_mut().toggle(kind);
            screen.run_steps(2);
            assert_eq!(screen.query_by_label(&format!("About {name}")).is_some(), !shown, "{name}");
        }
        let beside = if kind == ViewKind::Oscillator { ViewKind::States } else { ViewKind::Oscillator };
        show(&mut screen, &[kind, beside]);
        let top = |screen: &Screen| screen.get_by_label(&format!("Hide {name}")).rect().top();
        let before = top(&screen);
        let about_beside = format!("About {}", view(beside).name);
        click(&mut screen, &format!("Enlarge {name}"));
        assert!(screen.query_by_label(&about_beside).is_none(), "{name} is not alone");
        click(&mut screen, &format!("Enlarge {name}"));
        assert!(screen.query_by_label(&about_beside).is_some() && top(&screen) == before);
        click(&mut screen, &format!("Hide {name}"));
        assert!(screen.query_by_label(&format!("About {name}")).is_none());
        let help = view(kind).help;
        assert!(help.iter().all(|line| line.len() > 30 && line.ends_with('.')), "{name}");
    }
}

#[test]
fn filters_can_be_added_duplicated_renamed_and_removed() {
    let mut screen = workbench();
    let names = |screen: &Screen| scenario(screen).filters.iter().map(|f| f.name.clone()).collect::<Vec<_>>();
    click(&mut screen, "Add a filter");
    assert_eq!(names(&screen), ["EKF", "UKF", "EKF 2"]);
    click(&mut screen, "Duplicate EKF");
    assert_eq!(names(&screen), ["EKF", "EKF 3", "UKF", "EKF 2"]);
    assert_eq!(screen.state().session().run().estimates().len(), 4);
    let field = screen.get_by_label("Name of EKF");
    field.focus();
    field.type_text(" of old");
    screen.run_steps(3);
    assert_eq!(names(&screen)[0], "EKF of old");
    click(&mut screen, "Remove EKF of old");
    assert_eq!(names(&screen), ["EKF 3", "UKF", "EKF 2"]);
    assert_eq!(screen.state().session().problem(), None);
}

#[test]
fn the_options_of_a_filter_reach_the_scenario() {
    let mut screen = workbench();
    let first = |screen: &Screen| scenario(screen).filters[0].clone();
    open_options(&mut screen);
    choose(&mut screen, "EKF plant", "Duffing oscillator");
    assert_eq!(first(&screen).plant, Some(PlantKind::DUFFING));
    choose(&mut screen, "EKF steps", "Euler");
    assert_eq!(first(&screen).propagation, Some(kalmanscope_core::Propagation::Euler));
    for text in ["logarithms of positive parameters", "learn R from the innovations", "learn Q from the innovations"] {
        let before = first(&screen);
        click(&mut screen, &format!("EKF: {text}"));
        assert_ne!(first(&screen), before, "{text}");
    }
    assert_eq!(screen.state().session().problem(), None);
}

#[test]
fn a_change_can_be_undone_and_made_again() {
    let mut screen = workbench();
    screen.run_steps(8);
    let before = scenario(&screen).clone();
    set(&mut screen, "EKF fading factor, value", 1.02);
    let after = scenario(&screen).clone();
    assert_ne!(before, after);
    screen.run_steps(20);
    undo(&mut screen);
    assert_eq!(scenario(&screen), &before);
    screen.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    screen.run_steps(3);
    assert_eq!(scenario(&screen), &after);
    for (button, expected) in [("Undo", &before), ("Redo", &after)] {
        click(&mut screen, button);
        assert_eq!(scenario(&screen), expected, "{button}");
    }
}

#[test]
fn problems_are_reported() {
    let mut screen = workbench();
    let mut wound_up = kalmanscope_lessons::BUILT_IN[9].scenario().unwrap();
    assert_eq!(wound_up.force, Force::None);
    wound_up.filters[0].fading = 1.02;
    screen.state_mut().session_mut().set_mode(Mode::Whole);
    set_scenario(&mut screen, wound_up);
    assert!(screen.query_by_label_contains("the covariance winds up").is_some());
    let mut runaway = Scenario::default();
    runaway.set_plant(PlantKind::DUFFING);
    runaway.plant.set(Channel::CUBIC_STIFFNESS, Signal::Constant(-300.0));
    runaway.plant.initial.displacement = 0.5;
    set_scenario(&mut screen, runaway);
    assert!(screen.query_by_label_contains("the plant is unstable").is_some());
}

#[test]
fn a_lesson_whose_filter_is_gone_begins_its_step_again() {
    let mut screen = workbench();
    let lesson = super::lessons::built_in("Fading memory and a sudden loss");
    for label in ["Lessons", &lesson.title, "Show me", "Next"] {
        click(&mut screen, label);
    }
    let mut without = scenario(&screen).clone();
    without.filters.clear();
    set_scenario(&mut screen, without);
    click(&mut screen, &lesson.steps[1].change.as_ref().unwrap().label);
    assert_eq!(scenario(&screen), &lesson.scenario_at(0).unwrap());
    assert!(screen.query_by_label(&lesson.steps[1].look).is_some());
}
