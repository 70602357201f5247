//! What a microphone tells of a thing that was struck, from the sound's file to the parameters.

use std::f64::consts::TAU;
use std::io::Cursor;

use kalmanscope_core::diagnostics::Depth;
use kalmanscope_core::free_decay::Ring;
use kalmanscope_core::import::{ImportError, Mapping, read};
use kalmanscope_core::{Analysis, Scenario, Story, Wanted};

use crate::random::Random;
use crate::run::{finished, identified};

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
            let ring = Ring::of(&table).unwrap_or_else(|| panic!("seed {seed}, {frequency} Hz"));
            let (found, run) = identified(&table);
            let name = format!("seed {seed}, {frequency} Hz: {found:?} {ring:?}");
            assert!((found[0].0 / (TAU * frequency) - 1.0).abs() < 0.002, "{name}");
            assert!((found[1].0 / damping - 1.0).abs() < 0.15, "{name}");
            inside[0] += i32::from((found[0].0 - TAU * frequency).abs() < 2.0 * found[0].1);
            inside[1] += i32::from((found[1].0 - damping).abs() < 2.0 * found[1].1);
            count += 1;
            let analysis = Analysis::new(&run, Wanted { diagnostics: Some(Depth::All), ..Wanted::default() });
            let diagnoses = [0, 1].map(|place| analysis.diagnosis(place));
            let story = Story::of(&run, analysis.diagnostics(), &diagnoses).to_string();
            believed += i32::from(story.contains("Both can be believed"));
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
    let (mapping, _) = Mapping::guess(&table);
    assert!(mapping.input.is_none() && mapping.every > 10 && mapping.from > Some(0.7), "{mapping:?}");
    let cut = read(FORK.wav(1)[..20].to_vec(), None).expect_err("it is cut");
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
        let run = finished(&Scenario::from_toml(&text).expect("a scenario"));
        let analysis = Analysis::new(&run, Wanted { diagnostics: Some(Depth::All), ..Wanted::default() });
        Story::of(&run, analysis.diagnostics(), &[analysis.diagnosis(0)]).to_string()
    };
    let said = "may claim more than it knows: the motion turns by more than 30° in a step";
    assert!(story(1).contains(said), "{}", story(1));
    assert!(!story(6).contains(said), "{}", story(6));
}
