//! Start values on records that the core has no part in: of many excitations, of free decays, and without an input.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use kalmanscope_core::import::read;
use kalmanscope_core::suggest::{scenario_for, suggest};
use kalmanscope_core::{FilterKind, FilterSettings, Hold, Propagation, Quantity};
use kalmanscope_diagnosis::VerdictKind;

use crate::ambient::{Accelerometer, Ambient, End, building, end, end_on, mass};
use crate::numbers::Random;
use crate::run::{imported, with_input};
use crate::start_values::{
    Excitation, Oscillator, RingDown, SENSORS, outcome, outcome_of_short, record, suggestion, worst_of_losses,
};

#[test]
fn the_guess_is_right_under_every_excitation() {
    let [mut right, mut ends, mut all] = [0; 3];
    for (excitation, sensor) in Excitation::ALL.into_iter().flat_map(|one| SENSORS.map(|sensor| (one, sensor))) {
        for damping_ratio in [0.005, 0.02, 0.1] {
            let truth = Oscillator { natural_frequency: TAU * 9.0, damping_ratio };
            let (is_right, is_end, text) = outcome(&record(truth, excitation, sensor, 1.0 / 200.0, 8192, 0), truth);
            if !(is_right && is_end) {
                println!("{excitation:?} {} ζ {damping_ratio}: {text}", sensor.key());
            }
            (right, ends, all) = (right + u32::from(is_right), ends + u32::from(is_end), all + 1);
        }
    }
    assert!(20 * right.min(ends) >= 19 * all, "{right} of the guesses and {ends} of the ends of {all} are right");
}

#[test]
fn start_values_depend_on_no_lucky_number_of_rows_or_unit_of_the_input() {
    let mut seed = 0;
    for (samples, rate) in [211, 500, 1303].into_iter().flat_map(|samples| [(samples, 20.0), (samples, 200.0)]) {
        for gain in [1e-6, 1e-3, 1.0, 1e3, 1e6] {
            let (is_right, text) = outcome_of_short(samples, rate, gain, seed);
            assert!(is_right, "{text}");
            seed += 1;
        }
    }
}

#[test]
fn rounding_stops_no_filter_of_a_motion_that_has_died_out() {
    for (hertz, rate, seed) in [(2.3, 50.0, 403), (35.0, 750.0, 401)] {
        let truth = Oscillator { natural_frequency: TAU * hertz, damping_ratio: 0.02 };
        let record = record(truth, Excitation::Step, Quantity::DISPLACEMENT, 1.0 / rate, 8192, seed);
        let (is_right, ends, text) = outcome(&record, truth);
        assert!(is_right && ends, "{hertz} Hz: {text}");
    }
}

#[test]
fn lost_readings_change_no_start_value() {
    let white = SENSORS.into_iter().zip([7, 8, 9]).map(|(sensor, seed)| (sensor, Excitation::White, seed));
    let others = [(Excitation::Multisine, 10), (Excitation::Hammer, 11)];
    for (sensor, excitation, seed) in white.chain(others.map(|(kind, seed)| (Quantity::ACCELERATION, kind, seed))) {
        let (off, text) = worst_of_losses(sensor, excitation, seed);
        assert!(off < 0.05, "{text}");
    }
}

