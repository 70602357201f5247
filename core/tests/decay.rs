//! What the accelerometer of a phone tells of a free decay, from its raw readings to the parameters.

use kalmanscope_core::diagnostics::Depth;
use kalmanscope_core::free_decay::{Decay, NoDecay};
use kalmanscope_core::import::{Table, ThreeAxes, read};
use kalmanscope_core::{Analysis, Story, Summary, VerdictKind, Wanted};

use crate::phone::{Phone, USUAL};
use crate::random::Random;
use crate::run::identified;

fn as_table(decay: &Decay) -> Table {
    read(Decay::file(std::slice::from_ref(decay)).into_bytes(), None).expect("it is a table")
}

/// Situations and seeds were not looked at while the limits in `free_decay/decay.rs` were chosen.
#[test]
fn frequency_and_damping_are_found_from_a_phone_that_was_plucked() {
    let (mut inside, mut consistent, mut count) = ([0, 0], 0, 0);
    for seed in 1..=8 {
        for (frequency, damping, rate, jitter, noise, grain) in [
            (6.3, 0.004, 100.0, 0.5, 0.02, 0.001),
            (9.1, 0.02, 60.0, 0.5, 0.03, 0.04),
            (14.0, 0.008, 60.0, 0.2, 0.02, 0.01),
            (4.2, 0.012, 50.0, 0.3, 0.01, 0.02),
        ] {
            let phone = Phone { seed, frequency, damping, rate, jitter, noise, grain, seconds: 40.0, ..USUAL };
            let decay = Decay::of(&phone.readings()).expect("it swings");
            let ([(frequency_found, frequency_std), (damping_found, damping_std)], run) = identified(&as_table(&decay));
            let verdict = Summary::new(&run.estimates()[0], run.record()).verdict.map(|verdict| verdict.kind);
            let (found, spread) = ([frequency_found, damping_found], [frequency_std, damping_std]);
            let name = format!("seed {seed}, {frequency} rad/s, {damping}: {found:?} ± {spread:?}");
            assert!((found[0] / frequency - 1.0).abs() < 0.002, "{name}");
            assert!((found[1] / damping - 1.0).abs() < 0.15, "{name}");
            inside[0] += i32::from((found[0] - frequency).abs() < 2.0 * spread[0]);
            inside[1] += i32::from((found[1] - damping).abs() < 2.0 * spread[1]);
            consistent += i32::from(verdict == Some(VerdictKind::Consistent));
            count += 1;
        }
    }
    assert_eq!(count, 32);
    println!("inside ±2σ: {inside:?} of {count}, {consistent} consistent");
    assert!(consistent >= 30, "{consistent} of {count} are consistent");
    assert!(inside.iter().all(|inside| *inside >= 26), "inside their bands: {inside:?} of {count}");
}

#[test]
fn a_decay_ends_at_rest_or_before_a_second_pluck() {
    let long = Phone { damping: 0.05, seconds: 60.0, ..USUAL };
    let decay = Decay::of(&long.readings()).expect("it swings");
    assert!((2.0..4.0).contains(&decay.begin), "{}", decay.begin);
    let seconds = decay.times[decay.times.len() - 1];
    assert!(decay.rests && (6.0..25.0).contains(&seconds), "the rest is noise: {seconds} s");
    assert!((0.01..0.03).contains(&decay.noise), "{}", decay.noise);
    let along: f64 = decay.axis.iter().zip([1.2, 9.6, -0.7]).map(|(axis, gravity)| axis * gravity).sum();
    assert!((decay.gravity - along).abs() < 0.01, "{} for {along}", decay.gravity);
    let twice = Phone { again: Some(15.0), damping: 0.03, ..USUAL };
    let decay = Decay::of(&twice.readings()).expect("it swings");
    let end = decay.begin + decay.times[decay.times.len() - 1];
    assert!(!decay.rests, "it still swings: {end} s");
    assert!(decay.begin > 2.0 && end <= 15.0 || decay.begin > 15.0, "from {} s to {end} s", decay.begin);
}

#[test]
fn a_hand_that_stops_it_ends_the_decay() {
    for seed in 1..=5 {
        for (stop, seconds) in [(13.3, 16.0), (10.0, 30.0), (12.71, 13.9)] {
            let phone = Phone { damping: 0.006, seconds, seed, ..USUAL };
            let still = Phone { amplitude: 0.0, ..phone };
            let both = phone.readings().into_iter().zip(still.readings());
            let readings: Vec<_> = both.map(|(moves, rests)| if moves[0] < stop { moves } else { rests }).collect();
            let decay = Decay::of(&readings).expect("it swings");
            let end = decay.begin + decay.seconds();
            assert!((stop - 1.1..stop + 0.01).contains(&end), "seed {seed}: it ends at {end} s, not at {stop} s");
            let [(frequency, _), (damping, _)] = identified(&as_table(&decay)).0;
            assert!((frequency / phone.frequency - 1.0).abs() < 0.002, "seed {seed}: {frequency}");
            assert!((damping / phone.damping - 1.0).abs() < 0.15, "seed {seed}: {damping}");
        }
    }
}

