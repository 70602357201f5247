//! Records as they are measured: a file in some dialect, a guess at its columns, suggested settings, and what comes out.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use kalmanscope_core::import::{Mapping, Time, read};
use kalmanscope_core::plant::PlantKind;
use kalmanscope_core::suggest::{scenario_for, suggest};
use kalmanscope_core::{Channel, Fit, Force, Hold, Identified, Quantity, Record, Run, Scenario, Sensor, simulate};
use kalmanscope_diagnosis::VerdictKind;

use nalgebra::Vector2;

use crate::numbers::Random;
use crate::run::{finished_on, last, suggested};
use crate::verdict;

/// 68 Hz, ζ = 0.05, a gain, an offset in both columns, a band-limited input, and few samples in a period.
struct Circuit {
    cubic: f64,
    amplitude: f64,
    seed: u64,
}

const RATE: f64 = 610.35;
const NATURAL_FREQUENCY: f64 = 429.0;
const DAMPING_RATIO: f64 = 0.048;
const GAIN: f64 = 1.86e5;

impl Circuit {
    fn file(&self, rows: usize) -> String {
        let mut numbers = Random::new(self.seed);
        let mut random = || numbers.uniform();
        let lines: Vec<[f64; 2]> =
            (0..60).map(|i| [TAU * (3.0 + 3.2 * f64::from(i) + random()), TAU * random()]).collect();
        let input = |time: f64| self.amplitude * lines.iter().map(|[w, phase]| (w * time + phase).sin()).sum::<f64>();
        let rate = |y: Vector2<f64>, time: f64| {
            let spring = NATURAL_FREQUENCY * NATURAL_FREQUENCY * y[0] + self.cubic * y[0] * y[0] * y[0];
            Vector2::new(y[1], GAIN * input(time) - 2.0 * DAMPING_RATIO * NATURAL_FREQUENCY * y[1] - spring)
        };
        const FINE: usize = 16;
        let h = 1.0 / (RATE * FINE as f64);
        let mut state = Vector2::zeros();
        let mut text = "\"V1\";\"V2\"\n".to_owned();
        for k in 0..rows * FINE {
            let time = k as f64 * h;
            if k.is_multiple_of(FINE) {
                let noise = 3e-4 * (random() + random() + random() - 1.5);
                let [u, z] =
                    [input(time) + 0.0055, state[0] + 0.002 + noise].map(|x| format!("{x:.6}").replace('.', ","));
                writeln!(text, "{u};{z}").unwrap();
            }
            state = runge_kutta(state, time, h, rate);
        }
        text
    }
}

fn runge_kutta(y: Vector2<f64>, t: f64, h: f64, rate: impl Fn(Vector2<f64>, f64) -> Vector2<f64>) -> Vector2<f64> {
    let a = rate(y, t);
    let b = rate(y + a * (0.5 * h), t + 0.5 * h);
    let c = rate(y + b * (0.5 * h), t + 0.5 * h);
    let d = rate(y + c * h, t + h);
    y + (a + 2.0 * b + 2.0 * c + d) * (h / 6.0)
}

/// Where the scenario does not know the file's columns, the input stays linear between samples.
fn identify(text: &str, plant: &PlantKind, knows_columns: bool) -> (Scenario, Run) {
    let rate = |mapping: &mut Mapping| mapping.time = Time { rate: Some(RATE), ..Time::default() };
    let change = |scenario: &mut Scenario| {
        scenario.set_plant(plant.clone());
        scenario.record = scenario.record.take().filter(|_| knows_columns);
    };
    let (suggestion, run) = suggested(&read(text.as_bytes(), None).unwrap(), rate, change);
    (suggestion.scenario, run)
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
        let (scenario, run) = identify(&text, &PlantKind::SDOF, true);
        for filter in 0..2 {
            let [wn, zeta] =
                [Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO].map(|c| last(&run.estimates()[filter], c).0);
            assert!((wn / NATURAL_FREQUENCY - 1.0).abs() < 0.01, "seed {seed}, filter {filter}: {wn}");
            assert!((zeta / DAMPING_RATIO - 1.0).abs() < 0.1, "seed {seed}, filter {filter}: {zeta}");
            let fit = free_run(&scenario, run.record(), &run, filter);
            assert!(fit.percent > 90.0, "seed {seed}, filter {filter}: {fit:?}");
        }
    }
}

