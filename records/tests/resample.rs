//! Other rates, bands and steps.

use std::f64::consts::PI;

use kalmanscope_filters::Hold;
use kalmanscope_records::resample::{
    Section, anti_alias, band_pass, end_of_part, finer_input, interpolate, keep_every, sections,
};

#[test]
fn a_part_has_a_reading_where_a_second_more_is_the_same_number() {
    for power in -9..=19 {
        let step = 10_f64.powi(power);
        for start in [0.0, 1.0, 1.714_564_8e18, 1e19] {
            let times: Vec<f64> = (0..50).map(|k| start + f64::from(k) * step).collect();
            let ends = (0..times.len()).map(|place| end_of_part(&times, place, 1.0));
            assert!(ends.enumerate().all(|(place, end)| end > place && end <= times.len()), "{start} {step}");
        }
    }
    assert_eq!(end_of_part(&[0.0, 0.4, 0.8, 1.2, 1.6], 0, 1.0), 3);
}

#[test]
fn a_sine_below_the_nyquist_frequency_is_found_between_its_samples() {
    let sine = |time: f64| (2.0 * PI * 0.4 * time + 0.3).sin();
    let values: Vec<f64> = (0..400).map(|k| sine(f64::from(k))).collect();
    let finer = interpolate(&values, 4);
    assert_eq!(finer.len(), 399 * 4 + 1);
    for (k, value) in finer.iter().enumerate().skip(200).take(1200) {
        assert!((value - sine(k as f64 / 4.0)).abs() < 1e-3, "{k}");
    }
    for (k, value) in values.iter().enumerate() {
        assert_eq!(finer[4 * k], *value);
    }
}

#[test]
fn lines_through_a_finer_input_have_all_of_a_swing() {
    for (per_swing, most) in [(10.0, 1e-4), (25.0, 1e-4)] {
        let w = 2.0 * PI / per_swing;
        let values: Vec<f64> = (0..=400).map(|k| libm::sin(w * f64::from(k))).collect();
        let share = |fine: &[f64]| {
            let (mut product, mut square, parts) = (0.0, 0.0, 50);
            for k in 4 * 100..4 * 300 {
                for part in 0..parts {
                    let at = (f64::from(part) + 0.5) / f64::from(parts);
                    let sine = libm::sin(w * 0.25 * (k as f64 + at));
                    product += sine * (fine[k] + at * (fine[k + 1] - fine[k]));
                    square += sine * sine;
                }
            }
            product / square
        };
        let [held, linear] = [Hold::Zero, Hold::First].map(|hold| finer_input(&values, 4, hold));
        let lost = (w / 4.0) * (w / 4.0) / 12.0;
        assert!((share(&held) - 1.0 + lost).abs() < 0.1 * lost, "{per_swing}: {} {lost}", share(&held));
        assert!((share(&linear) - 1.0).abs() < most, "{per_swing}: {}", share(&linear));
        assert!(values.iter().enumerate().all(|(k, value)| linear[4 * k] == *value), "{per_swing}");
    }
}

#[test]
fn lines_go_through_up_to_the_ends() {
    let values: Vec<f64> = (0..50).map(|k| 2.0 * f64::from(k)).collect();
    for (k, value) in interpolate(&values, 8).iter().enumerate() {
        assert!((value - 2.0 * k as f64 / 8.0).abs() < 0.05, "{k}: {value}");
    }
    assert_eq!(interpolate(&[1.0, 1.0], 2), [1.0, 1.0, 1.0]);
    assert_eq!(interpolate(&[5.0], 4), [5.0]);
}

#[test]
fn fast_parts_do_not_fold_back() {
    let fast: Vec<f64> = (0..1000).map(|k| (2.0 * PI * 0.23 * f64::from(k)).sin()).collect();
    let mut fewer = fast;
    anti_alias(&mut fewer, 4);
    keep_every(&mut fewer, 4);
    assert_eq!(fewer.len(), 250);
    assert!(fewer[20..230].iter().all(|value| value.abs() < 0.02));
    let mut kept = vec![0.0, 1.0, 2.0, 3.0, 4.0];
    keep_every(&mut kept, 2);
    assert_eq!(kept, [0.0, 2.0, 4.0]);
}

#[test]
fn coefficients_are_those_of_scipy() {
    // scipy.signal.butter(4, 0.2, output="ba"), the cut-off at a tenth of the sample rate.
    let mut denominator = vec![1.0];
    for Section { a, .. } in sections(true, 0.1) {
        let factor = [1.0, a[0], a[1]];
        let mut product = vec![0.0; denominator.len() + 2];
        for (i, x) in denominator.iter().enumerate() {
            factor.iter().enumerate().for_each(|(j, y)| product[i + j] += x * y);
        }
        denominator = product;
    }
    let expected =
        [1.0, -2.369_513_007_182_037, 2.313_988_414_415_879_7, -1.054_665_405_878_567_4, 0.187_379_492_368_185];
    for (found, expected) in denominator.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }
    let gain: f64 = sections(true, 0.1).iter().map(|section| section.b[0]).product();
    assert!((gain - 0.004_824_343_357_716_2).abs() < 1e-15, "{gain}");
}

fn sine(cycles: f64, n: usize) -> Vec<f64> {
    (0..n).map(|k| (2.0 * PI * cycles * k as f64).sin()).collect()
}

#[test]
fn sines_pass_or_vanish_and_are_not_shifted() {
    let middle = 400..600;
    for (cycles, expected) in [(0.02, 0.0), (0.1, 1.0), (0.4, 0.0)] {
        let before = sine(cycles, 1000);
        let mut after = before.clone();
        band_pass(&mut after, 0.05, 0.2);
        let worst = middle.clone().map(|k| (after[k] - expected * before[k]).abs()).fold(0.0, f64::max);
        assert!(worst < 5e-3, "{cycles}: {worst}");
    }
    // At the cut-off, forward and backward leave a half.
    let before = sine(0.2, 1000);
    let mut after = before.clone();
    band_pass(&mut after, 0.0, 0.2);
    let worst = middle.map(|k| (after[k] - 0.5 * before[k]).abs()).fold(0.0, f64::max);
    assert!(worst < 1e-3, "{worst}");
}

#[test]
fn constants_and_lines_pass_a_low_pass_up_to_the_ends() {
    let mut line: Vec<f64> = (0..200).map(|k| 3.0 + 0.5 * f64::from(k)).collect();
    let before = line.clone();
    band_pass(&mut line, 0.0, 0.1);
    for (found, expected) in line.iter().zip(before) {
        assert!((found - expected).abs() < 0.05, "{found} {expected}");
    }
    let mut constant = vec![3.0; 50];
    band_pass(&mut constant, 0.05, 0.5);
    assert!(constant.iter().all(|value| value.abs() < 1e-9));
    let mut short = vec![1.0, 2.0];
    band_pass(&mut short, 0.0, 0.01);
    assert_eq!(short.len(), 2);
}
