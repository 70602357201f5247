//! The parameters of a free decay from the raw readings of a phone's accelerometer, and of a struck thing from the file of its sound.

use std::f64::consts::TAU;
use std::io::Cursor;

use kalmanscope_core::free_decay::{Decay, NoDecay, Ring};
use kalmanscope_core::import::{ImportError, Mapping, Table, ThreeAxes, read};
use kalmanscope_core::{Run, Scenario};
use kalmanscope_diagnosis::{Analysis, Story, Summary, VerdictKind, Wanted};

use crate::numbers::Random;
use crate::phone::{Phone, USUAL};
use crate::run::{finished, identified};

fn told(run: &Run) -> String {
    let analysis = Analysis::new(run, Wanted { diagnostics: true, ..Wanted::default() });
    let diagnoses: Vec<_> = (0..run.estimates().len()).map(|place| analysis.diagnosis(place)).collect();
    Story::of(run, analysis.diagnostics(), &diagnoses).to_string()
}

fn as_table(decay: &Decay) -> Table {
    read(Decay::file(std::slice::from_ref(decay)).into_bytes(), None).expect("it is a table")
}

fn count_inside(inside: &mut [i32; 2], found: [(f64, f64); 2], truth: [f64; 2], name: &str) {
    for (i, (mean, std)) in found.into_iter().enumerate() {
        assert!((mean / truth[i] - 1.0).abs() < [0.002, 0.15][i], "{name}");
        inside[i] += i32::from((mean - truth[i]).abs() < 2.0 * std);
    }
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
            let (found, run) = identified(&as_table(&decay));
            let verdict = Summary::new(&run.estimates()[0], run.record()).verdict.map(|verdict| verdict.kind);
            let name = format!("seed {seed}, {frequency} rad/s, {damping}: {found:?}");
            count_inside(&mut inside, found, [frequency, damping], &name);
            consistent += i32::from(verdict == Some(VerdictKind::Consistent));
            count += 1;
        }
    }
    assert_eq!(count, 32);
    println!("inside ±2σ: {inside:?} of {count}, {consistent} consistent");
    assert!(consistent >= 30, "{consistent} of {count} are consistent");
    assert!(inside.iter().all(|inside| *inside >= 26), "inside their bands: {inside:?} of {count}");
}

fn assert_identified(decay: &Decay, phone: &Phone, shares: [f64; 2], what: &str) {
    let [(frequency, _), (damping, _)] = identified(&as_table(decay)).0;
    assert!((frequency / phone.frequency - 1.0).abs() < shares[0], "{what}: {frequency}");
    assert!((damping / phone.damping - 1.0).abs() < shares[1], "{what}: {damping}");
}

#[test]
fn a_decay_ends_at_rest() {
    let long = Phone { damping: 0.05, seconds: 60.0, ..USUAL };
    let decay = Decay::of(&long.readings()).expect("it swings");
    assert!((2.0..4.0).contains(&decay.begin), "{}", decay.begin);
    let seconds = decay.times[decay.times.len() - 1];
    assert!(decay.rests && (6.0..25.0).contains(&seconds), "the rest is noise: {seconds} s");
    assert!((0.01..0.03).contains(&decay.noise), "{}", decay.noise);
    let along: f64 = decay.axis.iter().zip([1.2, 9.6, -0.7]).map(|(axis, gravity)| axis * gravity).sum();
    assert!((decay.gravity - along).abs() < 0.01, "{} for {along}", decay.gravity);
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
            assert_identified(&decay, &phone, [0.002, 0.15], &format!("seed {seed}"));
        }
    }
}

