//! Verdicts: chips, their evidence, causes and edits, and hiding them.

use super::*;

fn mistuned() -> Screen {
    let mut screen = screen(Vec2::new(1280.0, 2400.0), Theme::Light);
    let mut scenario = Scenario::default();
    scenario.filters[0].sensor_std = scenario.filters[0].sensor_std.iter().map(|std| 0.2 * std).collect();
    show_whole(&mut screen, scenario);
    screen.run_steps(20);
    screen
}

#[test]
fn a_verdict_beside_a_filter_opens_the_diagnosis() {
    let mut screen = mistuned();
    assert!(screen.query_by_label("UKF has recovered").is_some());
    assert!(screen.query_by_label("About Diagnosis").is_none());
    for _ in 0..2 {
        click(&mut screen, "EKF is overconfident");
        assert!(screen.query_by_label("About Diagnosis").is_some());
    }
}

#[test]
fn a_remedy_is_applied_by_its_button_and_taken_back() {
    let mut screen = mistuned();
    click(&mut screen, "EKF is overconfident");
    // Long enough for a state to go back to.
    screen.run_steps(80);
    let before = scenario(&screen).clone();
    screen.get_by_label_contains("less likely").click();
    screen.run_steps(20);
    click(&mut screen, "Apply the remedy of EKF: R of a sensor");
    screen.run_steps(20);
    let stds = &scenario(&screen).filters[0].sensor_std;
    for (std, right) in stds.iter().zip(&Scenario::default().filters[0].sensor_std) {
        assert!((std / right - 1.0).abs() < 0.2, "{std} in place of {right}");
    }
    assert_eq!(scenario(&screen).filters[1], before.filters[1]);
    assert!(screen.query_by_label("EKF has recovered").is_some());
    undo(&mut screen);
    assert_eq!(scenario(&screen), &before);
    assert!(screen.query_by_label("EKF is overconfident").is_some());
    screen.run_steps(80);
    click(&mut screen, "Apply the remedy of all filters: R of a sensor");
    let filters = &scenario(&screen).filters;
    assert_eq!(filters[0].sensor_std, filters[1].sensor_std);
}

#[test]
fn evidence_says_how_to_read_it() {
    let mut screen = mistuned();
    click(&mut screen, "EKF is overconfident");
    assert!(screen.query_by_label_contains("How to read it").is_none());
    click(&mut screen, "Evidence");
    screen.get_all_by_label_contains("times what the filter expects ▸").next().expect("evidence").click();
    screen.run_steps(4);
    assert!(screen.query_by_label_contains("How to read it").is_some());
}

#[test]
fn verdicts_can_be_hidden() {
    let mut screen = mistuned();
    click(&mut screen, "Show verdicts");
    assert!(screen.query_by_label("UKF has recovered").is_none());
    assert!(screen.query_by_label("EKF is overconfident").is_none());
    click(&mut screen, "Show verdicts");
    assert!(screen.query_by_label("UKF has recovered").is_some());
}

#[test]
fn live_verdicts_come_with_the_record() {
    let mut screen = screen(DESKTOP, Theme::Light);
    assert!(screen.query_by_label_contains("EKF is ").is_none());
    screen.run_steps(120);
    assert!(screen.query_by_label("EKF is consistent").is_some());
}

#[test]
fn a_verdict_on_a_phone_opens_the_diagnosis_below_the_plots() {
    let mut screen = screen(PHONE, Theme::Light);
    screen.run_steps(120);
    click(&mut screen, "EKF is consistent");
    assert!(screen.query_by_label("About Diagnosis").is_some());
    let top = screen.get_by_label_contains("Make the diagnosis ").rect().top();
    assert!(screen.get_by_label("Plot of the natural frequency").rect().top() < top && top > 0.4 * PHONE.y);
    click(&mut screen, "Close the diagnosis");
    assert!(screen.query_by_label("About Diagnosis").is_none());
}

