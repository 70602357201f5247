//! Settings: their addresses, edits and changes, and axes of their values.

use kalmanscope_core::scenario::Law;
use kalmanscope_core::setting::{
    Address, Allowed, CHOICES_OF_FILTER, CHOICES_OF_SCENARIO, Change, Changed, ChoiceInfo, Edit, FORCE, addresses,
    other_choices, words_of,
};
use kalmanscope_core::{
    Axis, AxisError, Channel, FilterSettings, Force, Hold, PlantKind, Quantity, Robust, Scenario, Sensor, Signal,
    document,
};
use toml::Value;

#[test]
fn every_kind_of_setting_is_set_and_read_back() {
    let mut scenario = Scenario::default();
    let settings = "seed=12 dt=0.02 duration=20 plant.disturbance_std=0.3 plant.input_delay=2 plant.initial.displacement=0.1 \
         plant.natural_frequency.step.to=4 plant.natural_frequency.step.at=12 plant.natural_frequency=5 \
         sensors.velocity.noise_std=0.2 filters.EKF.fading=1.01 filters.EKF.eta=0.1 filters.UKF.input_delay=-1 \
         filters.EKF.sensor_std.velocity=0.5 filters.EKF.sensor_std.0=0.25 \
         filters.UKF.initial_mean.natural_frequency=12 filters.*.initial_std.damping_ratio=0.3 \
         filters.EKF.process_std.velocity=0.001";
    for (key, value) in settings.split(' ').filter_map(|setting| setting.split_once('=')) {
        let value: f64 = value.parse().unwrap();
        let address = Address::parse(&scenario, key).unwrap();
        address.set(&mut scenario, value);
        assert_eq!(address.get(&scenario), value, "{key}");
        assert_eq!(Address::parse(&scenario, key).unwrap().get(&scenario), value, "{key} is found again");
        scenario.validate().unwrap();
    }
    assert!(scenario.filters.iter().all(|f| f.initial_std[Channel::DAMPING_RATIO] == 0.3));
}

#[test]
fn a_factor_multiplies_the_present_numbers() {
    let before = Scenario::default();
    let mut scenario = before.clone();
    for key in ["filters.*.process_std", "filters.EKF.sensor_std", "filters.UKF.initial_std"] {
        let address = Address::parse(&before, key).unwrap();
        assert_eq!(address.get(&scenario), 1.0);
        address.set(&mut scenario, 4.0);
        address.set(&mut scenario, 3.0);
        assert!((address.get(&scenario) - 3.0).abs() < 1e-12, "{key}");
    }
    let [ekf, ukf] = &scenario.filters[..] else { panic!("two filters") };
    assert_eq!(ekf.sensor_std, before.filters[0].sensor_std.iter().map(|s| 3.0 * s).collect::<Vec<_>>());
    assert_eq!(ukf.sensor_std, before.filters[1].sensor_std);
    assert_eq!(ukf.initial_std[Channel::VELOCITY], 3.0 * before.filters[1].initial_std[Channel::VELOCITY]);
    scenario.filters[0].sensor_std[0] *= 2.0;
    let address = Address::parse(&before, "filters.EKF.sensor_std").unwrap();
    assert!(address.get(&scenario).is_nan(), "one sensor alone has another factor");
}

#[test]
fn unknown_keys_are_refused() {
    let its_plant = "; its plant has `natural_frequency`, `damping_ratio`, `initial.displacement`, ";
    let sensors =
        "; a sensor has `noise_std` and numbers of its `faults`, and its sensors are `displacement`, `velocity`";
    let all = "; it has `seed`, `dt`, `duration`, `force.white_noise.std`, and numbers of its `plant`, `sensors` and `filters`";
    let plants = "plant.mass plant.input_gain plant.natural_frequency.ramp.to plant.natural_frequency.step.by";
    let filters = "filters.EKF.fadng filters.EKF.sensor_std.acceleration filters.EKF.sensor_std.2 filters.EKF.initial_mean.cubic_stiffness";
    let each = |keys: &'static str, instead: &'static str| keys.split(' ').map(move |key| (key, instead));
    let cases = each("", all).chain(each(plants, its_plant)).chain(each("filters.EKF", ""));
    let cases = cases.chain(each(filters, "; a filter has `fading`, `eta`, `jump`, "));
    let others =
        [("filters.KF.fading", "; its filters are `EKF` and `UKF`"), ("sensors.acceleration.noise_std", sensors)];
    for (key, instead) in cases.chain(others) {
        let unknown = Address::parse(&Scenario::default(), key).unwrap_err().to_string();
        let begin = format!("the scenario has no number `{key}` to vary{instead}");
        assert!(if instead.ends_with(' ') { unknown.starts_with(&begin) } else { unknown == begin }, "{unknown}");
    }
}

