//! Scenario files: valid contents, and the messages for invalid ones.

use kalmanscope_core::signal::{Ramp, Sine, Step};
use kalmanscope_core::{
    Channel, FilterKind, FilterSettings, Force, Hold, InputKind, Plant, PlantKind, Quantity, Scenario, ScenarioError,
    Sensor, Signal, Values,
};

fn parsed(text: &str) -> Scenario {
    Scenario::from_toml(text).unwrap_or_else(|error| panic!("{text}\n{error}"))
}

#[track_caller]
fn assert_refused(cases: &[(&str, &str)]) {
    for (text, expected) in cases {
        match Scenario::from_toml(text) {
            Ok(_) => panic!("accepted: {text}"),
            // Channels of equations that other tests type follow in lists of channels: such a list is compared as far as it is given.
            Err(error) => match expected.strip_suffix('…') {
                Some(begin) => assert!(error.to_string().starts_with(begin), "{text}: {error}"),
                None => assert_eq!(error.to_string(), *expected, "{text}"),
            },
        }
    }
}

const SAMPLE: &str = include_str!("sample.toml");

#[test]
fn the_sample_has_the_expected_settings() {
    let with = |[displacement, velocity, natural_frequency, damping_ratio]: [f64; 4], rest: Values| {
        rest.with([
            (Channel::DISPLACEMENT, displacement),
            (Channel::VELOCITY, velocity),
            (Channel::NATURAL_FREQUENCY, natural_frequency),
            (Channel::DAMPING_RATIO, damping_ratio),
        ])
    };
    let expected = Scenario {
        seed: 1,
        dt: 0.01,
        duration: 60.0,
        plant: Plant::default()
            .of_kind(PlantKind::SDOF)
            .with(Channel::NATURAL_FREQUENCY, Signal::Step(Step { from: 6.0, to: 4.8, at: 30.0 }))
            .with(Channel::DAMPING_RATIO, 0.05),
        input: InputKind::Force,
        hold: Hold::Zero,
        force: Force::WhiteNoise { std: 10.0 },
        sensors: vec![Sensor::new(Quantity::DISPLACEMENT, 0.01), Sensor::new(Quantity::VELOCITY, 0.06)],
        record: None,
        draw: std::collections::BTreeMap::new(),
        filters: vec![FilterSettings {
            id: 1,
            name: "EKF with fading memory".to_owned(),
            kind: FilterKind::EKF,
            fading: 1.005,
            eta: 0.0,
            sensor_std: vec![0.01, 0.06],
            initial_mean: with([0.0, 0.0, 8.0, 0.1], Values::INITIAL_MEAN),
            initial_std: with([0.1, 0.3, 2.0, 0.1], Values::INITIAL_STD),
            process_std: with([1e-4, 1e-3, 1e-4, 3e-5], Values::PROCESS_STD),
            ..FilterSettings::default()
        }],
    };
    assert_eq!(parsed(SAMPLE), expected);
    assert_eq!(expected.samples(), 6001);
}

#[test]
fn an_empty_file_is_the_default() {
    let default = parsed("");
    assert_eq!(default, Scenario::default());
    assert_eq!(default.validate(), Ok(()));
    assert_eq!(default.filters.iter().map(|f| f.name.as_str()).collect::<Vec<_>>(), ["EKF", "UKF"]);
}

#[test]
fn ids_are_written_where_places_do_not_give_them() {
    let mut scenario = Scenario::default();
    assert!(!scenario.to_toml().unwrap().contains("id = "));
    scenario.filters.remove(0);
    let text = scenario.to_toml().unwrap();
    assert!(text.contains("id = 2"), "{text}");
    assert_eq!(parsed(&text), scenario);
}

#[test]
fn missing_settings_are_filled_in() {
    let scenario = parsed(
        "[[sensors]]\nmeasures = \"velocity\"\nnoise_std = 0.2\n[[sensors]]\nmeasures = \"displacement\"\n\
         noise_std = 0\n[[filters]]\nkind = \"ukf\"\ninitial_std = { velocity = 9 }\n[[filters]]\nname = \"a\"\n",
    );
    let [ukf, second] = scenario.filters.as_slice() else { panic!("two filters") };
    assert_eq!((ukf.name.as_str(), second.name.as_str()), ("UKF", "a"));
    assert_eq!((ukf.id, second.id), (1, 2));
    assert_eq!(ukf.initial_std, Values::INITIAL_STD.with([(Channel::VELOCITY, 9.0)]));
    assert_eq!(second.initial_std, Values::INITIAL_STD);
    assert_eq!(ukf.sensor_std[0], 0.2);
    assert!(ukf.sensor_std[1] > 0.0, "a filter cannot believe in a perfect sensor");
    assert!(parsed("sensors = []\nfilters = []").filters.is_empty());
    let other_sensors = parsed("[[sensors]]\nmeasures = \"acceleration\"\nnoise_std = 0.5");
    assert!(other_sensors.filters.iter().all(|f| f.sensor_std == [0.5] && f.fading == 1.005));
}

