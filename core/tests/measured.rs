//! Records as they are measured: a file in some dialect, a guess at its columns, suggested settings, and what comes out.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use kalmanscope_core::import::{Builder, Mapping, Time, read};
use kalmanscope_core::plant::PlantKind;
use kalmanscope_core::suggest::{scenario_for, suggest};
use kalmanscope_core::{
    Channel, Diagnosis, Diagnostics, FilterKind, FilterSettings, Fit, Force, Hold, Identified, Quantity, Record, Run,
    Scenario, Sensor, Signal, VerdictKind,
};

use crate::run::{finished, finished_on, last};

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

fn identify(text: &str, plant: PlantKind, change: impl Fn(&mut Mapping)) -> (Scenario, Record, Run) {
    identify_by(text, plant, change, true)
}

/// Like `identify`; the scenario knows the file's columns or not: without them the input stays linear between samples.
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
    let run = finished_on(&scenario, record.clone());
    (scenario, record, run)
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
            let [wn, zeta] =
                [Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO].map(|c| last(&run.estimates()[filter], c).0);
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
        let cubic = last(&run.estimates()[0], Channel::CUBIC_STIFFNESS).0;
        assert!((cubic / 7.3e5 - 1.0).abs() < 0.05, "{steps}: {cubic}");
        free_run(&scenario, &record, &run, 0)
    };
    let (coarse, fine) = (error(false), error(true));
    assert!(coarse.percent > 95.0, "{coarse:?}");
    assert!(fine.rms < 0.6 * coarse.rms && fine.percent > 99.0, "{fine:?} against {coarse:?}");
}

/// 8 s at 750 Hz of the benchmark: m = 2 kg, c = 10 N s/m, k = α = 5e4 N/m, β = 1e3, γ = 0.8, δ = -1.1, ν = 1, noise of
/// 8e-6 m, under a force of 50 N from 5 to 150 Hz, here white to 375 Hz.
fn benchmark(seed: u64) -> Record {
    let mut scenario = Scenario { seed, dt: 1.0 / 750.0, duration: 8.0, filters: vec![], ..Scenario::default() };
    scenario.set_plant(PlantKind::BOUC_WEN_1);
    scenario.force = Force::WhiteNoise { std: 40.0 };
    scenario.plant.disturbance_std = 0.0;
    for (channel, value) in [
        (Channel::NATURAL_FREQUENCY, 223.607),
        (Channel::DAMPING_RATIO, 0.01118),
        (Channel::POST_YIELD_RATIO, 0.5),
        (Channel::YIELD_BETA, 800.0),
        (Channel::YIELD_GAMMA, -1100.0),
    ] {
        scenario.plant.set(channel, Signal::Constant(value));
    }
    scenario.sensors = vec![Sensor::new(Quantity::DISPLACEMENT, 8e-6)];
    finished(&scenario).record().clone()
}

/// The root mean square error of the free run of a filter's final model over another record [m].
fn rms_of_free_run(run: &Run, place: usize, record: &Record) -> f64 {
    let scenario = run.scenario();
    let estimates = &run.estimates()[place];
    let model = Identified::at(scenario, &scenario.filters[place], estimates, estimates.len() - 1);
    let free = model.run(record, 0..record.len());
    free.fit(record, Quantity::DISPLACEMENT).map_or(f64::INFINITY, |fit| fit.rms)
}

#[test]
fn the_benchmark_is_identified_better_than_by_a_linear_oscillator() {
    for seed in 901..904 {
        let (record, other) = (benchmark(seed), benchmark(seed + 50));
        let mut scenario = scenario_for(&record);
        let settings = FilterSettings { id: 0, ..scenario.filters[0].clone() };
        let of = |name: &str, kind, plant| FilterSettings { name: name.to_owned(), kind, plant, ..settings.clone() };
        scenario.filters = vec![
            of("linear", FilterKind::EKF, None),
            of("one", FilterKind::UKF, Some(PlantKind::BOUC_WEN_1)),
            of("two", FilterKind::UKF, Some(PlantKind::BOUC_WEN)),
        ];
        scenario.number_filters();
        let scenario = suggest(&scenario, &record).scenario;
        for (filter, name) in scenario.filters.iter().zip(["linear", "one", "two"]) {
            println!("{name}: {:?}\n  ± {:?}", filter.initial_mean, filter.initial_std);
        }
        let run = finished_on(&scenario, record.clone());
        let errors = [0, 1, 2].map(|place| rms_of_free_run(&run, place, &other));
        let one = &run.estimates()[1];
        let last = one.mean(one.len() - 1);
        println!("seed {seed}: free run of linear, exponent 1, exponent 2 {errors:?} m; {last:.4?}, {:?}", one.stop());
        assert!(errors[1] < 0.5 * errors[0], "seed {seed}: {errors:?}");
    }
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
        let diagnosis =
            Diagnosis::new(&Diagnostics::new(estimates, run.record()), estimates, run.record(), None).unwrap();
        assert_eq!(diagnosis.verdict.unwrap().kind, VerdictKind::Consistent, "seed {seed}");
        for (channel, truth) in [
            (Channel::NATURAL_FREQUENCY, 223.607),
            (Channel::DAMPING_RATIO, 0.01118),
            (Channel::POST_YIELD_RATIO, 0.5),
            (Channel::YIELD_BETA, 800.0),
            (Channel::YIELD_GAMMA, -1100.0),
        ] {
            let (mean, std) = last(estimates, channel);
            assert!((mean - truth).abs() < 3.5 * std, "seed {seed}, {channel:?}: {mean} ± {std}");
        }
    }
}