#[test]
fn an_address_is_written_by_id_and_is_none_where_an_id_is_not_unique() {
    let mut scenario = Scenario::default();
    for (text, written) in [
        ("filters.UKF.sensor_std.1", "filters#2.sensor_std.velocity"),
        ("filters.EKF.process_std", "filters#1.process_std"),
        ("filters.*.initial_mean.natural_frequency", "filters.*.initial_mean.natural_frequency"),
        ("sensors.0.noise_std", "sensors.displacement.noise_std"),
    ] {
        let address = Address::parse(&scenario, text).unwrap();
        assert_eq!(address.to_string(), written);
        assert_eq!(Address::parse(&scenario, written).unwrap(), address);
        assert!(!address.name.contains('.'), "{}", address.name);
    }
    let ukf = Address::parse(&scenario, "filters.UKF.fading").unwrap();
    let filter = scenario.filters.remove(0);
    ukf.set(&mut scenario, 1.25);
    assert_eq!(scenario.filters[0].fading, 1.25, "it is the same filter at another place");
    scenario.filters.push(FilterSettings { id: 2, ..filter });
    assert!(Address::parse(&scenario, "filters.EKF.fading").is_err(), "which of the two?");
}

#[test]
fn a_factor_and_a_number_of_its_table_overlap() {
    let scenario = Scenario::default();
    let overlap = |a: &str, b: &str| {
        let [a, b] = [a, b].map(|text| Address::parse(&scenario, text).unwrap());
        assert_eq!(a.overlaps(&b), b.overlaps(&a));
        a.overlaps(&b)
    };
    assert!(overlap("filters.*.process_std", "filters.*.process_std.velocity"));
    assert!(overlap("seed", "seed") && !overlap("seed", "dt"));
    assert!(overlap("filters.*.process_std", "filters#2.process_std.velocity"));
    assert!(overlap("filters#2.process_std", "filters.UKF.process_std"));
    assert!(!overlap("filters#2.process_std", "filters#1.process_std"));
    assert!(!overlap("filters#2.process_std", "filters#2.initial_std"));
    assert!(!overlap("filters.*.process_std.velocity", "filters.*.process_std.displacement"));
}

#[test]
fn every_number_has_an_address_that_is_read_back_and_words_that_find_it() {
    let scenario = Scenario::default();
    let all = addresses(&scenario);
    assert!(all.len() > 40, "{}", all.len());
    for address in &all {
        assert_eq!(Address::parse(&scenario, &address.to_string()).as_ref(), Ok(address));
        assert!(address.get(&scenario).is_finite(), "{address}");
    }
    let found = |words: &[&str]| {
        let has = |address: &&Address| words.iter().all(|word| words_of(&scenario, address).contains(word));
        all.iter().filter(has).map(Address::to_string).collect::<Vec<_>>()
    };
    assert_eq!(found(&["lambda", "ekf"]), ["filters#1.fading"]);
    assert_eq!(found(&["process", "zeta", "ukf"]), ["filters#2.process_std.damping_ratio"]);
    assert_eq!(found(&["time of the change"]), ["plant.natural_frequency.step.at"]);
    assert_eq!(found(&["seed"]), ["seed"]);
}

fn with_dots() -> Scenario {
    let mut scenario = Scenario::default();
    scenario.filters[1].name = "EKF.2".to_owned();
    scenario
}

#[test]
fn filters_are_found_by_id_by_name_and_all_at_once() {
    let scenario = with_dots();
    for (address, places, key) in [
        ("filters#1.fading", &[0][..], "fading"),
        ("filters#2.process_std.velocity", &[1], "process_std.velocity"),
        ("filters.EKF.fading", &[0], "fading"),
        ("filters.EKF.2.fading", &[1], "fading"),
        ("filters.2.sensor_std.velocity", &[1], "sensor_std.velocity"),
        ("filters.*.eta", &[0, 1], "eta"),
    ] {
        assert_eq!(scenario.filters_at(address), Some((places.to_vec(), key)), "{address}");
    }
    let unknown = "filters#3.fading filters.3.fading filters.0.fading filters#x.fading filters.UKF.fading filters#1 seed filters. ";
    for address in unknown.split(' ') {
        assert_eq!(scenario.filters_at(address), None, "{address}");
    }
}

