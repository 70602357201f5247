//! Predict and update: the flow of a step, and the same step by hand.

use kalmanscope::text::parse;

use super::*;

fn at_sample(size: Vec2, k: usize) -> Screen {
    let mut screen = screen(size, Theme::Light);
    show_whole(&mut screen, Scenario { duration: 20.0, ..Scenario::default() });
    show(&mut screen, &[ViewKind::Matrices]);
    let dt = scenario(&screen).dt;
    screen.state_mut().session_mut().seek(k as f64 * dt);
    screen.run_steps(4);
    screen
}

/// The words of the flow of the first filter.
fn flow(screen: &Screen) -> String {
    let mut all = screen.query_all_by_label_contains("Flow of EKF: ");
    all.next().and_then(|node| node.accesskit_node().label()).expect("there is a flow")
}

fn count(screen: &Screen, label: &str) -> usize {
    screen.query_all_by_label(label).count()
}

#[test]
fn the_flow_has_the_numbers_of_the_sample() {
    let mut screen = at_sample(DESKTOP, 400);
    let check = |screen: &Screen, channel: Channel, sensor: usize| {
        let (words, estimates) = (flow(screen), &screen.state().session().run().estimates()[0]);
        let (at, n) = (estimates.place(channel).expect("it is estimated"), estimates.channels().len());
        let numbers: Vec<f64> = words.split(" = ").skip(1).filter_map(|rest| parse(rest.split(',').next()?)).collect();
        let of = |k: usize| estimates.mean(k)[at];
        let expected = [of(399), estimates.innovation(400)[sensor], estimates.gain(400)[sensor * n + at], of(400)];
        assert_eq!(numbers.len(), 4, "{words}");
        let near = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-2 * b.abs() + 1e-5;
        assert!(numbers.iter().zip(&expected).all(near), "{words}: {expected:?}");
    };
    check(&screen, Channel::NATURAL_FREQUENCY, 0);
    click(&mut screen, "from e(v)");
    click(&mut screen, "Channel of the step");
    click(&mut screen, "x displacement");
    check(&screen, Channel::DISPLACEMENT, 1);
}

#[test]
fn a_reader_fills_in_the_results() {
    let mut screen = at_sample(DESKTOP, 400);
    let told = flow(&screen);
    click(&mut screen, "Hide results");
    let filters = count(&screen, "Show K");
    assert!(
        filters > 0
            && ["ωₙ⁻", "P⁻", "e", "S", "K e", "ωₙ", "P"].map(|of| count(&screen, &format!("Show {of}")))
                == [filters; 7]
    );
    let hidden = flow(&screen);
    assert!(hidden.contains("e = ?, K = ?") && hidden.ends_with("= ?"), "{hidden}");
    screen.query_all_by_label("Show K").next().expect("it is hidden").click_accesskit();
    screen.run_steps(4);
    assert_eq!(count(&screen, "Show K"), filters - 1);
    assert!(!flow(&screen).contains("K = ?") && flow(&screen) != told);
    screen.state_mut().session_mut().step();
    screen.run_steps(4);
    assert_eq!(count(&screen, "Show K"), filters, "the next step is hidden again");
}

#[test]
fn the_first_sample_and_missing_readings_are_said() {
    let mut screen = at_sample(PHONE, 0);
    assert!(screen.query_all_by_label_contains("The initial belief").next().is_some());
    let mut scenario = scenario(&screen).clone();
    let toml = scenario.to_toml().expect("it can be written");
    let toml = toml.replace("noise_std", "faults = { dropouts = { share = 1.0, length = 0.0 } }\nnoise_std");
    scenario = Scenario::from_toml(&toml).expect("it can be read");
    show_whole(&mut screen, scenario);
    screen.state_mut().session_mut().seek(1.5);
    screen.run_steps(4);
    assert!(count(&screen, "No reading: the belief stays as predicted.") > 0);
    assert!(flow(&screen).contains("no reading"));
    let rect = screen.query_all_by_label_contains("Flow of EKF: ").next().expect("there is a flow").rect();
    assert!(rect.left() >= 0.0 && rect.right() <= PHONE.x && rect.height() > 250.0, "it fits a phone: {rect}");
}
