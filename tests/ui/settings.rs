//! Every control sets its setting.

use super::*;

fn parameter(scenario: &Scenario, channel: Channel) -> Signal {
    scenario.plant.parameter(channel).expect("the plant has it")
}

#[test]
fn a_sensor_gets_faults_with_numbers_and_loses_them() {
    use kalmanscope_core::scenario::Fault;
    let mut screen = workbench();
    let clean = screen.state().session().scenario().sensors.clone();
    choose(&mut screen, "Add a fault of the displacement sensor", "outliers");
    let numbers = |screen: &Screen| {
        let sensor = screen.state().session().scenario().sensors[0];
        sensor.faults.numbers(Fault::OUTLIERS).map(<[f64]>::to_vec)
    };
    assert_eq!(numbers(&screen), Some(vec![0.1, 10.0, 30.0]));
    assert!(screen.state().session().problem().is_none());
    assert!(screen.query_all_by_label_contains("of the displacement readings is off by").next().is_some());
    set(&mut screen, "Share of outliers of the displacement sensor", 0.2);
    assert_eq!(numbers(&screen).map(|numbers| numbers[0]), Some(0.2));
    assert_eq!(screen.state().session().run().scenario().sensors[0], screen.state().session().scenario().sensors[0]);
    click(&mut screen, "Remove outliers of the displacement sensor");
    screen.run_steps(3);
    assert_eq!(screen.state().session().scenario().sensors, clean);
}

#[test]
fn every_number_changes_the_scenario_and_with_it_the_estimates() {
    let mut screen = workbench();
    type Read = fn(&Scenario) -> f64;
    let numbers: &[(&str, f64, Read)] = &[
        ("Damping ratio, value", 0.11, |s| parameter(s, Channel::DAMPING_RATIO).at(0.0)),
        ("Natural frequency, before", 7.5, |s| parameter(s, Channel::NATURAL_FREQUENCY).at(0.0)),
        ("Natural frequency, after", 3.5, |s| parameter(s, Channel::NATURAL_FREQUENCY).at(59.0)),
        ("Natural frequency, changes at", 12.0, |s| match parameter(s, Channel::NATURAL_FREQUENCY) {
            Signal::Step(step) => step.at,
            _ => f64::NAN,
        }),
        ("Initial displacement", 0.25, |s| s.plant.initial.displacement),
        ("Initial velocity", -1.5, |s| s.plant.initial.velocity),
        ("Disturbance", 2.0, |s| s.plant.disturbance_std),
        ("Std of the force", 20.0, |s| match s.force {
            Force::WhiteNoise { std } => std,
            _ => f64::NAN,
        }),
        ("Noise of the displacement sensor", 0.02, |s| s.sensors[0].noise_std),
        ("Noise of the velocity sensor", 0.1, |s| s.sensors[1].noise_std),
        ("EKF fading factor", 1.02, |s| s.filters[0].fading),
        ("EKF parameter decay", 0.05, |s| s.filters[0].eta),
        ("UKF fading factor", 1.03, |s| s.filters[1].fading),
        ("UKF parameter decay", 0.04, |s| s.filters[1].eta),
        ("EKF sensor std of displacement", 0.03, |s| s.filters[0].sensor_std[0]),
        ("EKF sensor std of velocity", 0.2, |s| s.filters[0].sensor_std[1]),
        ("UKF sensor std of displacement", 0.04, |s| s.filters[1].sensor_std[0]),
        ("Duration", 30.0, |s| s.duration),
        ("Sampling time", 0.02, |s| s.dt),
        ("Seed", 7.0, |s| s.seed as f64),
    ];
    screen.state_mut().session_mut().set_mode(Mode::Whole);
    for &(name, value, read) in numbers {
        let before = screen.state().session().run().checksum();
        set(&mut screen, name, value);
        let found = read(scenario(&screen));
        assert!((found - value).abs() < 1e-9, "{name} is {found} after it was set to {value}");
        assert_eq!(screen.state().session().problem(), None, "{name}");
        let after = screen.state().session().run().checksum();
        assert_ne!(before, after, "{name} has no effect on the estimates");
    }
}

