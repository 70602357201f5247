//! Parts of the evidence alone: spectra, changes, readings, two sensors that disagree, and numbers in words and in stories.

use kalmanscope_core::filter::Normal;
use kalmanscope_core::signal::Step;
use kalmanscope_core::{Channel, Scenario, Signal};
use kalmanscope_diagnosis::internals::{
    Agreement, Periodogram, Readings, change_point, percent, percent_to_a_tenth, plain, seconds, short, still_part,
};
use kalmanscope_diagnosis::{Adjustable, Phrase, Story, with_band};

use crate::run::finished;

#[test]
fn white_noise_is_flat_and_a_wave_is_a_line() {
    let mut normal = Normal::from_seed(3);
    let noise: Vec<f64> = (0..8192).map(|_| normal.sample()).collect();
    let wave: Vec<f64> = (0..8192).map(|k| noise[k] + libm::sin(0.7 * k as f64)).collect();
    let all = std::slice::from_ref(&(0..8192));
    let [flat, line] = &Periodogram::of_all(&[noise.clone(), wave.clone()], all)[..] else { panic!() };
    assert!((flat.mean() - 1.0).abs() < 0.05 && flat.peak().unwrap().0 < 4.0, "{:?}", flat.peak());
    let (power, frequency) = line.peak().unwrap();
    assert!(power > 50.0 && (frequency - 0.7).abs() < 0.002, "{power} at {frequency}");
    let alone = &Periodogram::of_all(&[wave], all)[0];
    assert!((alone.peak().unwrap().0 / power - 1.0).abs() < 1e-9);
    assert_eq!(Periodogram::of_all(&[noise[..100].to_vec()], std::slice::from_ref(&(0..100)))[0].peak(), None);
}

#[test]
fn a_change_is_found_where_it_is() {
    let noise = |k: usize| 1.0 + libm::sin((k * k) as f64);
    for at in [400, 700, 950] {
        let squares: Vec<f64> = (0..1000).map(|k| if k < at { noise(k) } else { 3.0 * noise(k) }).collect();
        let change = change_point(&squares).unwrap();
        let (found, rise, p_value) = (change.at, change.rise, change.p_value);
        assert!(found.abs_diff(at) < 6 && (rise - 3.0).abs() < 0.6, "{found} instead of {at}, {rise} times");
        assert!(p_value < 1e-4, "{p_value} at {at}");
    }
    assert_eq!(change_point(&[]), None);
    assert_eq!(change_point(&[f64::NAN; 100]), None);
}

#[test]
fn squares_of_one_size_have_a_p_value_that_chance_explains() {
    let mut normal = Normal::from_seed(11);
    for memory in [0.0, 0.6] {
        let p_values = (0..200).map(|_| {
            let mut last = 0.0;
            let squares = (0..1000).map(|_| {
                last = memory * last + normal.sample();
                last * last * (1.0 - memory * memory)
            });
            change_point(&squares.collect::<Vec<_>>()).map_or(1.0, |change| change.p_value)
        });
        let p_values: Vec<f64> = p_values.collect();
        let below = |level: f64| p_values.iter().filter(|p| **p < level).count();
        assert!(below(0.1) <= 40 && below(0.001) <= 3, "{memory}: {} {}", below(0.1), below(0.001));
    }
}

#[test]
fn a_part_without_motion_is_found_beside_motion_only() {
    let moves = |k: usize| (0.1 * k as f64).sin();
    let dead: Vec<f64> = (0..1000).map(|k| if k < 750 { moves(k) } else { 0.0 }).collect();
    assert_eq!(still_part(&dead), Some(750..1000));
    let hole: Vec<f64> = (0..1000).map(|k| if (300..400).contains(&k) { 0.7 } else { moves(k) }).collect();
    assert_eq!(still_part(&hole), Some(300..400));
    let short: Vec<f64> = (0..1000).map(|k| if (300..340).contains(&k) { 0.7 } else { moves(k) }).collect();
    let step: Vec<f64> = (0..1000).map(|k| f64::from(u8::from(k > 100))).collect();
    let blows: Vec<f64> = (0..1000).map(|k| f64::from(u8::from(k < 600 && k % 100 == 0))).collect();
    for input in [short, step, blows, vec![0.0; 1000], Vec::new()] {
        assert_eq!(still_part(&input), None);
    }
}

fn readings(change: impl Fn(usize, f64) -> f64) -> Readings {
    let mut normal = Normal::from_seed(4);
    let (mut values, mut innovations) = (Vec::new(), Vec::new());
    for k in 0..2000_usize {
        let (x, noise) = ((0.06 * k as f64).sin(), normal.sample());
        let value = change(k, x + 0.01 * noise);
        values.push(value);
        innovations.push((value - x) / 0.01);
    }
    Readings { values, innovations }
}

