//! Start values of records without an input, made here and not by the core: the guess, and the end of the filter that begins
//! with it.
#![expect(clippy::unwrap_used, reason = "a helper that fails is a test that fails")]

#[path = "common/ambient.rs"]
mod ambient;
#[path = "common/random.rs"]
mod random;

use ambient::{Accelerometer, Ambient};
use kalmanscope_core::record::Input;
use kalmanscope_core::suggest::{scenario_for, suggest};
use kalmanscope_core::{Channel, Diagnosis, Diagnostics, Hold, InputKind, Quantity, Record, Run, VerdictKind};

/// The end of a filter on a record.
struct End {
    /// Relative errors of ωₙ and ζ, and the same in standard deviations.
    errors: [f64; 2],
    sigmas: [f64; 2],
    /// Relative errors of the first guess.
    guess: [f64; 2],
    /// Whether a white force was taken for the cause of the motion.
    is_white: bool,
    verdict: VerdictKind,
    text: String,
    /// The reasons of the start values.
    reasons: String,
}

/// The end of one of the suggested filters.
fn end(ambient: &Ambient, place: usize) -> End {
    let record = ambient.record();
    let suggestion = suggest(&scenario_for(&record), &record);
    let filter = &suggestion.scenario.filters[place];
    let force = filter.augment.contains(&Channel::WHITE_FORCE).then(|| filter.process_std[Channel::WHITE_FORCE]);
    let truth = [ambient.natural_frequency, ambient.damping_ratio];
    let channels = [Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO];
    let guess = [0, 1].map(|i| filter.initial_mean[channels[i]] / truth[i] - 1.0);
    let mut run = Run::on_record(&suggestion.scenario, record.clone().into()).unwrap();
    run.finish();
    let estimates = &run.estimates()[place];
    let last = estimates.len() - 1;
    let places = channels.map(|channel| estimates.place(channel).unwrap());
    let errors = [0, 1].map(|i| estimates.mean(last)[places[i]] / truth[i] - 1.0);
    let stds = [0, 1].map(|i| estimates.std(last, places[i]) / truth[i]);
    let diagnosis = Diagnosis::new(&Diagnostics::new(estimates, &record), estimates, &record, None).unwrap();
    let verdict = diagnosis.verdict.unwrap().kind;
    let text = format!(
        "guess {:+.2} % {:+.0} %, end {:+.2} % {:+.0} % (σ {:.2} % {:.0} %), {:?}, force {force:?}, R {:?}, {}",
        100.0 * guess[0],
        100.0 * guess[1],
        100.0 * errors[0],
        100.0 * errors[1],
        100.0 * stds[0],
        100.0 * stds[1],
        suggestion.scenario.hold,
        filter.sensor_std,
        verdict.name(),
    );
    let is_white = force.is_some();
    let (sigmas, reasons) = ([0, 1].map(|i| errors[i] / stds[i]), suggestion.reasons.join("\n"));
    End { errors, sigmas, guess, verdict, is_white, text, reasons }
}

/// Twenty minutes at 20 Hz, or ten at 50 Hz.
fn building(rate: f64, sensors: &[Quantity], accelerometer: Accelerometer, seed: u64) -> Ambient {
    Ambient {
        natural_frequency: std::f64::consts::TAU * 1.2,
        damping_ratio: 0.04,
        rate,
        seconds: if rate < 30.0 { 1200.0 } else { 600.0 },
        sensors: sensors.to_vec(),
        accelerometer,
        noise: 0.01,
        seed,
    }
}

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
    let mut random = random::Random::new(4);
    let at = |k: usize| (-zeta * wn * k as f64 * dt).exp() * (wn * k as f64 * dt).cos();
    let measured = (0..4000).map(|k| at(k) + 0.003 * random.normal()).collect();
    let input = Input { kind: InputKind::Force, hold: Hold::First, values: vec![0.0; 4000] };
    let record = Record::new(dt, input, vec![(Quantity::DISPLACEMENT, measured)]).unwrap();
    let suggestion = suggest(&scenario_for(&record), &record);
    let filter = &suggestion.scenario.filters[0];
    assert!(!filter.augment.contains(&Channel::WHITE_FORCE), "{:?}", suggestion.reasons);
    assert!((filter.initial_mean[Channel::NATURAL_FREQUENCY] / wn - 1.0).abs() < 0.02, "{:?}", suggestion.reasons);
}