#[test]
fn every_number_of_a_belief_changes_the_scenario() {
    let mut screen = workbench();
    for (place, filter) in ["EKF", "UKF"].into_iter().enumerate() {
        for &channel in PlantKind::SDOF.channels() {
            let filters = |screen: &Screen| scenario(screen).filters[place].clone();
            set(&mut screen, &format!("{filter} initial guess of {}", channel.name()), 0.7);
            assert_eq!(filters(&screen).initial_mean[channel], 0.7);
            set(&mut screen, &format!("{filter} initial std of {}", channel.name()), 0.9);
            assert_eq!(filters(&screen).initial_std[channel], 0.9);
            set(&mut screen, &format!("{filter} process std of {}", channel.name()), 0.002);
            assert_eq!(filters(&screen).process_std[channel], 0.002);
        }
    }
}

#[test]
fn no_control_can_set_an_invalid_number() {
    let mut screen = workbench();
    let names: Vec<String> = screen
        .root()
        .children_recursive()
        .filter(|node| matches!(node.accesskit_node().role(), accesskit::Role::Slider | accesskit::Role::SpinButton))
        .filter_map(|node| node.accesskit_node().label())
        .collect();
    assert!(names.len() > 40, "only {} numbers found: {names:?}", names.len());
    for name in names.iter().filter(|name| *name != "Time") {
        for value in [-1e9, 0.0, 1e9] {
            let Some(node) = screen.query_by_label(name) else { continue };
            node.set_value_accesskit(value);
            screen.run_steps(2);
            assert_eq!(screen.state().session().problem(), None, "{name} = {value}");
        }
        screen.state_mut().session_mut().set_scenario(Scenario::default());
    }
}

#[test]
fn sensors_can_be_added_and_removed() {
    let mut screen = workbench();
    click(&mut screen, "acceleration");
    assert_eq!(scenario(&screen).sensors.len(), 3);
    assert_eq!(scenario(&screen).filters[1].sensor_std.len(), 3);
    // Without ground motion and a mass below, the other two aspects would repeat these.
    assert!(screen.query_by_label("total_acceleration").is_none() && screen.query_by_label("drift").is_none());
    for quantity in ["displacement", "velocity", "acceleration"] {
        // A plot has the same name.
        screen.get_all_by_label(quantity).next().expect("a control").click();
        screen.run_steps(4);
    }
    assert!(scenario(&screen).sensors.is_empty());
    assert!(screen.query_by_label_contains("only predict").is_some());
    assert_eq!(screen.state().session().problem(), None);
}

#[test]
fn shapes_forces_and_kinds_can_be_chosen() {
    let mut screen = workbench();
    for (shape, check) in [
        ("constant", (|s| matches!(s, Signal::Constant(_))) as fn(&Signal) -> bool),
        ("ramp", |s| matches!(s, Signal::Ramp(_))),
        ("sine", |s| matches!(s, Signal::Sine(_))),
        ("step", |s| matches!(s, Signal::Step(_))),
    ] {
        choose(&mut screen, "Natural frequency over time", shape);
        assert!(check(&parameter(scenario(&screen), Channel::NATURAL_FREQUENCY)), "{shape}");
    }
    for (kind, check) in [
        ("sine", (|f| matches!(f, Force::Sine { .. })) as fn(&Force) -> bool),
        ("chirp", |f| matches!(f, Force::Chirp { .. })),
        ("hammer blows", |f| matches!(f, Force::ImpulseTrain { .. })),
        ("step", |f| matches!(f, Force::Step { .. })),
        ("none", |f| matches!(f, Force::None)),
        ("white noise", |f| matches!(f, Force::WhiteNoise { .. })),
    ] {
        choose(&mut screen, "Force over time", kind);
        assert!(check(&scenario(&screen).force), "{kind}");
        assert_eq!(screen.state().session().problem(), None, "{kind}");
    }
    choose(&mut screen, "Kind of filter 1", "KF");
    let first = |screen: &Screen| (scenario(screen).filters[0].kind, scenario(screen).filters[0].name.clone());
    assert_eq!(first(&screen), (FilterKind::KF, "KF".to_owned()));
    choose(&mut screen, "Kind of filter 1", "UKF");
    assert_eq!(first(&screen), (FilterKind::UKF, "UKF 1".to_owned()), "the second filter has the name already");
    choose(&mut screen, "Kind of filter 1", "EKF");
    assert_eq!(first(&screen), (FilterKind::EKF, "EKF".to_owned()));
}