#[test]
fn each_fault_is_found_and_no_other() {
    let none = |_: usize, x: f64| x;
    let clip = |_: usize, x: f64| x.clamp(-0.8, 0.8);
    let coarse = |_: usize, x: f64| (x / 0.05).round() * 0.05;
    let outliers = |k: usize, x: f64| if k % 50 == 7 { x + 0.2 } else { x };
    let growing = |k: usize, x: f64| if k < 1000 { x } else { x + 0.1 * (1.7 * (k * k) as f64).sin() };
    let found =
        |readings: &Readings| [readings.clipped().is_some(), readings.stuck().is_some(), readings.outliers().is_some()];
    assert_eq!(found(&readings(none)), [false; 3]);
    assert_eq!(found(&readings(clip))[0..2], [true, false]);
    assert_eq!(found(&readings(outliers)), [false, false, true]);
    assert!(!found(&readings(growing))[2], "noise that grows once is no outliers");
    let step = readings(coarse).step().unwrap();
    assert!((step / 0.05 - 1.0).abs() < 1e-6 && !found(&readings(coarse))[0], "{step}");
    assert_eq!(readings(none).step(), None);
    let mut stuck = readings(none);
    for k in (100..1900).filter(|k| k % 100 < 20 && k % 100 > 0) {
        stuck.values[k] = stuck.values[k - 1];
    }
    assert!(found(&stuck)[1] && !found(&stuck)[0]);
    let marked = stuck.stuck().unwrap();
    assert!((marked.share - 0.17).abs() < 0.02, "{}", marked.share);
}

#[test]
fn nothing_is_found_in_nothing() {
    for values in [Vec::new(), vec![f64::NAN; 300], vec![1.0; 300]] {
        let innovations = vec![f64::NAN; values.len()];
        let readings = Readings { values, innovations };
        assert!(readings.clipped().is_none() && readings.stuck().is_none() && readings.outliers().is_none());
        assert_eq!(readings.step(), None);
    }
}

fn two_sensors(change: impl Fn(f64) -> [f64; 2], seed: u64) -> [Vec<f64>; 2] {
    let mut normal = Normal::from_seed(seed);
    let mut columns = [Vec::new(), Vec::new()];
    for k in 0..4000 {
        let [x, v] = change(0.01 * f64::from(k));
        columns[0].push(x + 0.01 * normal.sample());
        columns[1].push(v + 0.06 * normal.sample());
    }
    columns
}

fn x(t: f64) -> f64 {
    0.3 * (6.0 * t).sin() + 0.1 * (4.1 * t + 1.0).cos()
}

fn v(t: f64) -> f64 {
    1.8 * (6.0 * t).cos() - 0.41 * (4.1 * t + 1.0).sin()
}

fn agreement(change: impl Fn(f64) -> [f64; 2], seed: u64) -> Agreement {
    let [values, rates] = two_sensors(change, seed);
    Agreement::of(&values, &rates, 1, 0.01, 0.06).unwrap()
}

#[test]
fn right_sensors_agree_also_where_noise_is_taken_for_too_large() {
    for seed in 0..20 {
        let [values, rates] = two_sensors(|t| [x(t), v(t)], seed);
        for times in [1.0, 5.0, 100.0] {
            let Agreement { factor, std, late, late_std, .. } =
                Agreement::of(&values, &rates, 1, 0.01, 0.06 * times).unwrap();
            assert!((factor - 1.0).abs() < 4.0 * std + 0.005, "{times}: {factor} ± {std}");
            assert!(late.abs() < 4.0 * late_std + 0.3, "{times}: {late} ± {late_std}");
        }
    }
}

#[test]
fn scale_sign_and_lateness_are_found() {
    for seed in 0..5 {
        assert!((agreement(|t| [1.2 * x(t), v(t)], seed).factor / 1.2 - 1.0).abs() < 0.01);
        assert!((agreement(|t| [x(t), 1.2 * v(t)], seed).factor * 1.2 - 1.0).abs() < 0.01);
        assert!((agreement(|t| [x(t), -v(t)], seed).factor + 1.0).abs() < 0.01);
        for late in [-7.0, 3.0, 20.0] {
            let found = agreement(|t| [x(t), v(t - 0.01 * late)], seed);
            assert!((found.late - late).abs() < 0.5, "{late}: {found:?}");
        }
        assert!((agreement(|t| [x(t), v(t) + 0.5], seed).factor - 1.0).abs() < 0.01, "a bias");
    }
}