#[test]
fn every_pluck_is_found_and_the_hand_that_takes_the_phone_spoils_none() {
    for seed in 1..=5 {
        let twice = Phone { again: Some(15.0), damping: 0.03, seed, ..USUAL };
        let decays = Decay::all(&twice.readings()).expect("it swings");
        assert_eq!(
            decays.len(),
            2,
            "seed {seed}: {:?}",
            decays
                .iter()
                .map(|decay| [
                    decay.begin,
                    decay.seconds(),
                    decay.noise,
                    decay.acceleration.iter().fold(0.0, |a: f64, b| a.max(b.abs()))
                ])
                .collect::<Vec<_>>()
        );
        assert!(decays[0].begin + decays[0].seconds() <= 15.0 && decays[1].begin > 15.0, "seed {seed}");
        for decay in &decays {
            let [(frequency, _), (damping, _)] = identified(&as_table(decay)).0;
            assert!((frequency / twice.frequency - 1.0).abs() < 0.005, "seed {seed}: {frequency}");
            assert!((damping / twice.damping - 1.0).abs() < 0.15, "seed {seed}: {damping}");
        }
    }
    // It is taken from where it hung, turned and shaken, to stop the measurement.
    for seed in 1..=5 {
        let phone = Phone { damping: 0.01, seconds: 20.0, seed, ..USUAL };
        let mut readings = phone.readings();
        let mut random = Random::new(100 + seed);
        for k in 0..150 {
            let t = 20.0 + f64::from(k) / 60.0;
            let turn = (0.02 * f64::from(k)).min(1.2);
            let mut shaken = || 4.0 * (-1.5 * (t - 20.0)).exp() * random.normal();
            readings.push([t, 9.6 * turn.sin() + shaken(), 9.6 * turn.cos() + shaken(), -0.7 + shaken()]);
        }
        let decay = Decay::of(&readings).unwrap_or_else(|error| panic!("seed {seed}: {error}"));
        let end = decay.begin + decay.seconds();
        assert!(decay.begin < 3.5 && (17.0..20.1).contains(&end), "seed {seed}: from {} to {end} s", decay.begin);
        let [(frequency, _), (damping, _)] = identified(&as_table(&decay)).0;
        assert!((frequency / phone.frequency - 1.0).abs() < 0.002, "seed {seed}: {frequency}");
        assert!((damping / phone.damping - 1.0).abs() < 0.15, "seed {seed}: {damping}");
    }
}

#[test]
fn what_is_no_free_decay_is_said() {
    let still = Phone { amplitude: 0.0, ..USUAL };
    assert!(matches!(Decay::of(&still.readings()), Err(NoDecay::Still { .. })));
    let few = Phone { seconds: 1.5, ..USUAL };
    assert!(matches!(Decay::of(&few.readings()), Err(NoDecay::TooFew { .. })));
    let cut = Phone { seconds: 3.0, ..USUAL };
    let error = Decay::of(&cut.readings()).expect_err("it is cut off").to_string();
    assert!(error.contains("swung freely for"), "{error}");
    assert!(Decay::of(&[]).is_err() && Decay::of(&[[f64::NAN; 4]; 500]).is_err());
    let same = [[1.0, 2.0, 3.0, 4.0]; 500];
    assert!(matches!(Decay::of(&same), Err(NoDecay::TooFew(1, ..))));
    // Numbers of any size end in a sentence, or in numbers.
    for scale in [1e-300, 1e-3, 1e150, 1e300] {
        let readings: Vec<[f64; 4]> =
            USUAL.readings().iter().map(|&[t, x, y, z]| [t, scale * x, scale * y, scale * z]).collect();
        if let Ok(decay) = Decay::of(&readings) {
            assert!(decay.acceleration.iter().all(|x| x.is_finite()), "{scale}");
        }
    }
}

