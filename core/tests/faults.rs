//! Each family of sensor faults follows its law, and changes nothing else.

use kalmanscope_core::scenario::{Fault, Faults};
use kalmanscope_core::{Channel, Quantity, Record, Scenario, Sensor, simulate};

use crate::numbers::{bits, mean, rms};

fn at_rest(fault: &str) -> Scenario {
    let text = format!(
        "seed = 5\ndt = 0.01\nduration = 2000.0\nfilters = []\nforce = \"none\"\n[[sensors]]\nmeasures = \"displacement\"\n\
         noise_std = 0.02\nfaults = {{ {fault} }}\n"
    );
    Scenario::from_toml(&text).unwrap_or_else(|e| panic!("{fault}: {e}"))
}

fn readings(scenario: &Scenario) -> Vec<f64> {
    simulate(scenario).measured(0).to_vec()
}

fn swinging(fault: &str, duration: f64, noise_std: f64) -> Vec<f64> {
    let mut scenario = Scenario { duration, ..at_rest(fault) };
    (scenario.plant.initial.displacement, scenario.sensors[0].noise_std) = (1.0, noise_std);
    scenario.plant.set(Channel::DAMPING_RATIO, 0.001);
    readings(&scenario)
}

fn both(fault: &str) -> [Vec<f64>; 2] {
    [readings(&at_rest(fault)), readings(&at_rest(""))]
}

fn share(values: &[f64], is: impl Fn(f64) -> bool) -> f64 {
    values.iter().filter(|x| is(**x)).count() as f64 / values.len() as f64
}

#[track_caller]
fn assert_near(value: f64, expected: f64, within: f64) {
    assert!((value - expected).abs() <= within, "{value} for {expected} ± {within}");
}

#[test]
fn a_fault_of_one_sensor_leaves_the_truth_and_the_other_sensor_alone() {
    let clean = Scenario { duration: 5.0, ..Scenario::default() };
    for fault in Fault::ALL {
        let mut faulty = clean.clone();
        faulty.sensors[0].faults.add(fault, Quantity::DISPLACEMENT);
        let records = [&clean, &faulty].map(simulate);
        let column = |record: &Record, sensor: usize| bits(record.measured(sensor));
        assert_eq!(column(&records[0], 1), column(&records[1], 1), "{fault:?}");
        assert_eq!(records[0].truth(Channel::VELOCITY), records[1].truth(Channel::VELOCITY));
        let differ = column(&records[0], 0) != column(&records[1], 0);
        assert!(differ || fault == Fault::CHANGING, "{fault:?} does something");
    }
}

#[test]
fn student_s_noise_has_its_tails() {
    let [t, normal] = both("student_t = { freedom = 3 }");
    // P(|t₃| > 3.182) = 0.05; P(|t₃| > 0.7649) = 0.5.
    assert_near(share(&t, |x| x.abs() > 3.182 * 0.02), 0.05, 0.002);
    assert_near(share(&t, |x| x.abs() > 0.7649 * 0.02), 0.5, 0.005);
    assert_near(share(&normal, |x| x.abs() > 0.02 * 1.96), 0.05, 0.002);
}

#[test]
fn coloured_noise_has_its_size_and_its_correlation() {
    let [coloured, _] = both("coloured = { time = 0.05 }");
    let at = |lag: usize| mean(&coloured.windows(lag + 1).map(|x| x[0] * x[lag]).collect::<Vec<_>>()) / 4e-4;
    for lag in [0, 1, 5, 10] {
        assert_near(at(lag), (-0.01 * lag as f64 / 0.05).exp(), 0.03);
    }
}

#[test]
fn noise_changes_at_its_time() {
    let [changing, clean] = both("changing = { at = 1000.0, factor = 5.0 }");
    assert_eq!(changing[..100_000], clean[..100_000]);
    assert!(changing[100_001..].iter().zip(&clean[100_001..]).all(|(a, b)| (a - 5.0 * b).abs() < 1e-12));
}

/// An error of the time is an error of the reading that is the speed times it; uniform, it is of 0.5/√3 steps.
#[test]
fn jitter_is_an_error_of_the_time() {
    let [clean, jittered] = ["", "jitter = { spread = 0.5 }"].map(|fault| swinging(fault, 100.0, 0.0));
    let shift = |k: usize| {
        let slope = 0.5 * (clean[k + 1] - clean[k - 1]);
        (slope.abs() > 0.03).then(|| (jittered[k] - clean[k]) / slope)
    };
    let shifts: Vec<f64> = (2..clean.len() - 1).filter_map(shift).collect();
    assert!(shifts.len() > 1000, "{}", shifts.len());
    assert_near(mean(&shifts), 0.0, 0.02);
    assert_near(rms(&shifts).powi(2), 0.25 / 3.0, 0.005);
    assert!(shifts.iter().all(|x| x.abs() < 0.51));
}