#[test]
fn an_address_by_id_survives_a_new_name() {
    let mut scenario = with_dots();
    let address = scenario.address_by_id("filters.EKF.2.sensor_std.velocity");
    assert_eq!(address, "filters#2.sensor_std.velocity");
    scenario.filters[1].name = "filters#1.x".to_owned();
    assert_eq!(scenario.filters_at(&address), Some((vec![1], "sensor_std.velocity")));
    assert_eq!(scenario.address_by_name(&address), "filters.filters#1.x.sensor_std.velocity");
    for same in ["filters.*.fading", "seed", "filters.KF.fading", "filters#9.fading"] {
        assert_eq!((scenario.address_by_id(same), scenario.address_by_name(same)), (same.into(), same.into()));
    }
}

#[test]
fn edits_are_turned_by_their_keys() {
    let mut scenario = Scenario::default();
    scenario.filters[1].name = "UKF, no. 2".to_owned();
    let [ekf, ukf] = [scenario.filters[0].id, scenario.filters[1].id];
    let edits = [
        Edit::new("hold", "first"),
        Edit::of_filter(ukf, "process_std.velocity", 0.5),
        Edit::of_filter(ukf, "sensor_std", vec![0.1, 0.2]),
        Edit::of_filter(ekf, "plant", "duffing"),
        Edit::of_filter(ekf, "augment", vec!["input_gain"]),
    ];
    let turned = Edit::apply_all(&edits, &scenario).unwrap();
    assert_eq!((turned.hold, turned.filters[0].plant.clone()), (Hold::First, Some(PlantKind::DUFFING)));
    assert_eq!(turned.filters[0].augment, [Channel::INPUT_GAIN]);
    assert_eq!(turned.filters[1].process_std[Channel::VELOCITY], 0.5);
    assert_eq!(turned.filters[1].sensor_std, [0.1, 0.2]);
    assert_eq!(edits[1].toml_line(), "process_std.velocity = 0.5");
    assert_eq!(edits[2].toml_line(), "sensor_std = [0.1, 0.2]");
    let rounded = Edit::of_filter(ekf, "sensor_std", vec![0.012_345_678, 1.005]).rounded();
    assert_eq!(rounded.toml_line(), "sensor_std = [0.01235, 1.005]");
    let mut renamed = scenario.clone();
    (renamed.filters[0].name, renamed.filters[1].name) = ("UKF, no. 2".to_owned(), "EKF".to_owned());
    let turned = Edit::of_filter(ekf, "fading", 1.5).apply(&renamed).unwrap();
    assert_eq!((turned.filters[0].fading, turned.filters[1].fading), (1.5, scenario.filters[1].fading));
    renamed.filters[1].id = ekf;
    assert!(Edit::of_filter(ekf, "fading", 1.0).apply(&renamed).is_err(), "which of the two?");
}

#[test]
fn every_kind_of_place_can_be_edited() {
    let scenario = Scenario::default();
    let table = |text: &str| Value::Table(text.parse().unwrap());
    let edits = [
        Edit::new("plant.natural_frequency", table("step = { from = 1.0, to = 2.0, at = 3.0 }")),
        Edit::new("force", "none"),
        Edit::new("duration", 10),
        Edit::new("sensors.velocity.noise_std", 0.2),
        Edit::new("filters.*.fading", 1),
        Edit::new("filters.EKF.sensor_std.1", 7.0),
        Edit::new("filters.EKF.sensor_std.displacement", 8.0),
        Edit::new("filters.UKF.substeps", 3),
        Edit::new("filters.UKF.name", "U"),
    ];
    let edited = Edit::apply_all(&edits, &scenario).unwrap();
    assert_eq!(edited.plant.parameter(Channel::NATURAL_FREQUENCY).map(|signal| signal.at(2.0)), Some(1.0));
    assert_eq!((edited.force, edited.duration, edited.sensors[1].noise_std), (Force::None, 10.0, 0.2));
    let [ekf, ukf] = &edited.filters[..] else { panic!("two filters") };
    assert_eq!((ekf.fading, &ekf.sensor_std[..], ukf.fading), (1.0, &[8.0, 7.0][..], 1.0));
    assert_eq!((ukf.substeps, ukf.name.as_str()), (3, "U"));
}