/// The files that apps and loggers write of the same readings: their head, and a row.
type File = (&'static str, fn(&[f64; 4]) -> String);

/// The ten commonest shapes: phyphox with its four ways to divide cells, with and without gravity; Sensor Logger; Physics Toolbox in
/// m/s² and in g; the lines of an Arduino without and with names.
const FILES: [File; 10] = [
    (PHYPHOX, |[t, x, y, z]| format!("{t:.9E},{x:.9E},{y:.9E},{z:.9E},0")),
    (
        "\"Time (s)\";\"Acceleration x (m/s^2)\";\"Acceleration y (m/s^2)\";\"Acceleration z (m/s^2)\"",
        |[t, x, y, z]| format!("{t:.9E};{x:.9E};{y:.9E};{z:.9E}"),
    ),
    (
        "\"Time (s)\"\t\"Acceleration x (m/s^2)\"\t\"Acceleration y (m/s^2)\"\t\"Acceleration z (m/s^2)\"",
        |[t, x, y, z]| format!("{t:.9E}\t{x:.9E}\t{y:.9E}\t{z:.9E}"),
    ),
    (
        "\"Time (s)\";\"Acceleration x (m/s^2)\";\"Acceleration y (m/s^2)\";\"Acceleration z (m/s^2)\"",
        |[t, x, y, z]| format!("{t:.9E};{x:.9E};{y:.9E};{z:.9E}").replace('.', ","),
    ),
    (LINEAR, |[t, x, y, z]| format!("{t:.6},{:.6},{:.6},{:.6},0", x - 1.2, y - 9.6, z + 0.7)),
    ("time,seconds_elapsed,z,y,x", |[t, x, y, z]| {
        format!("{},{t:.9},{z:.9},{y:.9},{x:.9}", 1_700_000_000_000_000_000_u64 + (1e9 * t) as u64)
    }),
    ("time,ax,ay,az,aT", |[t, x, y, z]| format!("{t:.5},{x:.5},{y:.5},{z:.5},9.8")),
    ("time,gFx,gFy,gFz,TgF", |[t, x, y, z]| {
        let [x, y, z] = [x, y, z].map(|a| a / 9.80665);
        format!("{t:.5},{x:.6},{y:.6},{z:.6},1.0")
    }),
    ("", |[t, x, y, z]| format!("{},{x:.3},{y:.3},{z:.3}", (1000.0 * t) as u64 + 5123)),
    ("millis\tAccX\tAccY\tAccZ", |[t, x, y, z]| format!("{}\t{x:.3}\t{y:.3}\t{z:.3}", (1000.0 * t) as u64 + 5123)),
];
const PHYPHOX: &str = "\"Time (s)\",\"Acceleration x (m/s^2)\",\"Acceleration y (m/s^2)\",\"Acceleration z (m/s^2)\",\"Absolute acceleration (m/s^2)\"";
const LINEAR: &str = "\"Time (s)\",\"Linear Acceleration x (m/s^2)\",\"Linear Acceleration y (m/s^2)\",\"Linear Acceleration z (m/s^2)\",\"Absolute acceleration (m/s^2)\"";

#[test]
fn the_files_of_apps_and_loggers_have_the_same_decay() {
    let phone = Phone { seed: 3, frequency: 7.4, damping: 0.01, ..USUAL };
    let readings = phone.readings();
    for (place, (head, row)) in FILES.iter().enumerate() {
        let rows: Vec<String> = readings.iter().map(row).collect();
        let text = if head.is_empty() { rows.join("\n") } else { format!("{head}\n{}\n", rows.join("\n")) };
        let table = read(text.into_bytes(), None).unwrap_or_else(|error| panic!("file {place}: {error}"));
        let axes = ThreeAxes::of(&table).unwrap_or_else(|| panic!("file {place}: {:?}", table.columns));
        let decay =
            Decay::alike(&axes.readings(&table)).unwrap_or_else(|error| panic!("file {place}: {error}")).remove(0);
        let [(frequency, _), (damping, _)] = identified(&as_table(&decay)).0;
        assert!((frequency / 7.4 - 1.0).abs() < 0.002, "file {place}: {frequency}");
        assert!((damping / 0.01 - 1.0).abs() < 0.15, "file {place}: {damping}");
    }
    for text in ["t,force,displacement\n0,0,0\n0.01,1,2\n0.02,1,3\n", "t,x,y\n0,0,0\n0.1,1,1\n0.2,2,2\n"] {
        let table = read(text.as_bytes().to_vec(), None).expect("it is a table");
        assert_eq!(ThreeAxes::of(&table), None, "{text}");
    }
}

#[test]
fn a_decay_is_told_in_the_words_of_a_hall() {
    let phone = Phone { seed: 5, frequency: 6.0, damping: 0.01, ..USUAL };
    let decay = Decay::of(&phone.readings()).expect("it swings");
    let (_, run) = identified(&as_table(&decay));
    let analysis = Analysis::new(&run, Wanted { diagnostics: Some(Depth::All), ..Wanted::default() });
    let diagnoses: Vec<_> = (0..run.estimates().len()).map(|place| analysis.diagnosis(place)).collect();
    let story = Story::of(&run, analysis.diagnostics(), &diagnoses).to_string();
    // T = 2π / 6, t½ = ln 2 / 0.06, Q = 50, δ = 2π 0.01.
    for (before, expected) in
        [("swings once in ", 1.0473), (", and in ", 11.552), ("Q = ", 50.0), ("logarithmic decrement ", 0.06283)]
    {
        let words = story.split_once(before).unwrap_or_else(|| panic!("{story}")).1;
        let mut numbers = words.split([' ', ',']).filter(|word| *word != "±").map(|word| word.trim_end_matches('.'));
        let [value, band]: [f64; 2] =
            std::array::from_fn(|_| numbers.next().and_then(|word| word.parse().ok()).expect("a number"));
        assert!((value - expected).abs() < 1.5 * band + 1e-4 * expected, "{before}{value} ± {band}: {story}");
        assert!(band < 0.2 * expected, "{story}");
    }
}
