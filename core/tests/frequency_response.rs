//! Frequency responses: against textbook formulas, impedances of chains, and truths that are drawn from a belief.

use kalmanscope_core::frequency_response::{Believed, believed, transfer_function, true_transfer_function};
use kalmanscope_core::{Channel, Estimates, FilterKind, FilterSettings, PlantKind, Scenario, Signal, Values};
use kalmanscope_filters::random::{Normal, Purpose};
use nalgebra::{Complex, DMatrix};

use crate::run::finished;

fn spaced(from: f64, to: f64, count: usize) -> Vec<f64> {
    (0..count).map(|i| from * libm::pow(to / from, i as f64 / (count - 1) as f64)).collect()
}

fn sdof(wn: f64, zeta: f64) -> impl Fn(Channel) -> f64 {
    move |channel| match channel {
        c if c == Channel::NATURAL_FREQUENCY => wn,
        c if c == Channel::DAMPING_RATIO => zeta,
        _ => 0.0,
    }
}

#[test]
fn one_mass_answers_as_the_textbook_says() {
    let frequencies = spaced(0.05, 500.0, 301);
    for (wn, zeta) in [(6.0, 0.05), (0.3, 0.7), (40.0, 1e-3), (5.0, 2.0), (5.0, -0.1), (7.0, 0.0)] {
        let found = transfer_function(&PlantKind::SDOF, sdof(wn, zeta)).magnitude(&frequencies);
        for (&w, found) in frequencies.iter().zip(found) {
            let stiff = wn * wn - w * w;
            let damped = 2.0 * zeta * wn * w;
            let expected = 1.0 / (stiff * stiff + damped * damped).sqrt();
            assert!((found / expected - 1.0).abs() < 1e-12, "{found} instead of {expected} at {w} of {wn}, {zeta}");
        }
    }
}

#[test]
fn a_hum_beside_the_force_changes_nothing_not_even_at_its_own_frequency() {
    let hum = "[plant]\nequation = \"x'' + 2 ζ ωₙ x' + ωₙ² x = f + u; u' = s; s' = -w² u\"\nparameters = { w = {} }";
    let kind = Scenario::from_toml(hum).unwrap().plant.kind;
    for (w, zeta) in [(10.0, 0.05), (7.3, 0.013), (9.1, 0.3), (0.37, 0.07), (11.3, 0.0), (123.4, 0.021)] {
        let frequencies = [0.9 * w, w, 1.1 * w];
        let value = |channel: Channel| if channel.key() == "w" { w } else { sdof(6.0, zeta)(channel) };
        let found = transfer_function(&kind, value).magnitude(&frequencies);
        let expected = transfer_function(&PlantKind::SDOF, sdof(6.0, zeta)).magnitude(&frequencies);
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 1e-4, "{found} instead of {expected} at a hum of {w}");
        }
    }
}

#[test]
fn nonlinear_plants_at_rest_respond_like_linear_ones() {
    let frequencies = spaced(0.5, 50.0, 101);
    let expected = transfer_function(&PlantKind::SDOF, sdof(6.0, 0.05)).magnitude(&frequencies);
    for kind in [PlantKind::DUFFING, PlantKind::BOUC_WEN] {
        for others in [0.0, 0.3, 250.0] {
            let value = |channel| match sdof(6.0, 0.05)(channel) {
                0.0 => others,
                known => known,
            };
            let found = transfer_function(&kind, value);
            for (found, expected) in found.magnitude(&frequencies).into_iter().zip(&expected) {
                // The elastic and the hysteretic share of Bouc-Wen's stiffness cancel up to rounding.
                assert!((found / expected - 1.0).abs() < 1e-11, "{found} instead of {expected}");
            }
            let (least, greatest) = found.natural_span().unwrap();
            assert!((least - 6.0).abs() < 1e-9 && (greatest - 6.0).abs() < 1e-9, "{least}, {greatest}");
        }
    }
}

/// Storey by storey from the top: the storeys above act as a force and a stiffness.
fn chain_by_impedance(stiffness: &[f64], damping: f64, w: f64) -> f64 {
    let (mut force, mut dynamic) = (Complex::new(0.0, 0.0), Complex::new(0.0, 0.0));
    for &kappa in stiffness.iter().rev() {
        // (s + d - ω²) x - s x₋ = 1 + F; the storey below carries s (x₋ - x) = D x₋ - G.
        let storey = Complex::new(kappa, w * damping);
        let total = storey + dynamic - w * w;
        force = storey / total * (force + 1.0);
        dynamic = storey - storey * storey / total;
    }
    // At the ground s₁ x₁ carries the whole force, so x₁ is that force over s₁.
    (force / Complex::new(stiffness[0], w * damping)).norm_sqr().sqrt()
}