#[test]
fn nothing_moves_under_the_pointer_when_a_cause_is_repaired() {
    let mut screen = mistuned();
    let mut scenario = scenario(&screen).clone();
    // The second fault is left when the first is repaired.
    scenario.filters[0].initial_mean[Channel::NATURAL_FREQUENCY] = 14.0;
    scenario.filters[0].initial_std[Channel::NATURAL_FREQUENCY] = 0.3;
    screen.state_mut().session_mut().set_scenario(scenario);
    screen.run_steps(20);
    let chip = verdict(&screen, "EKF").expect("EKF has a verdict");
    click_on(&mut screen, chip.center());
    screen.run_steps(20);
    let place = |screen: &Screen| {
        ["About Diagnosis", "Likely causes, best remedy first"]
            .map(|label| screen.query_all_by_label(label).map(|node| node.rect().top()).next())
    };
    let before = place(&screen);
    let first = |screen: &Screen| {
        let edits = screen.query_all_by_label_contains("Apply the remedy of EKF");
        edits.map(|node| node.rect()).min_by(|a, b| a.top().total_cmp(&b.top()))
    };
    let button = first(&screen).expect("a cause with a edit");
    super::hand::click_at(&mut screen, button.center(), Modifiers::NONE);
    screen.run_steps(20);
    assert!(screen.query_by_label_contains("before: ").is_some(), "there is a chip now");
    let after = place(&screen);
    assert_eq!(after[0], before[0], "the view has moved");
    if let Some(again) = first(&screen) {
        assert_eq!(after[1], before[1], "the causes have moved");
        assert!((again.top() - button.top()).abs() < 1.0, "the first edit was at {button} and is at {again}");
    }
}

fn remedies_of_ekf(screen: &Screen) -> Vec<(String, f32)> {
    let edits = screen.query_all_by_label_contains("Apply the remedy of EKF");
    edits.map(|node| (node.accesskit_node().label().unwrap_or_default(), node.rect().top())).collect()
}

#[test]
fn causes_keep_their_places_under_the_pointer_while_others_are_tried() {
    let mut screen = mistuned();
    click(&mut screen, "EKF is overconfident");
    let mut scenario = scenario(&screen).clone();
    // Two faults: remedies of one cause grow to those of several while they are searched for.
    scenario.filters[0].initial_mean[Channel::NATURAL_FREQUENCY] = 14.0;
    scenario.filters[0].initial_std[Channel::NATURAL_FREQUENCY] = 0.3;
    screen.state_mut().session_mut().set_budget(Budget::Pieces(8));
    screen.state_mut().session_mut().set_scenario(scenario);
    let mut seen: Vec<(String, f32)> = Vec::new();
    let (mut frames, mut is_done) = (0, false);
    while !is_done && frames < 20_000 {
        screen.step();
        frames += 1;
        let session = screen.state().session();
        is_done = !session.behind() && !session.is_trying() && frames > 5;
        let now = remedies_of_ekf(&screen);
        if seen.is_empty() && !now.is_empty() {
            let button = screen.get_by_label(&now[0].0).rect();
            screen.hover_at(button.center());
            seen = now;
            continue;
        }
        for (label, top) in &seen {
            let again = now.iter().find(|(other, _)| other == label);
            assert_eq!(again.map(|(_, top)| *top), Some(*top), "{label} has moved or is gone in frame {frames}");
        }
        seen.extend(
            now.into_iter().filter(|(label, _)| seen.iter().all(|(other, _)| other != label)).collect::<Vec<_>>(),
        );
    }
    assert!(is_done, "the search ends");
    assert!(!seen.is_empty());
    screen.run_steps(5);
    assert_eq!(remedies_of_ekf(&screen), seen, "at the end too");
    // Their order comes once the hand has gone.
    screen.remove_cursor();
    screen.run_steps(150);
    screen.get_by_label("Likely causes, best remedy first");
}

/// Two filters may have one colour: a click on the line of the second opens its diagnosis, not that of the first.
#[test]
fn a_click_on_a_line_finds_its_filter_though_another_one_has_its_colour() {
    let mut screen = screen(Vec2::new(1280.0, 800.0), Theme::Light);
    *screen.state_mut().layout_mut() = ViewLayout::column(&[ViewKind::Errors]);
    let mut scenario = Scenario::default();
    scenario.filters[1].color = scenario.filters[0].color;
    scenario.filters[1].initial_mean[Channel::NATURAL_FREQUENCY] = 14.0;
    show_whole(&mut screen, scenario);
    screen.run_steps(20);
    let mut opened = std::collections::BTreeSet::new();
    for step in 0..60 {
        // The diagnosis stands beside the plot once it is open.
        let plot = screen.get_by_label("Plot of the error of the natural frequency").rect();
        let at = egui::pos2(plot.left() + 0.03 * plot.width(), plot.top() + step as f32 / 60.0 * plot.height());
        screen.hover_at(at);
        screen.run_steps(2);
        if screen.output().platform_output.cursor_icon == egui::CursorIcon::PointingHand {
            hand::click_at(&mut screen, at, Modifiers::NONE);
            opened.extend(["EKF", "UKF"].into_iter().filter(|name| {
                let tab = format!("Diagnosis of {name}");
                let tab = screen.query_by_label(&tab);
                tab.is_some_and(|tab| tab.accesskit_node().toggled() == Some(accesskit::Toggled::True))
            }));
        }
    }
    assert_eq!(opened.into_iter().collect::<Vec<_>>(), ["EKF", "UKF"]);
}