#[test]
fn a_finer_input_makes_a_hardening_circuit_run_freely() {
    let text = Circuit { cubic: 7.3e5, amplitude: 0.008, seed: 7 }.file(6000);
    let error = |knows_columns: bool| {
        let (scenario, run) = identify(&text, &PlantKind::DUFFING, knows_columns);
        let steps = scenario.record.as_ref().map_or(1, |mapping| mapping.interpolate);
        assert_eq!((steps, scenario.hold), (if knows_columns { 4 } else { 1 }, Hold::First));
        let cubic = last(&run.estimates()[0], Channel::CUBIC_STIFFNESS).0;
        assert!((cubic / 7.3e5 - 1.0).abs() < 0.05, "{steps}: {cubic}");
        free_run(&scenario, run.record(), &run, 0)
    };
    let (coarse, fine) = (error(false), error(true));
    assert!(coarse.percent > 95.0, "{coarse:?}");
    assert!(fine.rms < 0.6 * coarse.rms && fine.percent > 99.0, "{fine:?} against {coarse:?}");
}

const BENCHMARK: [(Channel, f64); 5] = [
    (Channel::NATURAL_FREQUENCY, 223.607),
    (Channel::DAMPING_RATIO, 0.01118),
    (Channel::POST_YIELD_RATIO, 0.5),
    (Channel::YIELD_BETA, 800.0),
    (Channel::YIELD_GAMMA, -1100.0),
];

/// 8 s at 750 Hz of the benchmark: m = 2 kg, c = 10 N s/m, k = α = 5e4 N/m, β = 1e3, γ = 0.8, δ = -1.1, ν = 1, noise of
/// 8e-6 m, under a force of 50 N from 5 to 150 Hz, here white to 375 Hz.
fn benchmark(seed: u64) -> Record {
    let mut scenario = Scenario { seed, dt: 1.0 / 750.0, duration: 8.0, filters: vec![], ..Scenario::default() };
    scenario.set_plant(PlantKind::BOUC_WEN_1);
    scenario.force = Force::WhiteNoise { std: 40.0 };
    scenario.plant.disturbance_std = 0.0;
    BENCHMARK.into_iter().for_each(|(channel, value)| scenario.plant.set(channel, value));
    scenario.sensors = vec![Sensor::new(Quantity::DISPLACEMENT, 8e-6)];
    simulate(&scenario)
}

/// The plant that is asked for has the exponent 2; the record is that of the exponent 1.
#[test]
fn the_exponent_of_the_benchmark_is_found_with_all_its_parameters_and_the_filter_is_consistent() {
    for seed in 951..953 {
        let record = benchmark(seed);
        let mut scenario = scenario_for(&record);
        scenario.set_plant(PlantKind::BOUC_WEN);
        scenario.filters.truncate(1);
        let suggestion = suggest(&scenario, &record);
        assert_eq!(suggestion.scenario.plant.kind, PlantKind::BOUC_WEN_1, "{:?}", suggestion.reasons);
        let said = "the plant is `bouc_wen_1`, the likelier exponent";
        assert!(suggestion.reasons.iter().any(|reason| reason.starts_with(said)), "{:?}", suggestion.reasons);
        let run = finished_on(&suggestion.scenario, record);
        let estimates = &run.estimates()[0];
        assert_eq!(verdict(&run, 0), VerdictKind::Consistent, "seed {seed}");
        for (channel, truth) in BENCHMARK {
            let (mean, std) = last(estimates, channel);
            assert!((mean - truth).abs() < 3.5 * std, "seed {seed}, {channel:?}: {mean} ± {std}");
        }
    }
}