#[test]
fn chains_answer_as_their_impedances_say() {
    let frequencies = spaced(0.5, 120.0, 301);
    let kappas = [200.0, 180.0, 160.0, 140.0, 150.0, 130.0, 170.0, 120.0, 110.0, 100.0];
    for kind in PlantKind::ALL.into_iter().filter(|kind| kind.masses() > 1) {
        let masses = kind.masses();
        for damping in [0.4, 0.01, 5.0] {
            let value = |channel: Channel| match (0..masses).find(|&mass| channel == Channel::stiffness(mass)) {
                Some(mass) => kappas[mass % 10],
                None => damping,
            };
            let found = transfer_function(&kind, value).magnitude(&frequencies);
            for (&w, found) in frequencies.iter().zip(found) {
                let expected =
                    chain_by_impedance(&(0..masses).map(|mass| kappas[mass % 10]).collect::<Vec<f64>>(), damping, w);
                let limit = if (5..=10).contains(&masses) { 1e-6 } else { 1e-9 };
                assert!((found / expected - 1.0).abs() < limit, "{found} instead of {expected} at {w}, {}", kind.key());
            }
        }
    }
}

#[test]
fn the_span_holds_every_natural_frequency() {
    // Equal storeys: ωᵢ = 2√κ sin((2i - 1)π / (4n + 2)).
    let value = |channel| if channel == Channel::STOREY_DAMPING { 0.3 } else { 150.0 };
    for (kind, masses) in [(PlantKind::SHEAR_2, 2.0), (PlantKind::SHEAR_3, 3.0), (PlantKind::SHEAR_4, 4.0)] {
        let natural =
            |i: f64| 2.0 * 150.0_f64.sqrt() * libm::sin((2.0 * i - 1.0) * std::f64::consts::PI / (4.0 * masses + 2.0));
        let (least, greatest) = transfer_function(&kind, value).natural_span().unwrap();
        assert!((0.9 * natural(1.0)..natural(1.0)).contains(&least), "{least} of {}", natural(1.0));
        assert!((natural(masses)..1.5 * natural(masses)).contains(&greatest), "{greatest} of {}", natural(masses));
    }
    assert_eq!(transfer_function(&PlantKind::SDOF, sdof(0.0, 0.1)).natural_span(), None);
    assert_eq!(transfer_function(&PlantKind::SHEAR_4, |_| 0.0).natural_span(), None);
}

#[test]
fn no_stiffness_and_no_damping_leave_numbers() {
    let frequencies = spaced(0.5, 50.0, 101);
    for kind in PlantKind::ALL {
        for free in
            [transfer_function(&kind, |_| 0.0), transfer_function(&kind, |c| f64::from(u8::from(c.is_positive())))]
        {
            assert!(free.magnitude(&frequencies).iter().all(|h| *h > 0.0), "{}", kind.key());
        }
        let mass = transfer_function(&kind, |_| 0.0).magnitude(&frequencies);
        assert!(mass.iter().zip(&frequencies).all(|(h, w)| (h * w * w - 1.0).abs() < 1e-12), "{}", kind.key());
    }
    assert_eq!(transfer_function(&PlantKind::SDOF, sdof(6.0, 0.0)).magnitude(&[6.0]), [f64::INFINITY]);
}

fn estimates(scenario: &Scenario) -> Estimates {
    finished(scenario).estimates()[0].clone()
}

fn scenario(kind: PlantKind) -> Scenario {
    let mut scenario = Scenario { duration: 5.0, ..Scenario::default() };
    scenario.set_plant(kind);
    let sensor_std = scenario.true_sensor_std();
    scenario.filters = vec![FilterSettings { kind: FilterKind::UKF, sensor_std, ..FilterSettings::default() }];
    scenario
}