#[test]
fn every_kind_of_signal_can_be_written() {
    let cases = [
        ("6", Signal::Constant(6.0)),
        ("6.5", Signal::Constant(6.5)),
        ("{ step = { from = 6, to = 4.8, at = 30 } }", Signal::Step(Step { from: 6.0, to: 4.8, at: 30.0 })),
        (
            "{ ramp = { from = 6.0, to = 5.0, start = 20, end = 30 } }",
            Signal::Ramp(Ramp { from: 6.0, to: 5.0, start: 20.0, end: 30.0 }),
        ),
        (
            "{ sine = { mean = 6.0, amplitude = 0.5, period = 8.0 } }",
            Signal::Sine(Sine { mean: 6.0, amplitude: 0.5, period: 8.0 }),
        ),
    ];
    for (text, expected) in cases {
        for key in ["natural_frequency", "damping_ratio"] {
            let plant = parsed(&format!("[plant]\n{key} = {text}")).plant;
            let found = plant.parameter(Channel::from_key(key).unwrap());
            assert_eq!(found, Some(expected), "{key} = {text}");
        }
    }
    let table = parsed("[plant.natural_frequency.step]\nfrom = 6\nto = 4.8\nat = 30");
    assert_eq!(table.plant.parameter(Channel::NATURAL_FREQUENCY), Some(cases[2].1));
}

#[test]
fn every_kind_of_force_can_be_written() {
    let cases = [
        ("force = \"none\"", Force::None),
        ("[force]\nwhite_noise = { std = 3 }", Force::WhiteNoise { std: 3.0 }),
        ("[force]\nsine = { amplitude = 2.0, frequency = 5.0 }", Force::Sine { amplitude: 2.0, frequency: 5.0 }),
        (
            "[force]\nchirp = { amplitude = 2.0, from = 1.0, to = 9.0, sweep = 30.0 }",
            Force::Chirp { amplitude: 2.0, from: 1.0, to: 9.0, sweep: 30.0 },
        ),
        ("[force]\nimpulse_train = { impulse = 0.5, period = 4.0 }", Force::ImpulseTrain { impulse: 0.5, period: 4.0 }),
        ("[force]\nstep = { amplitude = 2.0, at = 5.0 }", Force::Step { amplitude: 2.0, at: 5.0 }),
    ];
    for (text, expected) in cases {
        let scenario = parsed(text);
        assert_eq!(scenario.force, expected, "{text}");
        assert_eq!(parsed(&scenario.to_toml().unwrap()), scenario, "{text}");
    }
}

