//! The view of the frequency response.

use super::*;

fn shown(scenario: Scenario) -> Screen {
    let mut screen = workbench();
    *screen.state_mut().layout_mut() = Layout::column(&[ViewKind::FrequencyResponse]);
    let session = screen.state_mut().session_mut();
    session.set_scenario(scenario);
    session.set_mode(Mode::Whole);
    screen.run_steps(3);
    screen
}

#[test]
fn values_are_those_of_the_frequency_pointed_at_else_of_the_peak() {
    let mut screen = shown(Scenario::default());
    // The truth at its peak, 1 / (2ζωₙ²√(1 - ζ²)).
    assert!(screen.query_by_label("0.278").is_some());
    let plot = screen.get_by_label("Plot of the frequency response").rect();
    screen.hover_at(plot.right_center() - Vec2::new(20.0, 0.0));
    screen.run_steps(3);
    assert!(screen.query_by_label("0.278").is_none());
    screen.hover_at(plot.right_bottom() + Vec2::new(-20.0, 30.0));
    screen.run_steps(3);
    screen.get_by_label("Show truth").click();
    screen.get_by_label("Show EKF").click();
    screen.get_by_label("Show UKF").click();
    screen.run_steps(3);
    assert!(screen.query_by_label("|H|").is_none(), "nothing is shown");
}

#[test]
fn every_scenario_has_a_response_and_strange_ones_do_no_harm() {
    let mut undamped = Scenario::default();
    undamped.plant.set(Channel::DAMPING_RATIO, Signal::Constant(0.0));
    undamped.filters[0].initial_mean[Channel::NATURAL_FREQUENCY] = 0.0;
    undamped.filters[0].initial_std[Channel::DAMPING_RATIO] = 0.0;
    let loose = {
        let mut loose = undamped.clone();
        loose.plant.set(Channel::NATURAL_FREQUENCY, Signal::Constant(1e-3));
        loose
    };
    let coarse = Scenario { dt: 0.5, ..Scenario::default() };
    let alone = Scenario { filters: vec![], force: Force::None, ..Scenario::default() };
    let strange = [undamped, loose, coarse, alone];
    let all = kalmanscope_lessons::BUILT_IN.iter().map(|entry| entry.scenario().unwrap()).chain(strange);
    let mut screen = shown(Scenario::default());
    for scenario in all {
        screen.state_mut().session_mut().set_scenario(scenario);
        for time in [0.0, 3.0, 1e9] {
            screen.state_mut().session_mut().seek(time);
            screen.run_steps(2);
            assert!(screen.query_by_label("|H|").is_some(), "at {time} s");
        }
    }
}
