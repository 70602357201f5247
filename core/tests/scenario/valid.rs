//! Valid contents.

use kalmanscope_core::signal::{Ramp, Sine, Step};
use kalmanscope_core::{
    Channel, FilterKind, FilterSettings, Force, Hold, InputKind, Plant, PlantKind, Quantity, Scenario, Sensor, Signal,
    Values,
};

use super::parsed;

const SAMPLE: &str = include_str!("../sample.toml");

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