#[test]
fn a_belief_has_the_response_of_its_mean_in_its_band() {
    let frequencies = spaced(1.0, 50.0, 60);
    for kind in PlantKind::ALL {
        let estimates = estimates(&scenario(kind.clone()));
        assert_eq!(estimates.plant, kind);
        for k in [0, 30, 500] {
            let Believed { mean, band } = believed(&estimates, k, &frequencies);
            let of_mean = |c| estimates.mean(k)[estimates.place(c).unwrap()];
            assert_eq!(mean, transfer_function(&kind, of_mean).magnitude(&frequencies));
            let (low, high) = band.unwrap();
            assert!((0..60).all(|i| 0.0 < low[i] && low[i] < high[i]), "{}", kind.key());
            // Where the peak's frequency is uncertain, the mean's peak is higher than most of the draws there.
            let inside = (0..60).filter(|&i| low[i] <= mean[i] && mean[i] <= high[i]).count();
            assert!(inside >= 54, "{inside} of 60, {} at {k}", kind.key());
        }
    }
}

#[test]
fn known_parameters_have_a_band_of_zero_width() {
    let mut scenario = scenario(PlantKind::SDOF);
    scenario.filters[0].initial_std = Values::ZERO;
    scenario.filters[0].process_std = Values::ZERO;
    let estimates = estimates(&scenario);
    let Believed { mean, band } = believed(&estimates, 200, &spaced(1.0, 50.0, 30));
    assert_eq!(band, Some((mean.clone(), mean)));
}

#[test]
fn nineteen_of_twenty_truths_are_in_the_band() {
    let frequencies = spaced(1.0, 60.0, 40);
    let (sdof, two, four) = (PlantKind::SDOF, PlantKind::SHEAR_2, PlantKind::SHEAR_4);
    for (kind, k) in [(sdof.clone(), 0), (sdof, 500), (two, 500), (four.clone(), 0), (four, 500)] {
        let estimates = estimates(&scenario(kind.clone()));
        let n = kind.channels().len();
        let (low, high) = believed(&estimates, k, &frequencies).band.unwrap();
        let mut normal = Normal::new(11, Purpose::Force);
        let root = DMatrix::from_column_slice(n, n, estimates.cov(k)).cholesky().unwrap().l();
        let mut inside = vec![0_u32; frequencies.len()];
        for _ in 0..2000 {
            let draws: Vec<f64> = (0..n).map(|_| normal.sample()).collect();
            let value = |channel| {
                let i = estimates.place(channel).unwrap();
                estimates.mean(k)[i] + (0..n).map(|j| root[(i, j)] * draws[j]).sum::<f64>()
            };
            let truth = transfer_function(&kind, value).magnitude(&frequencies);
            for i in 0..frequencies.len() {
                inside[i] += u32::from(low[i] <= truth[i] && truth[i] <= high[i]);
            }
        }
        let share = inside.iter().map(|&count| f64::from(count) / 2000.0);
        let (least, most) = share.clone().fold((1.0, 0.0), |(l, m): (f64, f64), s| (l.min(s), m.max(s)));
        let mean = share.sum::<f64>() / frequencies.len() as f64;
        assert!((mean - 0.95).abs() < 0.01, "{mean}, {}", kind.key());
        assert!(least > 0.92 && most < 0.98, "{least} to {most}, {}", kind.key());
    }
}

#[test]
fn the_mirror_image_of_a_belief_has_the_same_band() {
    let mut scenario = scenario(PlantKind::SDOF);
    scenario.plant.set(Channel::NATURAL_FREQUENCY, Signal::Constant(6.0));
    let straight = estimates(&scenario);
    for channel in [Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO] {
        scenario.filters[0].initial_mean[channel] *= -1.0;
    }
    let mirrored = estimates(&scenario);
    let frequencies = spaced(1.0, 50.0, 30);
    for k in [0, 100, 500] {
        let (straight, mirrored) = (believed(&straight, k, &frequencies), believed(&mirrored, k, &frequencies));
        let close = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a / b - 1.0).abs() < 1e-6);
        assert!(close(&straight.mean, &mirrored.mean));
        let ((a, b), (c, d)) = (straight.band.unwrap(), mirrored.band.unwrap());
        assert!(close(&a, &c) && close(&b, &d));
    }
}

#[test]
fn the_truth_is_that_of_its_sample() {
    let scenario = Scenario { duration: 40.0, filters: vec![], ..Scenario::default() };
    let run = finished(&scenario);
    let found = |k| true_transfer_function(&PlantKind::SDOF, run.record(), k);
    assert_eq!(found(0), Some(transfer_function(&PlantKind::SDOF, sdof(6.0, 0.05))));
    assert_eq!(found(3500), Some(transfer_function(&PlantKind::SDOF, sdof(4.8, 0.05))));
    assert_eq!(found(9999), None);
    assert_eq!(true_transfer_function(&PlantKind::SHEAR_2, run.record(), 0), None);
}
