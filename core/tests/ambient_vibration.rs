//! Start values of records without an input, made here and not by the core: the guess, and the end of the filter that begins
//! with it.

use std::fmt::Write as _;

use kalmanscope_core::import::{Builder, Mapping, read};
use kalmanscope_core::record::Input;
use kalmanscope_core::suggest::{scenario_for, suggest};
use kalmanscope_core::{Channel, Hold, InputKind, Quantity, Record, VerdictKind};

use crate::ambient::{Accelerometer, Ambient, End, SETS, building, end, end_on, mass};
use crate::random::Random;

/// An end that is right: within half a per cent of ωₙ, or three standard deviations where the record tells no more, within a
/// fifth of ζ, and consistent. `most` limits the error of ζ in standard deviations.
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
    for (rate, sensor, kind, seed) in [
        (20.0, Quantity::DISPLACEMENT, Mean, 50),
        (20.0, Quantity::VELOCITY, Mean, 51),
        (20.0, Quantity::ACCELERATION, Mean, 51),
        (20.0, Quantity::ACCELERATION, BandLimited, 50),
        (20.0, Quantity::ACCELERATION, Held, 50),
        (50.0, Quantity::DISPLACEMENT, Mean, 51),
        (50.0, Quantity::VELOCITY, Mean, 51),
        (50.0, Quantity::ACCELERATION, BandLimited, 51),
    ] {
        let end = end(&building(rate, &[sensor], kind, seed), 0);
        let most = if sensor == Quantity::ACCELERATION { ALONE } else { 3.0 };
        assert_right(&end, most, &format!("{rate} Hz {} {kind:?}", sensor.key()));
        assert!(end.guess[0].abs() < 0.01 && end.guess[1].abs() < 0.3, "{}", end.text);
    }
}

#[test]
fn an_accelerometer_beside_a_displacement_leaves_it_right() {
    use Accelerometer::{BandLimited, Filtered, Mean};
    let both = SETS[3];
    for (rate, kind, seed) in
        [(20.0, Mean, 60), (20.0, BandLimited, 61), (20.0, Filtered, 62), (50.0, BandLimited, 63), (50.0, Filtered, 64)]
    {
        let end = end(&building(rate, both, kind, seed), 0);
        assert_right(&end, 3.0, &format!("{rate} Hz {kind:?}"));
        assert!(end.reasons.contains("the filters do without the acceleration"), "{}", end.reasons);
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
        let table = read(text, None).unwrap();
        let (mapping, kind) = Mapping::guess(&table);
        let record = Builder::new(&table, &mapping, kind, Hold::First).unwrap().finish().unwrap().record;
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
fn the_unscented_filter_agrees() {
    let end = end(&building(20.0, &[Quantity::ACCELERATION], Accelerometer::Mean, 50), 1);
    assert_right(&end, ALONE, "UKF");
}

#[test]
fn three_minutes_of_an_accelerometer_on_a_mass_are_within_three_sigma() {
    for (kind, rate, seed) in
        [(Accelerometer::Mean, 50.0, 50), (Accelerometer::Mean, 100.0, 50), (Accelerometer::BandLimited, 100.0, 51)]
    {
        let End { sigmas, verdict, is_white, text, .. } = end(&mass(kind, rate, seed), 0);
        assert!(is_white && sigmas.iter().all(|sigma| sigma.abs() < 3.0), "{kind:?} {rate} Hz: {text}");
        assert_eq!(verdict, VerdictKind::Consistent, "{kind:?} {rate} Hz: {text}");
    }
}

#[test]
fn a_decay_needs_no_force() {
    let (wn, zeta, dt) = (6.0_f64, 0.01_f64, 0.02);
    let mut random = crate::random::Random::new(4);
    let at = |k: usize| (-zeta * wn * k as f64 * dt).exp() * (wn * k as f64 * dt).cos();
    let measured = (0..4000).map(|k| at(k) + 0.003 * random.normal()).collect();
    let input = Input { kind: InputKind::Force, hold: Hold::First, values: vec![0.0; 4000] };
    let record = Record::new(dt, input, vec![(Quantity::DISPLACEMENT, measured)]).unwrap();
    let suggestion = suggest(&scenario_for(&record), &record);
    let filter = &suggestion.scenario.filters[0];
    assert!(!filter.augment.contains(&Channel::WHITE_FORCE), "{:?}", suggestion.reasons);
    assert!((filter.initial_mean[Channel::NATURAL_FREQUENCY] / wn - 1.0).abs() < 0.02, "{:?}", suggestion.reasons);
}
