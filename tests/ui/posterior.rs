//! The posterior of a filter's parameters in the plane of the parameters.

use super::*;

/// A paused screen of the plane, of a short record whose parameters do not change.
fn plane(size: Vec2, theme: Theme, change: impl Fn(&mut Scenario)) -> Screen {
    let mut screen = super::screen(size, theme);
    *screen.state_mut().layout_mut() = Layout::column(&[ViewKind::ParameterPlane]);
    let mut scenario = Scenario { duration: 4.0, ..Scenario::default() };
    change(&mut scenario);
    show_whole(&mut screen, scenario);
    screen.state_mut().session_mut().seek(4.0);
    screen.run_steps(30);
    screen
}

/// Frames until the points are there; none before the scenario has stood still.
fn wait(screen: &mut Screen) {
    for _ in 0..3000 {
        screen.step();
        let posteriors = &screen.state().laboratory.posteriors;
        if posteriors.problem.as_deref().is_some() || posteriors.shown.as_ref().is_some_and(|shown| shown.is_of_now) {
            break;
        }
    }
    screen.run_steps(2);
}

fn chosen(screen: &Screen) -> Option<u32> {
    screen.state().laboratory.posteriors.chosen
}

#[test]
fn a_filter_that_remembers_everything_has_the_bands_of_the_posterior() {
    for (size, theme) in [(DESKTOP, Theme::Light), (PHONE, Theme::Dark)] {
        let mut screen = plane(size, theme, |scenario| {
            for filter in &mut scenario.filters {
                (filter.fading, filter.process_std) = (1.0, kalmanscope_core::Values::ZERO);
            }
        });
        choose(&mut screen, "Filter of the posterior", "EKF");
        wait(&mut screen);
        let filter = scenario(&screen).filters[0].id;
        assert_eq!(chosen(&screen), Some(filter));
        let posteriors = &screen.state().laboratory.posteriors;
        let shown = posteriors.shown.as_ref().expect("there are points");
        let estimates = &screen.state().session().run().estimates()[0];
        for &channel in &shown.sampled.channels {
            let [mean, std] = shown.sampled.moments(channel).expect("it is one of its parameters");
            let (place, last) = (estimates.place(channel).expect("the filter has it"), shown.last().0);
            assert!((estimates.std(last, place) / std - 1.0).abs() < 0.2, "{channel:?}");
            assert!((estimates.canonical_mean(last, place) - mean).abs() < 1.5 * std, "{channel:?}");
        }
        assert!(screen.query_by_label_contains("At 4.00 s its ±2σ is").is_some());
        assert!(screen.query_by_label_contains("lets the parameters change").is_none());
        choose(&mut screen, "Filter of the posterior", "none");
        screen.run_steps(2);
        assert!(screen.state().laboratory.posteriors.shown.as_ref().is_none());
    }
}

#[test]
fn points_follow_the_time_and_the_settings() {
    let mut screen = plane(DESKTOP, Theme::Light, |_| ());
    choose(&mut screen, "Filter of the posterior", "EKF");
    wait(&mut screen);
    assert!(screen.query_by_label_contains("lets the parameters change").is_some(), "it forgets");
    screen.state_mut().session_mut().seek(2.0);
    screen.run_steps(2);
    let posteriors = &screen.state().laboratory.posteriors;
    assert!(posteriors.shown.as_ref().is_some_and(|shown| !shown.is_of_now), "those of the other time stay meanwhile");
    wait(&mut screen);
    assert!(screen.query_by_label_contains("At 2.00 s its ±2σ is").is_some());
    set(&mut screen, "EKF fading factor", 1.03);
    screen.run_steps(2);
    assert!(screen.state().laboratory.posteriors.shown.as_ref().is_none(), "those of other settings do not");
    wait(&mut screen);
    assert!(screen.state().laboratory.posteriors.shown.as_ref().is_some());
}

#[test]
fn a_filter_that_weighs_its_readings_says_why_there_is_none() {
    let mut screen = plane(DESKTOP, Theme::Light, |scenario| {
        scenario.filters[0].robust = kalmanscope_core::filter::Robust::HUBER;
    });
    choose(&mut screen, "Filter of the posterior", "EKF");
    wait(&mut screen);
    assert!(screen.query_by_label_contains("There is no posterior: the filter weighs its readings").is_some());
}

#[test]
fn it_waits_for_the_playback_and_esc_stops_it() {
    let mut screen = plane(DESKTOP, Theme::Light, |_| ());
    screen.state_mut().session_mut().seek(1.0);
    screen.state_mut().session_mut().toggle_play();
    choose(&mut screen, "Filter of the posterior", "EKF");
    screen.run_steps(2);
    assert!(screen.query_by_label_contains("It is found when the playback stops").is_some());
    screen.state_mut().session_mut().pause();
    screen.state_mut().session_mut().set_budget(kalmanscope::session::Budget::Pieces(1));
    for _ in 0..3000 {
        screen.step();
        if screen.state().laboratory.posteriors.progress().is_some() {
            break;
        }
    }
    assert!(screen.state().laboratory.posteriors.progress().is_some_and(|share| share < 1.0));
    press(&mut screen, egui::Key::Escape);
    assert_eq!((chosen(&screen), screen.state().laboratory.posteriors.progress()), (None, None));
}