#[test]
fn matching_the_truth_sets_q_and_r() {
    let mut screen = workbench();
    set(&mut screen, "Noise of the velocity sensor", 0.2);
    set(&mut screen, "Disturbance", 3.0);
    screen.get_all_by_label("Match the truth").next().expect("a button in each filter").click();
    screen.run_steps(3);
    let scenario = scenario(&screen);
    let (sensor_std, process_std) = scenario.true_noise();
    assert_eq!((&scenario.filters[0].sensor_std, &scenario.filters[0].process_std), (&sensor_std, &process_std));
    assert_eq!(sensor_std, [0.01, 0.2]);
    assert!((process_std[Channel::VELOCITY] - 0.03).abs() < 1e-12 && process_std[Channel::NATURAL_FREQUENCY] > 0.0);
    assert_ne!(scenario.filters[1].sensor_std, sensor_std, "the other filter keeps its own");
}

#[test]
fn a_day_can_be_set_and_is_live_only() {
    let mut screen = workbench();
    click(&mut screen, "Whole record");
    assert_eq!(screen.state().session().mode(), Mode::Whole);
    click(&mut screen, "1 day");
    assert_eq!((scenario(&screen).duration, screen.state().session().end()), (86_400.0, 86_400.0));
    assert_eq!(screen.state().session().mode(), Mode::Live);
    assert!(screen.get_by_label("Whole record").accesskit_node().is_disabled());
    assert!(screen.query_by_label("/ 24:00:00").is_some());

    screen.state_mut().session_mut().set_budget(Budget::Pieces(4));
    let field = screen.get_by_label("Time, value");
    field.focus();
    screen.run_steps(2);
    screen.key_press_modifiers(Modifiers::COMMAND, Key::A);
    screen.get_by_label("Time, value").type_text("0:16:40");
    press(&mut screen, Key::Enter);
    let session = screen.state().session();
    assert_eq!((session.time(), session.behind(), session.playing()), (1000.0, true, false));
    assert!(screen.query_by_label_contains("computing, ").is_some());
    for _ in 0..500 {
        if !screen.state().session().behind() {
            break;
        }
        screen.run_steps(1);
    }
    screen.run_steps(2);
    assert_eq!(screen.state().session().run().done(), 100_001);
    assert!(screen.query_by_label_contains("computing, ").is_none());
    screen.state_mut().session_mut().set_budget(Budget::Unlimited);
    for arrangement in Arrangement::ALL {
        *screen.state_mut().layout_mut() = ViewLayout::of(arrangement);
        screen.run_steps(8);
    }
    screen.remove_cursor();
    assert!(screen.try_run().is_ok(), "nothing moves, but frame after frame is drawn");

    set(&mut screen, "Duration, value", 1e9);
    assert_eq!(scenario(&screen).duration, 86_400.0);
    click(&mut screen, "1 min");
    assert_eq!((screen.state().session().mode(), screen.state().session().run().len()), (Mode::Whole, 6001));
}

#[test]
fn a_number_of_a_file_beyond_its_slider_stays() {
    let mut screen = workbench();
    let mut given = Scenario::default();
    given.filters[0].substeps = 50;
    set_scenario(&mut screen, given);
    open_options(&mut screen);
    assert!(screen.query_by_label("EKF substeps per sample").is_some(), "the options are open");
    assert_eq!(scenario(&screen).filters[0].substeps, 50);
    set(&mut screen, "EKF substeps per sample", 3.0);
    assert_eq!(scenario(&screen).filters[0].substeps, 3);
}

#[test]
fn a_number_that_a_filter_lacks_is_not_called_known() {
    let mut screen = workbench();
    let mut given = Scenario::default();
    given.filters[0].augment = vec![Channel::INPUT_GAIN];
    screen.state_mut().session_mut().set_scenario(given);
    show(&mut screen, &[ViewKind::Filters]);
    assert_eq!(screen.query_all_by_label("–").count(), 3, "guess, σ and √Q of the gain of the UKF");
    assert_eq!(screen.query_all_by_label("known").count(), 0);
}