#[test]
fn a_displacement_is_compared_with_its_acceleration() {
    let a = |t: f64| -10.8 * (6.0 * t).sin() - 1.681 * (4.1 * t + 1.0).cos();
    for (seed, scale) in [(1, 1.0), (2, 0.102), (3, -1.0)] {
        let [values, _] = two_sensors(|t| [x(t), v(t)], seed);
        let mut normal = Normal::from_seed(100 + seed);
        let read: Vec<f64> = (0..4000).map(|k| scale * a(0.01 * f64::from(k)) + 0.1 * normal.sample() + 0.5).collect();
        let Agreement { factor, .. } = Agreement::of(&values, &read, 2, 0.01, 0.1).unwrap();
        assert!((factor * scale - 1.0).abs() < 0.03, "{scale}: {factor}");
    }
}

#[test]
fn what_cannot_be_compared_is_not() {
    let mut normal = Normal::from_seed(1);
    let noise: Vec<f64> = (0..1000).map(|_| normal.sample()).collect();
    for order in [1, 2] {
        assert!(Agreement::of(&noise, &noise, order, 0.01, 1.0).is_none());
        assert!(Agreement::of(&[], &[], order, 0.01, 1.0).is_none());
        assert!(Agreement::of(&[0.0; 500], &[0.0; 500], order, 0.01, 1.0).is_none());
    }
}

#[test]
fn no_number_is_longer_than_can_be_read_or_has_more_digits_than_one_reads() {
    assert_eq!([0.0, 0.01, 2.0, 12.3, 1e45, f64::INFINITY].map(short), ["0", "0.010", "2.0", "12", "1.0e45", "∞"]);
    assert_eq!([-0.01, -2.0, -1e-9, f64::NEG_INFINITY].map(short), ["-0.010", "-2.0", "-1.0e-9", "-∞"]);
    assert_eq!([0.001, 0.5, 0.999, 1e40].map(percent), ["less than 1 %", "50 %", "more than 99 %", "1.0e42 %"]);
    assert_eq!(
        [8.0, 1.005, 0.05, 6.3456, 1500.0, 1e-7, -2.5].map(plain),
        ["8", "1.005", "0.05", "6.346", "1500", "1.0e-7", "-2.5"]
    );
    assert_eq!(
        [0.36, 0.014, 0.0002, 0.0, -0.5].map(percent_to_a_tenth),
        ["36 %", "1.4 %", "less than 0.1 %", "less than 0.1 %", "50 %"]
    );
    assert_eq!(with_band(429.2134, 0.12, "rad/s"), "429.21 ± 0.12 rad/s");
    assert_eq!(with_band(429.2134, 0.3, "rad/s"), "429.2 ± 0.3 rad/s");
    assert_eq!(with_band(0.0478, 0.003, ""), "0.048 ± 0.003");
    assert_eq!(with_band(1200.0, 45.0, "N"), "1200 ± 45 N");
    assert_eq!(with_band(6.0, 0.0, "rad/s"), "6.000 rad/s");
    assert_eq!(with_band(6.0, 1e-12, "rad/s"), "6.00e0 ± 1e-12 rad/s");
    assert_eq!(with_band(54_321.123_456, 1e-5, ""), "54321.123 ± 1e-5");
    assert_eq!([0.04, 2.44, 120.0].map(seconds), ["0.04 s", "2.4 s", "120 s"]);
}

fn change(from: f64, to: f64) -> Adjustable {
    let mut scenario = Scenario { duration: 2.0, ..Scenario::default() };
    scenario.plant.set(Channel::NATURAL_FREQUENCY, Signal::Step(Step { from, to, at: 1.0 }));
    let story = Story::of(&finished(&scenario), &[], &[]);
    let mut settings = story.sentences.iter().flatten().filter_map(Phrase::setting);
    settings.find(|one| one.address == "plant.natural_frequency.step.to").unwrap().clone()
}

#[test]
fn a_share_of_the_stiffness_is_a_natural_frequency() {
    let loss = change(6.0, 4.8);
    assert_eq!((loss.to_string().as_str(), loss.value(loss.shown)), ("36 %", 4.8));
    assert!((loss.value(75.0) - 3.0).abs() < 1e-12 && loss.value(100.0) == 0.0);
    let gain = change(4.0, 6.0);
    assert_eq!((gain.to_string().as_str(), gain.value(gain.shown)), ("125 %", 6.0));
    assert_eq!(loss.showing(50.0).to_string(), "50 %");
    assert!((loss.at(3.0).shown - 75.0).abs() < 1e-12 && (gain.at(4.0).shown).abs() < 1e-12);
}