#[test]
fn biases_scales_limits_and_steps_are_exact() {
    let moving = |fault: &str| swinging(fault, 10.0, 0.02);
    let clean = moving("");
    let pairs = |fault: &str| moving(fault).into_iter().zip(clean.clone()).collect::<Vec<_>>();
    assert!(pairs("bias = { offset = 0.3 }").iter().all(|(a, b)| (a - b - 0.3).abs() < 1e-12));
    assert!(pairs("clipped = { limit = 0.4 }").iter().all(|(a, b)| *a == b.clamp(-0.4, 0.4)));
    let coarse = pairs("quantised = { step = 0.25 }");
    assert!(coarse.iter().all(|(a, b)| (a / 0.25).fract() == 0.0 && (a - b).abs() <= 0.125));
    // The noise is that of the sensor, whatever its scale.
    assert!(pairs("scaled = { factor = -1.0 }").iter().all(|(a, b)| (a + b).abs() < 0.2));
    let late = moving("late = { delay = 0.2 }");
    assert!(late[..20].iter().all(|x| x.is_nan()));
    assert_eq!(late[20..], clean[..clean.len() - 20]);
}

#[test]
fn outliers_have_their_share_and_their_size() {
    let [outliers, clean] = both("outliers = { share = 0.1, from = 10.0, to = 30.0 }");
    let errors: Vec<f64> = outliers.iter().zip(&clean).map(|(a, b)| (a - b) / 0.02).filter(|e| *e != 0.0).collect();
    assert_near(errors.len() as f64 / clean.len() as f64, 0.1, 0.003);
    assert!(errors.iter().all(|e| (10.0 - 1e-9..30.0 + 1e-9).contains(&e.abs())));
    assert_near(mean(&errors.iter().map(|e| e.abs()).collect::<Vec<_>>()), 20.0, 0.2);
    assert_near(share(&errors, |e| e > 0.0), 0.5, 0.02);
    // More of them include these.
    let more = readings(&at_rest("outliers = { share = 0.2, from = 10.0, to = 30.0 }"));
    assert!(outliers.iter().zip(&clean).zip(&more).all(|((a, b), c)| a == b || a == c));
    let [above, clean] = both("outliers_above = { share = 0.05, from = 5.0, to = 6.0 }");
    assert!(above.iter().zip(&clean).all(|(a, b)| a >= b));
}

#[test]
fn spells_have_their_share_and_their_length() {
    for (wanted, length) in [(0.1, 0.2), (0.3, 1.0), (0.2, 0.0), (1.0, 0.5)] {
        let [dropouts, clean] = both(&format!("dropouts = {{ share = {wanted}, length = {length} }}"));
        assert!(wanted < 1.0 || dropouts.iter().all(|x| x.is_nan()), "all are missing");
        assert_near(share(&dropouts, f64::is_nan), wanted, 0.12 * wanted.min(1.0 - wanted) + 1e-9);
        assert!(dropouts.iter().zip(&clean).all(|(a, b)| a.is_nan() || a == b));
        if (0.05..0.9).contains(&wanted) {
            let spells = dropouts.windows(2).filter(|x| x[0].is_finite() && x[1].is_nan()).count() as f64;
            let mean_length = 0.01 * dropouts.iter().filter(|x| x.is_nan()).count() as f64 / spells;
            // Spells that follow each other are one.
            let q = wanted * (0.01 / f64::max(length, 0.01)) / (1.0 - wanted + wanted * 0.01 / f64::max(length, 0.01));
            assert_near(mean_length, f64::max(length, 0.01) / (1.0 - q), 0.1 * f64::max(length, 0.01));
        }
    }
    let long = readings(&at_rest("dropouts = { share = 1.0, length = 1e300 }"));
    assert!(long.iter().all(|x| x.is_nan()), "a spell without an end");
    let [stuck, _] = both("stuck = { share = 0.2, length = 0.3 }");
    let repeated = stuck.windows(2).filter(|x| x[0] == x[1]).count() as f64 / stuck.len() as f64;
    assert_near(repeated, 0.2, 0.02);
}

#[test]
fn faults_are_read_and_written() {
    let mut faults = Faults::NONE;
    Fault::ALL.into_iter().for_each(|fault| faults.add(fault, Quantity::ACCELERATION));
    let mut scenario = Scenario::default();
    scenario.add_sensor(Sensor { faults, ..Sensor::new(Quantity::ACCELERATION, 0.5) });
    scenario.validate().expect("usual numbers are possible");
    let again = Scenario::from_toml(&scenario.to_toml().expect("it can be written")).expect("it can be read");
    assert_eq!(again.sensors, scenario.sensors);
    let text = Scenario::default().to_toml().expect("it can be written");
    assert!(!text.contains("faults"), "what is not there is not written");
}

#[test]
fn extreme_numbers_end_the_truth_in_words_or_change_nothing() {
    for (fault, stops) in [
        ("outliers = { share = 1.0, from = 1e308, to = 1e308 }", true),
        ("bias = { offset = 1e308 }", false),
        ("scaled = { factor = 1e300 }", false),
        ("quantised = { step = 1e-320 }", false),
        ("quantised = { step = 1e300 }", false),
        ("changing = { at = 0.0, factor = 1e307 }", false),
        ("late = { delay = 1e300 }", false),
        ("stuck = { share = 1.0, length = 1e300 }", false),
        ("student_t = { freedom = 1 }", false),
    ] {
        let mut scenario = at_rest(fault);
        scenario.duration = 1.0;
        scenario.sensors[0].noise_std = if stops { 10.0 } else { 0.02 };
        let record = simulate(&scenario);
        assert_eq!(record.len() < scenario.samples(), stops, "{fault}");
        assert!(record.measured(0).iter().all(|x| !x.is_infinite()));
    }
}
