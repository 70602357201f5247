//! Records as they are measured: a file in some dialect, a guess at its columns, suggested settings, and what comes out.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::sync::Arc;

use kalmanscope_core::import::{Builder, Mapping, Time, read};
use kalmanscope_core::suggest::{scenario_for, suggest};
use kalmanscope_core::{Channel, Fit, Hold, Identified, PlantKind, Record, Run, Scenario};

/// A circuit that behaves like an oscillator: 68 Hz, ζ = 0.05, a gain of the input, an offset in both columns, an input that is
/// limited in band, and few samples in a period.
struct Circuit {
    cubic: f64,
    amplitude: f64,
    seed: u64,
}

const RATE: f64 = 610.35;
const NATURAL_FREQUENCY: f64 = 429.0;
const DAMPING_RATIO: f64 = 0.048;
const GAIN: f64 = 1.86e5;

/// Numbers between 0 and 1.
fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}

impl Circuit {
    /// A file with two columns of volts and no times, a semicolon between them.
    fn file(&self, rows: usize) -> String {
        let mut random = random(self.seed);
        let lines: Vec<[f64; 2]> =
            (0..60).map(|i| [TAU * (3.0 + 3.2 * f64::from(i) + random()), TAU * random()]).collect();
        let input = |time: f64| self.amplitude * lines.iter().map(|[w, phase]| (w * time + phase).sin()).sum::<f64>();
        let rate = |[x, v]: [f64; 2], time: f64| {
            let spring = NATURAL_FREQUENCY * NATURAL_FREQUENCY * x + self.cubic * x * x * x;
            [v, GAIN * input(time) - 2.0 * DAMPING_RATIO * NATURAL_FREQUENCY * v - spring]
        };
        const FINE: usize = 16;
        let h = 1.0 / (RATE * FINE as f64);
        let mut state = [0.0; 2];
        let mut text = "\"V1\";\"V2\"\n".to_owned();
        for k in 0..rows * FINE {
            let time = k as f64 * h;
            if k.is_multiple_of(FINE) {
                let noise = 3e-4 * (random() + random() + random() - 1.5);
                let [u, z] =
                    [input(time) + 0.0055, state[0] + 0.002 + noise].map(|x| format!("{x:.6}").replace('.', ","));
                writeln!(text, "{u};{z}").unwrap();
            }
            let step = |s: [f64; 2], r: [f64; 2], share: f64| [s[0] + share * h * r[0], s[1] + share * h * r[1]];
            let k1 = rate(state, time);
            let k2 = rate(step(state, k1, 0.5), time + 0.5 * h);
            let k3 = rate(step(state, k2, 0.5), time + 0.5 * h);
            let k4 = rate(step(state, k3, 1.0), time + h);
            for i in 0..2 {
                state[i] += h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
            }
        }
        text
    }
}

/// Imports a file as a user does: gives the rate and takes the suggested settings.
fn identify(text: &str, plant: PlantKind, change: impl Fn(&mut Mapping)) -> (Scenario, Record, Run) {
    identify_by(text, plant, change, true)
}

/// The same, of which the scenario knows the file's columns or not: without them the input stays linear between samples.
fn identify_by(
    text: &str,
    plant: PlantKind,
    change: impl Fn(&mut Mapping),
    knows_columns: bool,
) -> (Scenario, Record, Run) {
    let table = read(text.as_bytes(), None).unwrap();
    let (mut mapping, kind) = Mapping::guess(&table);
    mapping.time = Time { rate: Some(RATE), ..Time::default() };
    change(&mut mapping);
    let build = |mapping: &Mapping, hold| Builder::new(&table, mapping, kind, hold).unwrap().finish().unwrap().record;
    let record = build(&mapping, Hold::First);
    let mut scenario = scenario_for(&record);
    scenario.set_plant(plant);
    scenario.record = Some(mapping.clone()).filter(|_| knows_columns);
    let scenario = suggest(&scenario, &record).scenario;
    let record = build(scenario.record.as_ref().unwrap_or(&mapping), scenario.hold);
    let mut run = Run::on_record(&scenario, Arc::new(record.clone())).unwrap();
    run.finish();
    (scenario, record, run)
}

fn last(run: &Run, filter: usize, channel: Channel) -> f64 {
    let estimates = &run.estimates()[filter];
    estimates.mean(estimates.len() - 1)[estimates.place(channel).unwrap()]
}

fn free_run(scenario: &Scenario, record: &Record, run: &Run, filter: usize) -> Fit {
    let estimates = &run.estimates()[filter];
    let model = Identified::at(scenario, &scenario.filters[filter], estimates, estimates.len() - 1);
    model.run(record, 0..record.len()).fits[0].unwrap()
}

#[test]
fn the_suggested_settings_find_a_linear_circuit() {
    for seed in 1..=5 {
        let text = Circuit { cubic: 0.0, amplitude: 0.002, seed }.file(8192);
        let (scenario, record, run) = identify(&text, PlantKind::SDOF, |_| {});
        for filter in 0..2 {
            let [wn, zeta] = [Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO].map(|c| last(&run, filter, c));
            assert!((wn / NATURAL_FREQUENCY - 1.0).abs() < 0.01, "seed {seed}, filter {filter}: {wn}");
            assert!((zeta / DAMPING_RATIO - 1.0).abs() < 0.1, "seed {seed}, filter {filter}: {zeta}");
            let fit = free_run(&scenario, &record, &run, filter);
            assert!(fit.percent > 90.0, "seed {seed}, filter {filter}: {fit:?}");
        }
    }
}

#[test]
fn a_finer_input_makes_a_hardening_circuit_run_freely() {
    let text = Circuit { cubic: 7.3e5, amplitude: 0.008, seed: 7 }.file(6000);
    let error = |knows_columns: bool| {
        let (scenario, record, run) = identify_by(&text, PlantKind::DUFFING, |_| {}, knows_columns);
        let steps = scenario.record.as_ref().map_or(1, |mapping| mapping.interpolate);
        assert_eq!((steps, scenario.hold), (if knows_columns { 4 } else { 1 }, Hold::First));
        let cubic = last(&run, 0, Channel::CUBIC_STIFFNESS);
        assert!((cubic / 7.3e5 - 1.0).abs() < 0.05, "{steps}: {cubic}");
        free_run(&scenario, &record, &run, 0)
    };
    let (coarse, fine) = (error(false), error(true));
    assert!(coarse.percent > 95.0, "{coarse:?}");
    assert!(fine.rms < 0.6 * coarse.rms && fine.percent > 99.0, "{fine:?} against {coarse:?}");
}