#[test]
fn settings_that_there_are_not_cannot_be_edited() {
    let mut scenario = Scenario::default();
    scenario.plant.set(Channel::NATURAL_FREQUENCY, Signal::Constant(6.0));
    let keys = " plnt.natural_frequency plant.frequency plant.natural_frequency.step filters.EKF filters.* filters.KF.fading \
         filters.*.fadng filters.EKF.sensor_std.2 filters.EKF.sensor_std.acceleration sensors.acceleration.noise_std \
         record.every";
    for key in keys.split(' ') {
        let error = Edit::new(key, 1.0).apply(&scenario).unwrap_err().to_string();
        let last = key.rsplit('.').next().unwrap_or_default();
        let is_unread = error.contains(&format!("unknown field `{last}`"));
        assert!(is_unread || error.starts_with(&format!("the scenario has no setting `{key}`")), "{error}");
    }
    let impossible = Edit::new("filters.EKF.fading", 0.5).apply(&scenario).unwrap_err().to_string();
    assert!(impossible.starts_with("`filters[0].fading` is 0.5"), "{impossible}");
}

type Step = fn(&Scenario, &mut Change);

const STEPS: [(Step, &str); 10] = [
    (|of, change| change.set(of, "filters.*.eta", 1.5), "filters#1.eta filters#2.eta"),
    (
        |of, change| change.set(of, "filters.EKF.sensor_std", 2.0),
        "filters#1.sensor_std.displacement filters#1.sensor_std.velocity",
    ),
    (|_, change| change.edit(Edit::of_filter(1, "kind", "ckf")), "filters#1.kind"),
    (|_, change| change.edit(Edit::new("plant.natural_frequency", 5.0)), "plant.natural_frequency"),
    (|_, change| change.put("draw", &None::<bool>), "draw"),
    (|_, change| change.set_plant(PlantKind::DUFFING), "sensors.displacement sensors.velocity plant.kind"),
    (|_, change| change.put_sensor(Sensor::new(Quantity::ACCELERATION, 0.3)), "sensors.acceleration"),
    (|_, change| change.remove_sensor(Quantity::DISPLACEMENT), "sensors.displacement"),
    (|_, change| change.remove_filter(1), "filters#1."),
    (|of, change| change.put_filter(1, FilterSettings { id: 3, ..of.filters[0].clone() }), "filters#3."),
];

fn scenario() -> Scenario {
    let mut scenario = Scenario::default();
    scenario.draw.insert("plant.natural_frequency".to_owned(), Law::Normal([6.0, 0.1]));
    scenario
}

fn changed(step: Step) -> (Scenario, Vec<String>) {
    let (mut scenario, mut change) = (scenario(), Change::default());
    step(&scenario, &mut change);
    let keys = change.apply(&mut scenario).unwrap();
    (scenario, keys)
}

#[test]
fn a_change_has_the_addresses_of_what_it_changes_and_leaves_all_others() {
    for (step, addresses) in STEPS {
        let (now, keys) = changed(step);
        assert_eq!(keys.join(" "), addresses);
        let mut elsewhere = Scenario { seed: 77, ..scenario() };
        let mut change = Change::default();
        step(&scenario(), &mut change);
        change.apply(&mut elsewhere).unwrap();
        assert_eq!(elsewhere, Scenario { seed: 77, ..now }, "{addresses}, elsewhere");
    }
}