#[test]
fn a_parameter_can_be_counted_and_not_learnt() {
    let mut screen = workbench();
    open_options(&mut screen);
    choose(&mut screen, "EKF learns", "ζ damping ratio");
    assert_eq!(scenario(&screen).filters[0].consider, [Channel::DAMPING_RATIO]);
    assert_eq!(screen.state().session().problem(), None);
    let estimates = &screen.state().session().run().estimates()[0];
    let place = estimates.place(Channel::DAMPING_RATIO).expect("it is in the state");
    let last = estimates.len() - 1;
    // Its process noise alone moves the band.
    let grown = estimates.std(last, place) / estimates.initial_std(place);
    assert!(last > 3 && (grown - 1.0).abs() < 0.01, "{last} {grown}");
    // A jump does not go with it, and no option has to be in sight for that.
    press(&mut screen, Key::Escape);
    open_options(&mut screen);
    choose(&mut screen, "EKF parameters", "jump");
    assert_eq!((scenario(&screen).filters[0].consider.len(), screen.state().session().problem()), (0, None));
}

#[test]
fn a_parameter_can_have_bounds() {
    let mut screen = workbench();
    open_options(&mut screen);
    choose(&mut screen, "EKF bounds", "ζ at least");
    let bounds = |screen: &Screen| scenario(screen).filters[0].bounds.of(Channel::DAMPING_RATIO).ends();
    assert_eq!(bounds(&screen), [0.0, f64::INFINITY]);
    screen.get_by_label("EKF ζ at least");
    assert_eq!(screen.state().session().problem(), None);
    press(&mut screen, Key::Escape);
    // Logarithms do not go with it.
    click(&mut screen, "EKF: logarithms of positive parameters");
    screen.run_steps(3);
    assert_eq!((scenario(&screen).filters[0].bounds.is_empty(), screen.state().session().problem()), (true, None));
}

#[test]
fn a_sensor_can_be_late_and_have_a_gain() {
    let mut screen = workbench();
    open_options(&mut screen);
    assert_eq!(scenario(&screen).filters[0].sensor_delay, [0.0; 0], "what is not touched is not written");
    click(&mut screen, "EKF sensors late");
    set(&mut screen, "EKF sensor delay of velocity", 0.025);
    assert_eq!(scenario(&screen).filters[0].sensor_delay, [0.0, 0.025]);
    press(&mut screen, Key::Escape);
    choose(&mut screen, "EKF augmentations", "gˣ sensor gain of the displacement");
    assert_eq!(scenario(&screen).filters[0].augment, [Quantity::DISPLACEMENT.gain()]);
    let session = screen.state().session();
    assert_eq!((session.problem(), session.run().estimates()[0].stop()), (None, None));
}

#[test]
fn a_filter_is_plucked_and_has_scales_of_q() {
    let mut screen = workbench();
    open_options(&mut screen);
    click(&mut screen, "EKF plucks");
    for expected in [&[10.0][..], &[10.0, 20.0]] {
        click(&mut screen, "One more");
        assert_eq!(scenario(&screen).filters[0].plucks, expected);
    }
    set(&mut screen, "EKF pluck 2", 12.5);
    click(&mut screen, "EKF without pluck 1");
    assert_eq!(scenario(&screen).filters[0].plucks, [12.5]);
    click(&mut screen, "EKF without pluck 1");
    press(&mut screen, Key::Escape);
    for (answer, expected) in [
        ("walk", (0.1, false, 1)),
        ("jump", (0.0, true, 1)),
        ("still", (0.0, false, 1)),
        ("Q of unknown size", (0.0, false, 17)),
    ] {
        choose(&mut screen, "EKF parameters", answer);
        let filter = &scenario(&screen).filters[0];
        assert_eq!((filter.walk, filter.jump, filter.process_scales), expected, "{answer}");
    }
    set(&mut screen, "EKF scales of Q", 5.0);
    screen.run_steps(30);
    assert_eq!(scenario(&screen).filters[0].process_scales, 5);
    let session = screen.state().session();
    assert_eq!((session.problem(), session.run().estimates()[0].stop()), (None, None));
    assert!(session.run().estimates()[0].process_scale(0).is_some());
}
