//! The input between samples: an import finds out whether it is held, linear or band-limited.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use kalmanscope_core::import::{Builder, Mapping, read};
use kalmanscope_core::suggest::{Suggestion, scenario_for, suggest};
use kalmanscope_core::{Channel, Hold, Scenario, simulate};

use crate::random::Random;
use crate::run::{finished_on, last};

const FREQUENCY: f64 = 6.0;
const DAMPING: f64 = 0.03;

/// The noise of the sensor, as a share of the motion.
const NOISE: f64 = 0.01;

/// The file of an oscillator under an input that is held or linear between samples.
fn simulated(hold: Hold, per_swing: f64, samples: usize, seed: u64) -> String {
    let dt = TAU / FREQUENCY / per_swing;
    let (seed, duration) = (seed, dt * (samples - 1) as f64);
    let text = format!(
        "seed = {seed}\ndt = {dt}\nduration = {duration}\n[plant]\nkind = \"sdof\"\nnatural_frequency = {FREQUENCY}\n\
         damping_ratio = {DAMPING}\n[force]\nwhite_noise = {{ std = 1.0 }}\n[[sensors]]\nmeasures = \"displacement\"\n\
         noise_std = 0.001\n[[filters]]\nkind = \"ekf\"\n"
    );
    let record = simulate(&Scenario { hold, ..Scenario::from_toml(&text).unwrap() });
    let displacement = record.truth(Channel::DISPLACEMENT).unwrap();
    table(dt, record.input(), displacement, seed)
}

/// The same under a slow sine, in readings with much noise.
fn simulated_slowly(per_swing: f64, samples: usize, seed: u64) -> String {
    let mut random = Random::new(seed);
    let dt = TAU / FREQUENCY / per_swing;
    let input: Vec<f64> = (0..samples).map(|k| (0.5 * FREQUENCY * dt * k as f64).sin()).collect();
    let displacement: Vec<f64> = input.iter().map(|u| 0.04 * (u + random.normal())).collect();
    table(dt, &input, &displacement, seed)
}

/// The file of an oscillator under sixty tones below four fifths of the Nyquist frequency, by its exact response.
fn tones(per_swing: f64, samples: usize, seed: u64) -> String {
    let mut random = Random::new(seed);
    let dt = TAU / FREQUENCY / per_swing;
    let highest = 0.8 * std::f64::consts::PI / dt;
    let rate = DAMPING * FREQUENCY;
    let damped = FREQUENCY * (1.0 - DAMPING * DAMPING).sqrt();
    let all: Vec<[f64; 5]> = (0..60)
        .map(|k| {
            let w = highest * (f64::from(k) + random.uniform()) / 60.0;
            let phase = TAU * random.uniform();
            let (re, im) = (FREQUENCY * FREQUENCY - w * w, 2.0 * DAMPING * FREQUENCY * w);
            [w, phase, 0.2, 0.2 / re.hypot(im), phase - im.atan2(re)]
        })
        .collect();
    let forced = |t: f64| all.iter().map(|[w, _, _, a, p]| a * (w * t + p).cos()).sum::<f64>();
    let slope = -all.iter().map(|[w, _, _, a, p]| a * w * p.sin()).sum::<f64>();
    // It begins at rest.
    let (a, b) = (-forced(0.0), (-slope - rate * forced(0.0)) / damped);
    let free = |t: f64| (-rate * t).exp() * (a * (damped * t).cos() + b * (damped * t).sin());
    let times: Vec<f64> = (0..samples).map(|k| dt * k as f64).collect();
    let input: Vec<f64> =
        times.iter().map(|t| all.iter().map(|[w, phase, u, ..]| u * (w * t + phase).cos()).sum()).collect();
    let displacement: Vec<f64> = times.iter().map(|t| forced(*t) + free(*t)).collect();
    table(dt, &input, &displacement, seed)
}

fn table(dt: f64, input: &[f64], displacement: &[f64], seed: u64) -> String {
    let mut random = Random::new(seed + 1000);
    let size = (displacement.iter().map(|x| x * x).sum::<f64>() / displacement.len() as f64).sqrt();
    let mut text = "t [s],force,x\n".to_owned();
    for (k, (u, x)) in input.iter().zip(displacement).enumerate() {
        writeln!(text, "{},{u},{}", dt * k as f64, x + NOISE * size * random.normal()).unwrap();
    }
    text
}