#[test]
fn every_pluck_is_found_and_the_hand_that_takes_the_phone_spoils_none() {
    for seed in 1..=5 {
        let twice = Phone { again: Some(15.0), damping: 0.03, seed, ..USUAL };
        let decays = Decay::all(&twice.readings()).expect("it swings");
        assert!(decays.len() == 2 && !decays[0].rests, "seed {seed}: {decays:?}");
        assert!(decays[0].begin + decays[0].seconds() <= 15.0 && decays[1].begin > 15.0, "seed {seed}");
        for decay in &decays {
            assert_identified(decay, &twice, [0.005, 0.15], &format!("seed {seed}"));
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
        assert_identified(&decay, &phone, [0.002, 0.15], &format!("seed {seed}"));
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
    assert!(error.contains("the free motion lasted only"), "{error}");
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

type File = (&'static str, fn(&[f64; 4]) -> String);

/// phyphox, with and without gravity; Sensor Logger; Physics Toolbox in m/s² and in g; an Arduino without and with names.
const FILES: [File; 7] = [
    (PHYPHOX, |[t, x, y, z]| format!("{t:.9E},{x:.9E},{y:.9E},{z:.9E},0")),
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
    let text = |(head, row): &File| {
        let rows: Vec<String> = readings.iter().map(row).collect();
        if head.is_empty() { rows.join("\n") } else { format!("{head}\n{}\n", rows.join("\n")) }
    };
    let commas = text(&FILES[0]);
    let semicolons = commas.replace(',', ";");
    let others = [commas.replace(',', "\t"), semicolons.replace('.', ","), semicolons];
    for (place, text) in FILES.iter().map(text).chain(others).enumerate() {
        let table = read(text.into_bytes(), None).unwrap_or_else(|error| panic!("file {place}: {error}"));
        let axes = ThreeAxes::of(&table).unwrap_or_else(|| panic!("file {place}: {:?}", table.columns));
        let decay =
            Decay::alike(&axes.readings(&table)).unwrap_or_else(|error| panic!("file {place}: {error}")).remove(0);
        assert_identified(&decay, &phone, [0.002, 0.15], &format!("file {place}"));
    }
    for text in ["t,force,displacement\n0,0,0\n0.01,1,2\n0.02,1,3\n", "t,x,y\n0,0,0\n0.1,1,1\n0.2,2,2\n"] {
        let table = read(text.as_bytes(), None).expect("it is a table");
        assert_eq!(ThreeAxes::of(&table), None, "{text}");
    }
}

#[test]
fn a_decay_is_told_in_the_words_of_a_hall() {
    let phone = Phone { seed: 5, frequency: 6.0, damping: 0.01, ..USUAL };
    let decay = Decay::of(&phone.readings()).expect("it swings");
    let (_, run) = identified(&as_table(&decay));
    let story = told(&run);
    // T = 2π / 6, t½ = ln 2 / 0.06, Q = 50, δ = 2π 0.01.
    for (before, expected) in
        [("period is ", 1.0473), ("halves in ", 11.552), ("Q = ", 50.0), ("logarithmic decrement ", 0.06283)]
    {
        let words = story.split_once(before).unwrap_or_else(|| panic!("{story}")).1;
        let mut numbers = words.split([' ', ',']).filter(|word| *word != "±").map(|word| word.trim_end_matches('.'));
        let [value, band]: [f64; 2] =
            std::array::from_fn(|_| numbers.next().and_then(|word| word.parse().ok()).expect("a number"));
        assert!((value - expected).abs() < 1.5 * band + 1e-4 * expected, "{before}{value} ± {band}: {story}");
        assert!(band < 0.2 * expected, "{story}");
    }
}

#[derive(Clone, Copy)]
struct Sound {
    seed: u64,
    rate: u32,
    /// Frequency \[Hz\], damping ratio and amplitude of its modes.
    modes: [(f64, f64, f64); 2],
    /// The noise of the room, its rumble at low frequencies, and the hum of the mains at 50 Hz.
    noise: f64,
    rumble: f64,
    hum: f64,
    seconds: f64,
}

const FORK: Sound = Sound {
    seed: 1,
    rate: 48_000,
    modes: [(440.0, 4e-4, 0.2), (2756.0, 1e-3, 0.1)],
    noise: 1e-3,
    rumble: 2e-3,
    hum: 2e-3,
    seconds: 6.0,
};

impl Sound {
    fn samples(&self) -> Vec<f64> {
        let mut random = Random::new(self.seed);
        let rate = f64::from(self.rate);
        let mut rumble = 0.0;
        (0..(self.seconds * rate) as usize)
            .map(|k| {
                let t = k as f64 / rate;
                // A room below some 30 Hz.
                rumble += 0.004 * (-rumble + 16.0 * self.rumble * random.normal());
                let room = self.noise * random.normal() + rumble + self.hum * (TAU * 50.0 * t + 0.4).sin();
                let since = t - 0.7;
                if since < 0.0 {
                    return room;
                }
                let knock = 0.3 * (-since / 0.002).exp() * random.normal();
                let ring = |(f, z, a): (f64, f64, f64)| {
                    let w = TAU * f;
                    a * (-z * w * since).exp() * (w * (1.0 - z * z).sqrt() * since).sin()
                };
                room + knock + self.modes.into_iter().map(ring).sum::<f64>()
            })
            .map(|x| x.clamp(-1.0, 1.0))
            .collect()
    }

    fn wav(&self, channels: u16) -> Vec<u8> {
        let spec = hound::WavSpec {
            channels,
            sample_rate: self.rate,
            bits_per_sample: 16,
            sample_format: hound::SampleFormat::Int,
        };
        let mut bytes = Cursor::new(Vec::new());
        let mut writer = hound::WavWriter::new(&mut bytes, spec).expect("it can be written");
        for x in self.samples() {
            for _ in 0..channels {
                writer.write_sample((32_767.0 * x).round() as i16).expect("memory");
            }
        }
        writer.finalize().expect("memory");
        bytes.into_inner()
    }
}

#[test]
fn pitch_and_damping_are_found_from_what_was_struck() {
    let (mut inside, mut believed, mut count) = ([0, 0], 0, 0);
    for seed in 1..=8 {
        for (modes, noise, rate) in [
            (FORK.modes, 1e-3, 48_000),
            // A glass with a second mode within the band.
            ([(812.0, 2e-3, 0.3), (1630.0, 3e-3, 0.1)], 2e-3, 44_100),
            // A ruler on the edge of a table, in a loud room.
            ([(31.0, 0.02, 0.4), (180.0, 0.02, 0.05)], 5e-3, 48_000),
            // A small bell.
            ([(3950.0, 3e-4, 0.2), (9100.0, 5e-4, 0.1)], 1e-3, 48_000),
        ] {
            let sound = Sound { seed, modes, noise, rate, ..FORK };
            let table = read(sound.wav(1), None).expect("it is a sound");
            let (frequency, damping, _) = modes[0];
            let (rate, values) = table.sound().expect("it is a sound");
            let ring = Ring::in_samples(rate, values).unwrap_or_else(|| panic!("seed {seed}, {frequency} Hz"));
            let (found, run) = identified(&table);
            let name = format!("seed {seed}, {frequency} Hz: {found:?} {ring:?}");
            count_inside(&mut inside, found, [TAU * frequency, damping], &name);
            count += 1;
            believed += i32::from(told(&run).contains("Trust both"));
        }
    }
    println!("inside ±2σ: {inside:?} of {count}, {believed} believed");
    assert!(inside.iter().all(|inside| *inside >= 29), "inside their bands: {inside:?} of {count}");
    assert!(believed >= 28, "{believed} of {count} are said to be right");
}

#[test]
fn a_sound_is_a_table_of_its_channels() {
    let table = read(FORK.wav(2), None).expect("it is a sound");
    let names: Vec<&str> = table.columns.iter().map(|column| column.name.as_str()).collect();
    assert_eq!((names, table.rows()), (vec!["t", "sound 1", "sound 2"], 288_000));
    assert!((table.columns[0].values[48_000] - 1.0).abs() < 1e-12);
    let samples = FORK.samples();
    assert!(table.columns[2].values.iter().zip(&samples).all(|(a, b)| (a - b).abs() < 1e-4));
    let (mut mapping, _) = Mapping::guess(&table);
    let _ = Ring::choose(&table, &mut mapping);
    assert!(mapping.input.is_none() && mapping.every > 10 && mapping.from > Some(0.7), "{mapping:?}");
    let cut = read(&FORK.wav(1)[..20], None).expect_err("it is cut");
    assert!(matches!(cut, ImportError::Sound(_)), "{cut}");
}

#[test]
fn where_nothing_rings_there_is_no_ring() {
    let modes = [(440.0, 4e-4, 0.0); 2];
    for samples in [Sound { modes, ..FORK }.samples(), vec![0.0; 50_000], vec![0.5; 100], Vec::new()] {
        assert_eq!(Ring::in_samples(48_000.0, &samples), None);
    }
    let wild: Vec<f64> = (0..30_000).map(|k| if k % 7 == 0 { 1e300 } else { -1e300 }).collect();
    for samples in [wild, vec![f64::NAN; 30_000]] {
        let _ = Ring::in_samples(48_000.0, &samples);
    }
}

#[test]
fn long_steps_that_make_a_band_too_narrow_are_said() {
    let story = |substeps: usize| {
        let text = format!(
            "dt = 0.2\nduration = 200.0\nforce = \"none\"\n[plant]\nnatural_frequency = 6.0\ndamping_ratio = 0.002\ninitial = {{ displacement = 0.2 }}\n\
             [[sensors]]\nmeasures = \"displacement\"\nnoise_std = 0.02\n[[filters]]\nkind = \"ekf\"\n\
             substeps = {substeps}\ninitial_mean = {{ displacement = 0.1, natural_frequency = 6.001, damping_ratio = 0.0021 }}\n\
             initial_std = {{ displacement = 0.2, velocity = 1.2, natural_frequency = 0.01, damping_ratio = 0.001 }}\n"
        );
        told(&finished(&Scenario::from_toml(&text).expect("a scenario")))
    };
    let said = "its band may be too narrow: the motion turns by more than 30° in a step";
    assert!(story(1).contains(said), "{}", story(1));
    assert!(!story(6).contains(said), "{}", story(6));
}