#[test]
fn what_was_before_is_said_in_the_words_of_the_settings() {
    let said = |step: Step| {
        let (now, keys) = changed(step);
        Changed::among(&keys, &scenario(), &now).what_was(|number| number.to_string()).join(", ")
    };
    assert_eq!(said(|_, change| change.edit(Edit::new("force", "none"))), "force over time = white noise");
    assert_eq!(said(|_, change| change.edit(Edit::new("hold", "first"))), "input between samples = held");
    assert_eq!(said(|of, change| change.set(of, "filters#1.jump", 1.0)), "EKF jump at a sudden change = no");
    assert_eq!(said(|_, change| change.edit(Edit::of_filter(2, "robust", "gate"))), "UKF outliers = none");
    assert_eq!(said(|_, change| change.remove_filter(2)), "with UKF");
    let other = |of: &Scenario, change: &mut Change| {
        change.put_filter(0, FilterSettings { eta: 0.5, fading: 1.0, ..of.filters[0].clone() });
        change.remove_sensor(Quantity::VELOCITY);
    };
    assert_eq!(said(other), "EKF η = 0, EKF λ = 1.005, EKF delay v = 0, EKF √R v = 0.06, with the velocity sensor");
    assert_eq!(said(|_, change| change.edit(Edit::new("plant.natural_frequency", 5.0))), "plant ωₙ = step");
    let more = |of: &Scenario, change: &mut Change| {
        change.put_filter(1, FilterSettings { id: 3, name: "C".to_owned(), ..of.filters[0].clone() });
        change.edit(Edit::of_filter(3, "fading", 1.5));
    };
    assert_eq!(said(more), "without C");
    assert_eq!(said(|of, change| change.set(of, "seed", 1.0)), "");
}

#[test]
fn a_change_tells_whose_results_it_concerns() {
    let concerned = |step: Step| {
        let ((now, keys), before) = (changed(step), scenario());
        let changed = Changed::among(&keys, &before, &now);
        (changed.is_of_filters(), [1, 2].map(|id| changed.concerns(id)))
    };
    assert_eq!(concerned(|of, change| change.set(of, "filters.UKF.fading", 1.5)), (true, [false, true]));
    assert_eq!(concerned(|_, change| change.edit(Edit::of_filter(2, "name", "other"))), (true, [false, false]));
    assert_eq!(concerned(|of, change| change.set(of, "seed", 7.0)), (false, [true, true]));
}

#[test]
fn options_that_the_others_exclude_are_turned_off_and_said() {
    let mut scenario = scenario();
    scenario.filters[0].walk = 0.1;
    let mut change = Change::default();
    change.set(&scenario, "filters#1.smoother", 1.0);
    assert_eq!(change.apply(&mut scenario).unwrap(), ["filters#1.smoother", "filters#1.walk"]);
    assert!(scenario.filters[0].smoother && scenario.validate().is_ok());
}

#[test]
fn a_setting_that_is_gone_is_not_changed() {
    let mut change = Change::default();
    change.set(&scenario(), "filters#1.fading", 1.5);
    let mut without = scenario();
    without.filters.remove(0);
    let error = change.apply(&mut without).unwrap_err();
    assert_eq!(error.to_string(), "the scenario has no setting `filters#1.fading`");
}

#[test]
fn values_run_from_end_to_end() {
    let axis = Axis::parse("a.b=2:4:5").unwrap();
    assert_eq!((0..5).map(|k| axis.value(k)).collect::<Vec<_>>(), [2.0, 2.5, 3.0, 3.5, 4.0]);
    let ratios = Axis::parse("x=-3").unwrap_err();
    assert_eq!(ratios, AxisError::Syntax("x=-3".to_owned()));
    let seeds = Axis::parse("seed=1:100:100").unwrap();
    assert!((0..100).all(|k| seeds.value(k) == (k + 1) as f64));
    let axis = Axis::parse("filters.A = b.fading=1e-2:1:3:log").unwrap();
    assert_eq!(axis.key, "filters.A = b.fading");
    assert_eq!((0..3).map(|k| axis.value(k)).collect::<Vec<_>>(), [0.01, 0.1, 1.0]);
    let wide = Axis::parse("x=1e-300:1e300:3:log").unwrap();
    assert!((wide.value(1) - 1.0).abs() < 1e-12, "the ratio of the ends is no number");
}

#[test]
fn places_and_values_are_inverse() {
    for text in ["x=2:30:57", "x=30:2:57", "x=0.001:10:33:log"] {
        let axis = Axis::parse(text).unwrap();
        for place in 0..axis.count {
            assert_eq!(axis.place_of(axis.value(place)), Some(place), "{text}");
        }
        assert_eq!(axis.place_of(1e4), None);
    }
    assert_eq!(Axis::parse("x=1:10:3:log").unwrap().place_of(-1.0), None);
    assert_eq!(Axis::parse("x=5:5:1").unwrap().place_of(5.0), Some(0));
}

#[test]
fn impossible_axes_are_refused() {
    for text in ["x=0:1:5:log", "x=nan:1:5", "x=0:1:0", "x=0:1", "x", "x=a:1:2", "x=0:1:2:lin"] {
        assert!(Axis::parse(text).is_err(), "{text}");
    }
}

