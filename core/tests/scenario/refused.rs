//! Values that are impossible, and texts that are no TOML.

use kalmanscope_core::{Scenario, ScenarioError};

use super::{assert_refused, parsed};

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
    assert_refused(&[("seed = 9223372036854775808", &message.replace("18446744073709551615", "9223372036854775808"))]);
    let error = Scenario::from_toml("seed = 99999999999999999999").unwrap_err().to_string();
    assert!(error.starts_with("TOML parse error at line 1, column 8"), "{error}");
    let largest = Scenario { seed: i64::MAX as u64, ..Scenario::default() };
    assert_eq!(parsed(&largest.to_toml().unwrap()), largest);
}