#[test]
fn a_guess_that_is_not_found_is_said() {
    let truth = Oscillator { natural_frequency: 19.5, damping_ratio: 0.02 };
    let whole = record(truth, Excitation::White, Quantity::DISPLACEMENT, 0.01, 8000, 7);
    let half = suggestion(&with_input(&whole, vec![0.0; 8000]).with_gaps(|_, k| k % 13 < 9));
    let problem = half.problem.as_ref().expect("there is no guess");
    let explained = suggestion(&whole.clone().with_gaps(|_, k| k % 13 < 9));
    assert!(explained.problem.is_none(), "the input explains what is left");
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

#[test]
fn offsets_of_arrays_are_no_motion() {
    let truth = Oscillator { natural_frequency: 6.0, damping_ratio: 0.05 };
    for (sensor, seed) in SENSORS.into_iter().zip(3..) {
        let whole = record(truth, Excitation::White, sensor, 0.02, 6000, seed);
        for gain in [1.0, 0.4] {
            let input = whole.input().iter().map(|f| (f + 3.0) / gain).collect();
            let offset = with_input(&whole, input).with_measured(|_, _, y| y + 0.5);
            let (is_right, ends, text) = outcome(&offset, truth);
            assert!(is_right && ends, "{} gain {gain}: {text}", sensor.key());
        }
    }
}

#[test]
fn start_values_of_a_decay_are_right() {
    let wrong: Vec<String> =
        (0..40).map(|seed| RingDown::of(seed).outcome()).filter(|of| !of.0).map(|of| of.1).collect();
    assert!(wrong.len() <= 2, "{wrong:#?}");
}

#[test]
fn a_decay_that_ends_in_noise_has_good_start_values() {
    let (natural_frequency, damping_ratio, sensor) = (6.0, 0.05, Quantity::DISPLACEMENT);
    let decay = RingDown { natural_frequency, damping_ratio, rate: 50.0, periods: 80.0, sensor, noise: 0.02, seed: 3 };
    let (is_right, text) = decay.outcome();
    assert!(is_right, "{text}");
}

/// Within half a per cent of ωₙ or three standard deviations, and within a fifth of ζ; `most` limits the error of ζ in standard deviations.
fn assert_right(end: &End, most: f64, name: &str) {
    let End { errors, sigmas, verdict, is_white, text, .. } = end;
    assert!(*is_white, "{name}: {text}");
    let std = errors[0] / sigmas[0];
    assert!(errors[0].abs() < (3.0 * std).max(0.005) && errors[1].abs() < 0.2, "{name}: {text}");
    assert!(sigmas[1].abs() < most, "{name}: {text}");
    assert_eq!(*verdict, VerdictKind::Consistent, "{name}: {text}");
}

/// σ of ζ is about a fifth too small where an accelerometer stands alone.
const ALONE: f64 = 4.0;

#[test]
fn a_building_in_the_wind_is_identified_by_any_sensor() {
    use Accelerometer::{BandLimited, Held, Mean};
    for (rate, sensor, kind, seed, filter) in [
        (20.0, Quantity::DISPLACEMENT, Mean, 50, "EKF"),
        (20.0, Quantity::VELOCITY, Mean, 51, "EKF"),
        (20.0, Quantity::ACCELERATION, Mean, 51, "EKF"),
        (20.0, Quantity::ACCELERATION, BandLimited, 50, "EKF"),
        (20.0, Quantity::ACCELERATION, Held, 50, "EKF"),
        (20.0, Quantity::ACCELERATION, Mean, 50, "UKF"),
        (50.0, Quantity::DISPLACEMENT, Mean, 51, "EKF"),
        (50.0, Quantity::VELOCITY, Mean, 51, "EKF"),
        (50.0, Quantity::ACCELERATION, BandLimited, 51, "EKF"),
    ] {
        let end = end(&building(rate, &[sensor], kind, seed), usize::from(filter == "UKF"));
        let most = if sensor == Quantity::ACCELERATION { ALONE } else { 3.0 };
        assert_right(&end, most, &format!("{rate} Hz {} {kind:?} {filter}", sensor.key()));
        assert!(end.guess[0].abs() < 0.01 && end.guess[1].abs() < 0.3, "{}", end.text);
    }
}

#[test]
fn an_accelerometer_beside_a_displacement_leaves_it_right() {
    use Accelerometer::{BandLimited, Filtered, Mean};
    let both = [Quantity::DISPLACEMENT, Quantity::ACCELERATION];
    for (rate, kind, seed) in
        [(20.0, Mean, 60), (20.0, BandLimited, 61), (20.0, Filtered, 62), (50.0, BandLimited, 63), (50.0, Filtered, 64)]
    {
        let end = end(&building(rate, &both, kind, seed), 0);
        assert_right(&end, 3.0, &format!("{rate} Hz {kind:?}"));
        assert!(end.reasons.contains("the filters ignore the acceleration"), "{}", end.reasons);
    }
}

/// Rows of a fast record, from 4 to 12 apart: the white force counts in samples, and the other filters read at the times of the rows.
#[test]
fn readings_at_irregular_times_take_a_white_force_too() {
    let mut good = 0;
    for seed in 70..78 {
        let sensor = [Quantity::DISPLACEMENT, Quantity::VELOCITY][seed as usize % 2];
        let fast = Ambient { seconds: 300.0, noise: 0.05, ..building(200.0, &[sensor], Accelerometer::Mean, seed) };
        let (record, mut random) = (fast.record(), Random::new(seed));
        let (mut text, mut k) = (format!("t [s],{}\n", sensor.key()), 0);
        while k < record.len() {
            writeln!(text, "{},{}", record.time(k), record.measured(0)[k]).unwrap();
            k += 4 + (9.0 * random.uniform()) as usize;
        }
        let record = imported(&read(text, None).unwrap(), Hold::First).0.record;
        assert!(record.clocks().is_some());
        let end = end_on(&record, [fast.natural_frequency, fast.damping_ratio], 0);
        println!("seed {seed}: {}", end.text);
        assert!(end.is_white && end.sigmas.iter().all(|sigma| sigma.abs() < 3.5), "seed {seed}: {}", end.text);
        assert!(end.reasons.contains("take each reading at a sample"), "{}", end.reasons);
        good += usize::from(end.verdict != VerdictKind::Overconfident);
    }
    assert!(good >= 6, "{good} of 8 are not overconfident");
}

#[test]
fn a_loggers_low_pass_is_said_and_leaves_frequency_and_damping_right() {
    for (rate, seed) in [(20.0, 60), (20.0, 61), (50.0, 60)] {
        let End { errors, is_white, text, reasons, .. } =
            end(&building(rate, &[Quantity::ACCELERATION], Accelerometer::Filtered, seed), 0);
        assert!(is_white && errors[0].abs() < 0.005 && errors[1].abs() < 0.2, "{rate} Hz: {text}");
        assert!(reasons.contains("as behind a logger's low-pass filter"), "{rate} Hz: {reasons}");
    }
}

#[test]
fn three_minutes_of_an_accelerometer_on_a_mass_are_within_three_sigma() {
    use Accelerometer::{BandLimited, Mean};
    for (kind, rate, seed) in [(Mean, 50.0, 50), (Mean, 100.0, 50), (BandLimited, 100.0, 51)] {
        let End { sigmas, verdict, is_white, text, .. } = end(&mass(kind, rate, seed), 0);
        assert!(is_white && sigmas.iter().all(|sigma| sigma.abs() < 3.0), "{kind:?} {rate} Hz: {text}");
        assert_eq!(verdict, VerdictKind::Consistent, "{kind:?} {rate} Hz: {text}");
    }
}