#[test]
fn impossible_values_are_refused_with_key_value_and_limits() {
    const POSITIVE: &str = "but must be a finite number above 0";
    const NOT_NEGATIVE: &str = "but must be a finite number, at least 0";
    const FINITE: &str = "but must be a finite number";
    let cases = [
        ("dt = 0", "`dt` is 0", POSITIVE),
        ("dt = nan", "`dt` is NaN", POSITIVE),
        ("duration = -1", "`duration` is -1", POSITIVE),
        ("duration = 1e9", "`duration` is 1000000000", "but must be from 1 to 99999999 times dt"),
        ("duration = 1e-3", "`duration` is 0.001", "but must be from 1 to 99999999 times dt"),
        ("plant.natural_frequency = inf", "`plant.natural_frequency` is inf", FINITE),
        (
            "plant.natural_frequency = 0",
            "`plant.natural_frequency` is 0 at its lowest",
            "but must be above 0 at all times",
        ),
        (
            "plant.natural_frequency = { sine = { mean = 1, amplitude = -2, period = 3 } }",
            "`plant.natural_frequency` is -1 at its lowest",
            "but must be above 0 at all times",
        ),
        (
            "plant.damping_ratio = -0.1",
            "`plant.damping_ratio` is -0.1 at its lowest",
            "but must be at least 0 at all times",
        ),
        (
            "plant.damping_ratio = { sine = { mean = 1, amplitude = 0, period = 0 } }",
            "`plant.damping_ratio.sine.period` is 0",
            POSITIVE,
        ),
        (
            "plant.damping_ratio = { ramp = { from = 1, to = 1, start = 9, end = 3 } }",
            "`plant.damping_ratio.ramp.end` is 3",
            "but must be at least ramp.start = 9",
        ),
        (
            "plant.damping_ratio = { step = { from = 1, to = nan, at = 3 } }",
            "`plant.damping_ratio.step.to` is NaN",
            FINITE,
        ),
        ("plant.initial.displacement = inf", "`plant.initial.displacement` is inf", FINITE),
        ("plant.initial.velocity = nan", "`plant.initial.velocity` is NaN", FINITE),
        ("plant.disturbance_std = -1", "`plant.disturbance_std` is -1", NOT_NEGATIVE),
        ("force.white_noise.std = -1", "`force.white_noise.std` is -1", NOT_NEGATIVE),
        ("force.sine = { amplitude = inf, frequency = 1 }", "`force.sine.amplitude` is inf", FINITE),
        ("force.chirp = { amplitude = 1, from = 1, to = 1, sweep = 0 }", "`force.chirp.sweep` is 0", POSITIVE),
        ("force.impulse_train = { impulse = 1, period = -1 }", "`force.impulse_train.period` is -1", POSITIVE),
        ("force.step = { amplitude = 1, at = nan }", "`force.step.at` is NaN", FINITE),
        ("[[sensors]]\nmeasures = \"velocity\"\nnoise_std = -1", "`sensors[0].noise_std` is -1", NOT_NEGATIVE),
        (
            "[[sensors]]\nmeasures = \"velocity\"\nnoise_std = 1\n[[sensors]]\nmeasures = \"velocity\"\nnoise_std = 2",
            "`sensors[1].measures` is \"velocity\" again",
            "but must be a quantity that no other sensor measures",
        ),
        (
            "[[filters]]\nfading = 0.9",
            "`filters[0].fading` is 0.9",
            "but must be a finite number, at least 1 (1 forgets nothing)",
        ),
        ("[[filters]]\n[[filters]]\neta = -1", "`filters[1].eta` is -1", NOT_NEGATIVE),
        (
            "[[filters]]\nsensor_std = [1]",
            "`filters[0].sensor_std` is a list of 1",
            "but must be a list of 2, one for each sensor",
        ),
        ("[[filters]]\nsensor_std = [1, 0]", "`filters[0].sensor_std[1]` is 0", POSITIVE),
        ("[[filters]]\ninitial_mean.velocity = nan", "`filters[0].initial_mean.velocity` is NaN", FINITE),
        ("[[filters]]\ninitial_std.damping_ratio = -1", "`filters[0].initial_std.damping_ratio` is -1", NOT_NEGATIVE),
        ("[[filters]]\nprocess_std.displacement = inf", "`filters[0].process_std.displacement` is inf", NOT_NEGATIVE),
    ];
    for (text, what, allowed) in cases {
        let expected = format!("{what}, {allowed}");
        if what.ends_with(" NaN") || what.ends_with(" inf") {
            // The reader of files has no such number; programs may set one.
            let error = Scenario::from_toml(text).unwrap_err().to_string();
            assert!(error.starts_with("line ") && error.ends_with(": must be a finite number"), "{error}");
            let mut scenario: Scenario = toml::from_str(text).unwrap();
            scenario.filters.iter_mut().for_each(|filter| filter.sensor_std = vec![1.0; 2]);
            assert_eq!(scenario.validate().unwrap_err().to_string(), expected);
            continue;
        }
        assert_refused(&[(text, &expected)]);
        assert!(matches!(Scenario::from_toml(text), Err(ScenarioError::Value { .. })), "{text}");
    }
    let many = "[[filters]]\n".repeat(17);
    assert_refused(&[(&many, "`filters` is a list of 17, but must be at most 16")]);
    assert_eq!(parsed(&"[[filters]]\n".repeat(16)).filters.len(), 16);
}

