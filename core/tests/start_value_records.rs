//! Start values on records of many excitations, sensors and dampings, and on free decays, made here and not by the core: the guess,
//! and the end of the filter that begins with it.

use kalmanscope_core::suggest::{scenario_for, suggest};
use kalmanscope_core::{FilterKind, FilterSettings, Propagation, Quantity, Record};

use crate::run::with_input;
use crate::short_records::right_of_short;
use crate::start_values::{
    Excitation, Oscillator, RingDown, SENSORS, grid, outcome, record, right, shares, suggestion, worst_of_losses,
};

#[test]
fn the_guess_is_right_under_every_excitation() {
    let [right, ends] = shares(grid(0..1, &[(9.0, 200.0)], true).0);
    assert!(right >= 95.0 && ends >= 95.0, "{right:.1} % of the guesses and {ends:.1} % of the ends are right");
}

#[test]
fn start_values_depend_on_no_lucky_number_of_rows_or_unit_of_the_input() {
    let [right, all] = right_of_short([211, 500, 1303].into_iter(), &[20.0, 200.0], &[1e-6, 1e-3, 1.0, 1e3, 1e6]);
    assert_eq!(right, all);
}

#[test]
#[ignore = "1200 records"]
fn start_values_of_a_grid_of_short_records() {
    let lengths = (0..60).map(|i| (200.0 * 10.0_f64.powf(f64::from(i) / 59.0)) as usize + i as usize % 7);
    let [right, all] = right_of_short(lengths, &[20.0, 50.0, 100.0, 200.0], &[1e-6, 1e-3, 1.0, 1e3, 1e6]);
    println!("{right} of {all}");
    assert!(right * 100 >= all * 99, "{right} of {all}");
}

#[test]
fn rounding_stops_no_filter_of_a_motion_that_has_died_out() {
    for (hertz, rate, seed) in [(2.3, 50.0, 403), (35.0, 750.0, 401)] {
        let truth = Oscillator { natural_frequency: std::f64::consts::TAU * hertz, damping_ratio: 0.02 };
        let record = record(truth, Excitation::Step, Quantity::DISPLACEMENT, 1.0 / rate, 8192, seed);
        let (is_right, ends, text) = outcome(&record, truth);
        assert!(is_right && ends, "{hertz} Hz: {text}");
    }
}

#[test]
fn lost_readings_change_no_start_value() {
    for (sensor, seed) in SENSORS.into_iter().zip([7, 8, 9]) {
        let (off, text) = worst_of_losses(sensor, Excitation::White, 0.02, seed);
        assert!(off < 0.05, "{text}");
    }
    for (excitation, seed) in [(Excitation::Multisine, 10), (Excitation::Hammer, 11)] {
        let (off, text) = worst_of_losses(Quantity::ACCELERATION, excitation, 0.02, seed);
        assert!(off < 0.05, "{text}");
    }
}

#[test]
fn a_guess_that_is_not_found_is_said() {
    let truth = Oscillator { natural_frequency: 19.5, damping_ratio: 0.02 };
    let whole = record(truth, Excitation::White, Quantity::DISPLACEMENT, 0.01, 8000, 7);
    let half = suggestion(&with_input(&whole, vec![0.0; 8000]).with_gaps(|_, k| k % 13 < 9));
    let problem = half.problem.as_ref().expect("there is no guess");
    assert!(
        suggestion(&whole.clone().with_gaps(|_, k| k % 13 < 9)).problem.is_none(),
        "the input explains what is left"
    );
    let said = |text: &str| half.reasons.iter().any(|reason| reason.contains(text));
    assert!(problem.starts_with("no start values of ωₙ and ζ could be found, because too many readings"), "{problem}");
    assert!(!said("R as large"), "{:?}", half.reasons);
    assert!(suggestion(&whole).problem.is_none());
}

#[test]
fn a_prediction_whose_mean_or_jacobian_is_not_exact_is_divided_where_samples_are_few() {
    let truth = Oscillator { natural_frequency: 60.0, damping_ratio: 0.02 };
    let record = record(truth, Excitation::White, Quantity::DISPLACEMENT, 0.01, 2000, 7);
    let mut scenario = scenario_for(&record);
    let ekf = FilterSettings { kind: FilterKind::EKF, ..scenario.filters[0].clone() };
    let of = |kind, propagation| FilterSettings { kind, propagation, id: 0, ..ekf.clone() };
    scenario.filters = vec![ekf.clone(), of(FilterKind::EKF, Some(Propagation::RungeKutta)), of(FilterKind::UKF, None)];
    scenario.number_filters();
    let substeps: Vec<usize> = suggest(&scenario, &record).scenario.filters.iter().map(|f| f.substeps).collect();
    assert!(matches!(substeps[..], [ekf, rk, ukf] if ekf > 1 && rk > 1 && ukf > 1), "{substeps:?}");
}

fn changed(record: &Record, input: impl Fn(f64) -> f64, reading: impl Fn(f64) -> f64) -> Record {
    let values = record.input().iter().map(|value| input(*value)).collect();
    with_input(record, values).with_measured(|_, _, value| reading(value))
}

#[test]
fn offsets_of_arrays_are_no_motion() {
    let truth = Oscillator { natural_frequency: 6.0, damping_ratio: 0.05 };
    for (sensor, seed) in SENSORS.into_iter().zip(3..) {
        let whole = record(truth, Excitation::White, sensor, 0.02, 6000, seed);
        for gain in [1.0, 0.4] {
            let offset = changed(&whole, |f| (f + 3.0) / gain, |y| y + 0.5);
            let (is_right, ends, text) = outcome(&offset, truth);
            assert!(is_right && ends, "{} gain {gain}: {text}", sensor.key());
        }
    }
}

#[test]
fn start_values_of_a_decay_are_right() {
    let share = right(0..40);
    assert!(share >= 0.95, "{share}");
}

#[test]
fn a_decay_that_ends_in_noise_has_good_start_values() {
    let decay = RingDown {
        natural_frequency: 6.0,
        damping_ratio: 0.05,
        rate: 50.0,
        periods: 80.0,
        sensor: Quantity::DISPLACEMENT,
        noise: 0.02,
        seed: 3,
    };
    let (is_right, text) = decay.outcome();
    assert!(is_right, "{text}");
}