#[test]
fn usual_axes_are_possible_and_hold_the_present_value() {
    let scenario = Scenario::default();
    let keys = "seed filters.EKF.fading filters.EKF.process_std filters.EKF.process_std.natural_frequency \
                filters.EKF.sensor_std.velocity filters.EKF.initial_mean.natural_frequency \
                filters.EKF.initial_mean.displacement sensors.velocity.noise_std plant.damping_ratio";
    for key in keys.split_whitespace() {
        let setting = Address::parse(&scenario, key).unwrap();
        let axis = Axis::usual(&setting, &scenario, 33);
        axis.check().unwrap();
        let share = axis.share_of(setting.get(&scenario));
        assert!((0.0..=1.0).contains(&share), "{key}: {share}");
    }
}

fn each<T: Default + serde::Serialize + serde::de::DeserializeOwned + 'static>(all: &[&ChoiceInfo<T>]) {
    for info in all {
        // A file leaves out a default.
        let default = (info.value)((info.get)(&T::default()));
        let mut of = T::default();
        for (place, option) in (info.options)().into_iter().enumerate() {
            let mut document = document::of(&of).unwrap();
            document[info.key] = document::of(&(info.value)(place)).unwrap();
            of = document::read(&document).unwrap();
            assert_eq!(((info.get)(&of), info.chosen(&of)), (place, Some(option)), "{info:?}");
            let file = document::of(&of).unwrap().get(info.key).map(|value| Value::try_from(value).unwrap());
            assert_eq!(file.as_ref().unwrap_or(&default), &(info.value)(place), "{info:?} in a file");
        }
    }
}

#[test]
fn every_option_is_set_found_and_written_in_files_as_the_row_says() {
    each(&CHOICES_OF_SCENARIO);
    each(&CHOICES_OF_FILTER);
}

#[test]
fn other_choices_can_be_made() {
    let scenario = Scenario::default();
    let all = other_choices(&scenario);
    assert_eq!(all.len(), 1 + 1 + 5 + 2 * (3 + Robust::ALL.len() - 1) - 3, "a UKF has no steps of its own");
    for edit in &all {
        let edited = edit.apply(&scenario).unwrap();
        assert_ne!(edited, scenario, "{}", edit.key);
        assert!(!edit.in_words(&scenario).contains(" = "), "{}", edit.in_words(&scenario));
    }
}

#[test]
fn every_number_of_every_shape_is_read_and_set_at_its_address() {
    let shape = CHOICES_OF_SCENARIO.into_iter().find(|info| info.key == "force").unwrap();
    let mut found = 0;
    for place in 0..(shape.options)().len() {
        let mut scenario = Edit::new("force", (shape.value)(place)).apply(&Scenario::default()).unwrap();
        for info in &FORCE {
            let address = Address::parse(&scenario, info.key);
            assert_eq!(address.is_ok(), !(info.get)(&scenario).is_nan(), "{info:?} of {:?}", scenario.force);
            let Ok(address) = address else { continue };
            address.set(&mut scenario, 7.5);
            assert_eq!((address.get(&scenario), (info.get)(&scenario)), (7.5, 7.5), "{info:?}");
            found += 1;
        }
    }
    assert_eq!(found, FORCE.len(), "each serves in one shape");
}

#[test]
fn limits_are_kept_and_said() {
    for (allowed, inside, outside, words) in [
        (Allowed::Finite, -1e300, f64::INFINITY, "a finite number"),
        (Allowed::Above(0.0), 1e-300, 0.0, "a finite number above 0"),
        (Allowed::AtLeast(1.0), 1.0, 0.999, "a finite number, at least 1"),
        (Allowed::Between(0.0, 1.0), 0.5, 1.0, "between 0 and 1"),
        (Allowed::Within(0.0, 1.0), 1.0, 1.001, "from 0 to 1"),
        (Allowed::Whole(2, 9), 9.0, 10.0, "from 2 to 9"),
        (Allowed::Flag, 1.0, 2.0, "true or false"),
    ] {
        assert!(allowed.admits(inside) && !allowed.admits(outside) && !allowed.admits(f64::NAN), "{allowed:?}");
        assert_eq!(allowed.to_string(), words);
        assert!(allowed == Allowed::Finite || allowed.admits(allowed.least()), "{allowed:?}");
    }
}