/// The start values that an import makes from a file, and the errors of ωₙ and ζ in standard deviations.
fn identified(text: &str) -> (Suggestion, [f64; 2]) {
    let table = read(text.as_bytes(), None).unwrap();
    let (mapping, kind) = Mapping::guess(&table);
    let build = |mapping: &Mapping, hold| Builder::new(&table, mapping, kind, hold).unwrap().finish().unwrap().record;
    let record = build(&mapping, Hold::First);
    let mut scenario = scenario_for(&record);
    scenario.filters.truncate(1);
    scenario.record = Some(mapping);
    let suggestion = suggest(&scenario, &record);
    let scenario = &suggestion.scenario;
    let record = build(scenario.record.as_ref().unwrap(), scenario.hold);
    assert!((record.dt() - scenario.dt).abs() < 1e-12, "{} {}", record.dt(), scenario.dt);
    let run = finished_on(scenario, record);
    let of = |(channel, truth): (Channel, f64)| {
        let (mean, std) = last(&run.estimates()[0], channel);
        (mean - truth) / std
    };
    let errors = [(Channel::NATURAL_FREQUENCY, FREQUENCY), (Channel::DAMPING_RATIO, DAMPING)].map(of);
    (suggestion, errors)
}

/// Of the files of a kind: the imports that find it, and those with ωₙ and with ζ within two standard deviations.
fn found(course: (Hold, usize), seeds: std::ops::Range<u64>, file: impl Fn(u64) -> String) -> [usize; 3] {
    let mut counts = [0; 3];
    for seed in seeds {
        let (suggestion, errors) = identified(&file(seed));
        let Suggestion { scenario, reasons, .. } = &suggestion;
        let is_found = (scenario.hold, scenario.record.as_ref().unwrap().interpolate) == course;
        assert_eq!(reasons.iter().filter(|reason| reason.contains("between samples")).count(), 1, "{reasons:?}");
        println!("seed {seed}: {course:?} {is_found}, errors {errors:.2?} σ, {:?}", reasons.last());
        for (count, is_so) in counts.iter_mut().zip([is_found, errors[0].abs() < 2.0, errors[1].abs() < 2.0]) {
            *count += usize::from(is_so);
        }
    }
    counts
}

#[test]
fn an_import_finds_the_course_of_an_input_between_samples() {
    for per_swing in [10.0, 25.0] {
        let samples = (150.0 * per_swing) as usize;
        let held = found((Hold::Zero, 1), 1..11, |seed| simulated(Hold::Zero, per_swing, samples, seed));
        let linear = found((Hold::First, 1), 1..11, |seed| simulated(Hold::First, per_swing, samples, seed));
        let limited = found((Hold::First, 4), 101..111, |seed| tones(per_swing, samples, seed));
        for (name, counts) in [("held", held), ("linear", linear), ("band-limited", limited)] {
            assert!(counts[0] == 10 && counts[1] >= 9 && counts[2] >= 9, "{name}, {per_swing} a swing: {counts:?}");
        }
    }
}

/// A force that hardly changes from sample to sample is the same in all three: nothing is changed, and that is said.
#[test]
fn a_course_that_the_readings_do_not_tell_stays_linear() {
    let (suggestion, _) = identified(&simulated_slowly(400.0, 2000, 3));
    let Suggestion { scenario, reasons, .. } = &suggestion;
    assert_eq!((scenario.hold, scenario.record.as_ref().unwrap().interpolate), (Hold::First, 1));
    assert!(reasons.iter().any(|reason| reason.contains("is taken for linear between samples")), "{reasons:?}");
}

/// A course that the user states is not tried against others, nor is any for a record whose columns have no meaning.
#[test]
fn what_is_stated_about_the_input_stays() {
    let table = read(simulated(Hold::Zero, 10.0, 1500, 1).as_bytes(), None).unwrap();
    let (mapping, kind) = Mapping::guess(&table);
    for (steps, is_known) in [(2, true), (1, false)] {
        let mapping = Mapping { interpolate: steps, ..mapping.clone() };
        let record = Builder::new(&table, &mapping, kind, Hold::First).unwrap().finish().unwrap().record;
        let mut scenario = scenario_for(&record);
        scenario.record = Some(mapping).filter(|_| is_known);
        let Suggestion { scenario, reasons, .. } = suggest(&scenario, &record);
        assert_eq!((scenario.hold, scenario.record.map_or(1, |mapping| mapping.interpolate)), (Hold::First, steps));
        assert!(!reasons.iter().any(|reason| reason.contains("between samples")), "{reasons:?}");
    }
}