const SETS: [&[Quantity]; 4] = [
    &[Quantity::DISPLACEMENT],
    &[Quantity::VELOCITY],
    &[Quantity::ACCELERATION],
    &[Quantity::DISPLACEMENT, Quantity::ACCELERATION],
];

/// `cargo test -p kalmanscope-core --test ambient -- --ignored --nocapture`
#[test]
#[ignore = "a measurement of minutes"]
fn ambient_records_of_many_kinds() {
    for rate in [20.0, 50.0] {
        for sensors in SETS {
            use Accelerometer::{BandLimited, Filtered, Held, Instant, Mean};
            let kinds = if sensors.contains(&Quantity::ACCELERATION) {
                &[Mean, BandLimited, Filtered, Instant, Held][..]
            } else {
                &[Mean]
            };
            for &kind in kinds {
                let ends: Vec<End> = (1300..1306).map(|seed| end(&building(rate, sensors, kind, seed), 0)).collect();
                let names: Vec<&str> = sensors.iter().map(|sensor| sensor.key()).collect();
                report(&format!("{rate} Hz {} {kind:?}", names.join("+")), &ends);
            }
        }
    }
}

/// An accelerometer beside a displacement: `cargo test -p kalmanscope-core --test ambient -- --ignored --nocapture`
#[test]
#[ignore = "a measurement of minutes"]
fn two_sensors_of_a_building() {
    for rate in [20.0, 50.0] {
        for kind in [Accelerometer::Mean, Accelerometer::BandLimited, Accelerometer::Filtered, Accelerometer::Instant] {
            let ends: Vec<End> = (1350..1354).map(|seed| end(&building(rate, SETS[3], kind, seed), 0)).collect();
            report(&format!("{rate} Hz displacement+acceleration {kind:?}"), &ends);
        }
    }
}

fn report(name: &str, ends: &[End]) {
    let n = ends.len() as f64;
    let rms = |of: &dyn Fn(&End) -> f64| (ends.iter().map(|end| of(end).powi(2)).sum::<f64>() / n).sqrt();
    let mean = |of: &dyn Fn(&End) -> f64| ends.iter().map(of).sum::<f64>() / n;
    let good = ends.iter().filter(|end| end.verdict == VerdictKind::Consistent).count();
    println!(
        "{name}: guess rms {:.2} % {:.0} %; end mean {:+.2} % {:+.1} %, rms {:.2} % {:.1} %, in σ {:.1} {:.1}, within 0.5 %/20 %: {}, \
         consistent {good} of {n}",
        100.0 * rms(&|end| end.guess[0]),
        100.0 * rms(&|end| end.guess[1]),
        100.0 * mean(&|end| end.errors[0]),
        100.0 * mean(&|end| end.errors[1]),
        100.0 * rms(&|end| end.errors[0]),
        100.0 * rms(&|end| end.errors[1]),
        rms(&|end| end.sigmas[0]),
        rms(&|end| end.sigmas[1]),
        ends.iter().filter(|end| end.errors[0].abs() < 0.005 && end.errors[1].abs() < 0.2).count(),
    );
    println!("    a low pass is said of {} of {n}", ends.iter().filter(|end| end.reasons.contains("low-pass")).count());
    ends.iter().take(2).for_each(|end| println!("    {}", end.text));
}

/// `cargo test -p kalmanscope-core --test ambient -- --ignored --nocapture`
#[test]
#[ignore = "a measurement of minutes"]
fn masses_of_three_hertz() {
    for kind in [Accelerometer::Mean, Accelerometer::BandLimited, Accelerometer::Filtered, Accelerometer::Instant] {
        for rate in [50.0, 100.0] {
            let ends: Vec<End> = (1300..1308).map(|seed| end(&mass(kind, rate, seed), 0)).collect();
            report(&format!("3.1 Hz, {rate} Hz, {kind:?}"), &ends);
        }
    }
}

/// Three minutes of an accelerometer on a light mass.
fn mass(accelerometer: Accelerometer, rate: f64, seed: u64) -> Ambient {
    Ambient {
        natural_frequency: 19.478,
        damping_ratio: 0.02,
        rate,
        seconds: 180.0,
        sensors: vec![Quantity::ACCELERATION],
        accelerometer,
        noise: 0.02,
        seed,
    }
}