#[test]
fn invalid_toml_is_shown_with_its_place() {
    for text in ["dt = ", "seed = 1\nseed = 2", "[plant", "\u{0}", "dt = 0.01.2"] {
        let error = Scenario::from_toml(text).unwrap_err();
        assert!(matches!(error, ScenarioError::Syntax(_)), "{text}");
        assert!(error.to_string().starts_with("TOML parse error at line "), "{error}");
    }
}

#[test]
fn a_seed_that_toml_cannot_hold_is_refused() {
    let scenario = Scenario { seed: u64::MAX, ..Scenario::default() };
    let message = scenario.validate().unwrap_err().to_string();
    assert_eq!(message, "`seed` is 18446744073709551615, but must be a whole number from 0 to 2⁶³ - 1");
    for seed in ["9223372036854775808", "99999999999999999999"] {
        let error = Scenario::from_toml(&format!("seed = {seed}")).unwrap_err().to_string();
        assert!(error.starts_with("TOML parse error at line 1, column 8"), "{error}");
    }
    let largest = Scenario { seed: i64::MAX as u64, ..Scenario::default() };
    assert_eq!(parsed(&largest.to_toml().unwrap()), largest);
}

#[test]
fn an_unknown_key_is_refused_with_line_path_and_the_keys_that_exist() {
    assert_refused(&[
        (
            "\nsed = 1",
            "line 2: `sed`: unknown field `sed`, expected one of `seed`, `dt`, `duration`, `plant`, `force`, `input`, `hold`, \
             `sensors`, `filters`, `record`, `draw`",
        ),
        (
            "[plant]\nmass = 1",
            "line 2: `plant.mass`: unknown field `mass`, expected `kind`, `equation`, `parameters`, `initial`, `disturbance_std`, `input_delay` \
             or one of `natural_frequency`, `damping_ratio`, `cubic_stiffness`, `post_yield_ratio`, `hysteresis_beta`, \
             `hysteresis_gamma`, `yield_beta`, `yield_gamma`, `stiffness_1`, `storey_damping`, `input_gain`, `input_offset`, `unknown_force`, \
             `white_force`, `bias_displacement`, `bias_velocity`, `bias_acceleration`, `bias_total_acceleration`, `bias_drift`, …",
        ),
        (
            "[plant]\ninitial = { x = 1 }",
            "line 2: `plant.initial.x`: unknown field `x`, expected `displacement` or `velocity`",
        ),
        (
            "[plant]\nnatural_frequency = { jump = 1 }",
            "line 2: `plant.natural_frequency.jump`: unknown field `jump`, expected one of `step`, `ramp`, `sine`",
        ),
        (
            "[plant.damping_ratio.step]\nfrom = 1\nto = 2\nat = 3\nend = 4",
            "line 5: `plant.damping_ratio.step.end`: unknown field `end`, expected one of `from`, `to`, `at`",
        ),
        (
            "[force]\nnoise = 1",
            "line 1: `force`: unknown variant `noise`, expected one of `none`, `white_noise`, `sine`, `chirp`, \
             `impulse_train`, `step`",
        ),
        (
            "[force]\nwhite_noise = { std = 1, mean = 2 }",
            "line 2: `force.white_noise.mean`: unknown field `mean`, expected `std`",
        ),
        (
            "[[sensors]]\nmeasures = \"velocity\"\nnoise_std = 1\nbias = 2",
            "line 4: `sensors[0].bias`: unknown field `bias`, expected one of `measures`, `noise_std`, `faults`",
        ),
        (
            "[[filters]]\ninitial_std = { mass = 1 }",
            "line 2: `filters[0].initial_std.mass`: unknown field `mass`, expected one of `displacement`, `velocity`, …",
        ),
    ]);
    // `docs.rs` holds all keys to their table.
    let error = Scenario::from_toml("[[filters]]\n[[filters]]\nlambda = 1").unwrap_err().to_string();
    assert!(
        error.starts_with("line 3: `filters[1].lambda`: unknown field `lambda`, expected one of `id`, "),
        "{error}"
    );
}

#[test]
fn a_value_of_the_wrong_type_is_refused_with_line_path_and_the_expected_type() {
    let signal = "expected a number, or a table with exactly one of `step`, `ramp`, `sine`";
    let refused = |text: &str, message: String| assert_refused(&[(text, &message)]);
    for (value, found) in [
        ("\"low\"", "invalid type: string \"low\""),
        ("{}", "invalid value: map"),
        (
            "{ sine = { mean = 6, amplitude = 1, period = 9 }, step = { from = 6, to = 5, at = 3 } }",
            "invalid value: map",
        ),
    ] {
        refused(
            &format!("[plant]\ndamping_ratio = {value}"),
            format!("line 2: `plant.damping_ratio`: {found}, {signal}"),
        );
    }
    let quantities = "`displacement`, `velocity`, `acceleration`, `total_acceleration`, `drift`, and of other masses as in \
                      `displacement_2`";
    refused(
        "[[sensors]]\nmeasures = \"jerk\"\nnoise_std = 1",
        format!("line 2: `sensors[0].measures`: unknown variant `jerk`, expected one of {quantities}"),
    );
    let kinds = FilterKind::ALL.map(|kind| format!("`{}`", kind.key())).join(", ");
    refused(
        "[[filters]]\nkind = \"lqr\"",
        format!("line 2: `filters[0].kind`: unknown variant `lqr`, expected one of {kinds}"),
    );
    assert_refused(&[
        ("seed = 1.5", "line 1: `seed`: invalid type: floating point `1.5`, expected u64"),
        ("seed = -1", "line 1: `seed`: invalid value: integer `-1`, expected u64"),
        ("seed = 1\n\ndt = \"fast\"", "line 3: `dt`: invalid type: string \"fast\", expected f64"),
        ("plant = 3", "line 1: `plant`: invalid type: integer `3`, expected a table"),
        (
            "[plant]\nkind = \"mdof\"",
            "line 2: `plant.kind`: unknown variant `mdof`, expected one of `sdof`, `duffing`, `bouc_wen`, `bouc_wen_1`, `shear_2`, \
             `shear_3`, `shear_4`, `shear_5`, `shear_6`, `shear_7`, `shear_8`, `shear_9`, `shear_10`",
        ),
        (
            "[plant]\nkind = 3",
            "line 2: `plant.kind`: invalid type: integer `3`, expected the key of a plant, or a table with an equation",
        ),
        (
            "[plant]\ninitial = { velocity = true }",
            "line 2: `plant.initial.velocity`: invalid type: boolean `true`, expected f64",
        ),
        (
            "[plant]\nnatural_frequency = { step = { from = 1, to = [], at = 2 } }",
            "line 2: `plant.natural_frequency.step.to`: invalid type: sequence, expected f64",
        ),
        (
            "[plant]\nnatural_frequency = { step = 1 }",
            "line 2: `plant.natural_frequency.step`: invalid type: integer `1`, expected a table",
        ),
        (
            "[plant]\nnatural_frequency = { step = { from = 1, to = 2 } }",
            "line 2: `plant.natural_frequency.step`: missing field `at`",
        ),
        ("force = 3", "line 1: `force`: invalid type: integer `3`, expected a word, or a table with exactly one key"),
        ("force = {}", "line 1: `force`: invalid value: map, expected a table with exactly one key"),
        ("[force]\nsine = { amplitude = 1.0 }", "line 2: `force.sine`: missing field `frequency`"),
        (
            "[force]\nsine = { amplitude = \"a\", frequency = 1 }",
            "line 2: `force.sine.amplitude`: invalid type: string \"a\", expected f64",
        ),
        (
            "force = \"noise\"",
            "line 1: `force`: unknown variant `noise`, expected one of `none`, `white_noise`, `sine`, `chirp`, \
             `impulse_train`, `step`",
        ),
        ("sensors = 3", "line 1: `sensors`: invalid type: integer `3`, expected a sequence"),
        ("[[sensors]]\nmeasures = \"velocity\"", "line 1: `sensors[0]`: missing field `noise_std`"),
        ("[[filters]]\nname = 3", "line 2: `filters[0].name`: invalid type: integer `3`, expected a string"),
        (
            "[[filters]]\nsensor_std = 1",
            "line 2: `filters[0].sensor_std`: invalid type: integer `1`, expected a sequence",
        ),
        (
            "[[filters]]\n[[filters]]\nsensor_std = [\n1,\n\"a\"]",
            "line 5: `filters[1].sensor_std[1]`: invalid type: string \"a\", expected f64",
        ),
        (
            "[[filters]]\nprocess_std = { velocity = \"a\" }",
            "line 2: `filters[0].process_std.velocity`: invalid type: string \"a\", expected f64",
        ),
        (
            "[[filters]]\nprocess_std = 3",
            "line 2: `filters[0].process_std`: invalid type: integer `3`, expected a table",
        ),
    ]);
}
