//! Forces that are not recorded: a white one against the normal distribution of all samples at once, and those with a course.

use kalmanscope_core::{
    Channel, Estimates, FilterKind, FilterSettings, Hold, Quantity, Record, Run, Scenario, Sensor, Values,
};

use nalgebra::{DMatrix, DVector};

use crate::numbers::{Random, log_normal, mean, motion, transition};
use crate::run::{finished, finished_on, forced, last, run_on, values};

const WN: f64 = 6.0;
const ZETA: f64 = 0.05;
const DT: f64 = 0.02;
const SAMPLES: usize = 30;
const FORCE: f64 = 2.0;
const X0: f64 = 0.03;
const V0: f64 = 0.2;
const CONSTANT: usize = 2 + 2 * SAMPLES;
const SENSORS: [(Quantity, f64); 3] =
    [(Quantity::DISPLACEMENT, 0.002), (Quantity::VELOCITY, 0.05), (Quantity::ACCELERATION, 0.3)];

fn effects(time: f64) -> [[f64; 3]; 2] {
    let [[xx, vx], [xv, vv]]: [[f64; 2]; 2] = transition([WN, ZETA], time).into();
    [[xx, xv, (1.0 - xx) / (WN * WN)], [vx, vv, -vx / (WN * WN)]]
}

fn reading(sensor: usize, k: usize) -> f64 {
    let phase = 1.3 * k as f64 + 2.0 * sensor as f64;
    [0.05, 0.3, 3.0][sensor] * (phase.sin() + 0.5 * (2.7 * phase).cos())
}

fn recorded(k: usize) -> f64 {
    (0.4 * k as f64).sin()
}

/// Every number of the record as a sum over independent normal numbers: x₀, ẋ₀, the force of each sample, and what a force
/// that is not held does to x besides. The last number is the constant part.
struct Course {
    states: Vec<[Vec<f64>; 2]>,
    stds: Vec<f64>,
}

fn course(hold: Hold, sensors: &[usize]) -> Course {
    let numbers = CONSTANT;
    let mut x = vec![0.0; numbers + 1];
    let mut v = x.clone();
    (x[0], v[1]) = (1.0, 1.0);
    let mut states = vec![[x.clone(), v.clone()]];
    // The force of each part of a step, and the recorded one at its beginning and end.
    let is_felt = sensors.contains(&2);
    let parts: &[(f64, usize)] = if hold == Hold::First && is_felt { &[(0.5, 0), (0.5, 1)] } else { &[(1.0, 0)] };
    for k in 0..SAMPLES - 1 {
        let mut past = 0.0;
        for &(share, later) in parts {
            // A recorded force that is linear, as many short steps.
            let steps = if hold == Hold::First { 4000 } else { 1 };
            for i in 0..steps {
                let part = past + share * (f64::from(i) + 0.5) / f64::from(steps);
                let force = match hold {
                    Hold::Zero => recorded(k),
                    Hold::First => recorded(k) + part * (recorded(k + 1) - recorded(k)),
                };
                let [to_x, to_v] = effects(share * DT / f64::from(steps));
                let moved = |to: [f64; 3]| -> Vec<f64> {
                    let mut next: Vec<f64> = x.iter().zip(&v).map(|(x, v)| to[0] * x + to[1] * v).collect();
                    next[2 + k + later] += to[2];
                    next[numbers] += to[2] * force;
                    next
                };
                (x, v) = (moved(to_x), moved(to_v));
            }
            past += share;
        }
        // The variance of a double integral of white noise of intensity s² dt, less that of its mean: dt³/3 - dt³/4.
        x[2 + SAMPLES + k] += if hold == Hold::First && !is_felt { FORCE * DT * DT / 12.0_f64.sqrt() } else { 0.0 };
        states.push([x.clone(), v.clone()]);
    }
    let stds = [X0, V0].into_iter().chain([FORCE; SAMPLES]).chain([1.0; SAMPLES]).collect();
    Course { states, stds }
}

impl Course {
    fn row(&self, sensor: usize, k: usize) -> Vec<f64> {
        let [x, v] = &self.states[k];
        match sensor {
            0 => x.clone(),
            1 => v.clone(),
            _ => {
                let mut row: Vec<f64> = x.iter().zip(v).map(|(x, v)| -WN * WN * x - 2.0 * ZETA * WN * v).collect();
                row[2 + k] += 1.0;
                row[CONSTANT] += recorded(k);
                row
            }
        }
    }

    fn cov(&self, a: &[f64], b: &[f64]) -> f64 {
        self.stds.iter().zip(a.iter().zip(b)).map(|(std, (a, b))| std * std * a * b).sum()
    }

    fn given(&self, wanted: &[f64], sensors: &[usize], last: usize) -> (f64, f64, f64) {
        let all: Vec<(usize, usize)> = (1..=last).flat_map(|k| sensors.iter().map(move |&s| (s, k))).collect();
        let rows: Vec<Vec<f64>> = all.iter().map(|&(s, k)| self.row(s, k)).collect();
        let noise = |i: usize, j: usize| if i == j { SENSORS[all[i].0].1.powi(2) } else { 0.0 };
        let cov = DMatrix::from_fn(all.len(), all.len(), |i, j| self.cov(&rows[i], &rows[j]) + noise(i, j));
        let errors = DVector::from_fn(all.len(), |i, _| reading(all[i].0, all[i].1) - rows[i][CONSTANT]);
        let cross = DVector::from_fn(all.len(), |i, _| self.cov(&rows[i], wanted));
        let gain = cov.clone().cholesky().unwrap().solve(&cross);
        let variance = self.cov(wanted, wanted) - gain.dot(&cross);
        (wanted[CONSTANT] + gain.dot(&errors), variance.max(0.0).sqrt(), log_normal(cov, &errors))
    }
}

fn scenario(kind: FilterKind, hold: Hold, sensors: &[usize]) -> Scenario {
    let filter = FilterSettings {
        id: 1,
        kind,
        augment: vec![Channel::WHITE_FORCE],
        ensemble_size: 4000,
        sensor_std: sensors.iter().map(|&sensor| SENSORS[sensor].1).collect(),
        initial_mean: values([0.0, 0.0, WN, ZETA]),
        initial_std: values([X0, V0, 0.0, 0.0]).with([(Channel::WHITE_FORCE, FORCE)]),
        process_std: Values::ZERO.with([(Channel::WHITE_FORCE, FORCE)]),
        ..FilterSettings::default()
    };
    let sensors = sensors.iter().map(|&s| Sensor::new(SENSORS[s].0, SENSORS[s].1)).collect();
    let duration = DT * (SAMPLES - 1) as f64;
    Scenario { dt: DT, duration, hold, sensors, filters: vec![filter], ..Scenario::default() }
}

fn run(scenario: &Scenario, sensors: &[usize]) -> Run {
    let columns = sensors.iter().map(|&s| (SENSORS[s].0, (0..SAMPLES).map(|k| reading(s, k)).collect()));
    let input = (0..SAMPLES).map(recorded).collect();
    run_on(scenario, forced(DT, scenario.hold, input, columns.collect()))
}

fn worst(estimates: &Estimates, course: &Course, sensors: &[usize], samples: &[usize], last: Option<usize>) -> f64 {
    let mut worst = 0.0_f64;
    for &k in samples {
        let mut force = vec![0.0; CONSTANT + 1];
        force[2 + k] = 1.0;
        let wanted = [(0, course.states[k][0].clone()), (1, course.states[k][1].clone()), (4, force)];
        for (place, row) in wanted {
            let (mean, std, _) = course.given(&row, sensors, last.unwrap_or(k));
            worst = worst.max((estimates.mean(k)[place] - mean).abs() / std);
            worst = worst.max((estimates.std(k, place) / std - 1.0).abs());
        }
    }
    worst
}

const SETS: [&[usize]; 4] = [&[0], &[1], &[2], &[0, 2]];

#[test]
fn filters_have_the_posterior_of_all_samples_at_once() {
    for hold in [Hold::Zero, Hold::First] {
        for sensors in SETS {
            let course = course(hold, sensors);
            for kind in FilterKind::ALL {
                let linearises = [FilterKind::KF, FilterKind::EKF, FilterKind::IEKF].contains(&kind);
                let most = if linearises { 1e-6 } else { 1e-3 };
                let run = run(&scenario(kind, hold, sensors), sensors);
                let estimates = &run.estimates()[0];
                if kind.is_sampled() {
                    let off = worst(estimates, &course, sensors, &[1, 2], None);
                    assert!(off < 0.2 || ![1, 2].contains(&sensors[0]), "{} {hold:?} {sensors:?}: {off}", kind.name());
                    continue;
                }
                let off = worst(estimates, &course, sensors, &[1, 2, 7, SAMPLES - 1], None);
                assert!(off < most, "{} {hold:?} {sensors:?}: {off}", kind.name());
                let sum: f64 = (1..SAMPLES).map(|k| estimates.log_likelihood(k)).sum();
                let density = course.given(&vec![0.0; CONSTANT + 1], sensors, SAMPLES - 1).2;
                assert!((sum - density).abs() < 100.0 * most, "{} {hold:?} {sensors:?}: {sum} {density}", kind.name());
            }
        }
    }
}

#[test]
fn the_smoother_has_the_posterior_given_all_readings() {
    for hold in [Hold::Zero, Hold::First] {
        for sensors in SETS {
            let course = course(hold, sensors);
            for (kind, most) in [(FilterKind::KF, 1e-6), (FilterKind::UKF, 1e-3), (FilterKind::SR_UKF, 1e-3)] {
                let mut scenario = scenario(kind, hold, sensors);
                scenario.filters[0].smoother = true;
                let smoothed = run(&scenario, sensors).smoothed().pop().unwrap();
                let off = worst(&smoothed, &course, sensors, &[1, 9, SAMPLES - 2], Some(SAMPLES - 1));
                assert!(off < most, "{} {hold:?} {sensors:?}: {off}", kind.name());
            }
        }
    }
}

#[test]
fn substeps_and_learning_of_q_leave_the_white_force_white() {
    for hold in [Hold::Zero, Hold::First] {
        let mut other = scenario(FilterKind::EKF, hold, &[0, 2]);
        let one = run(&other, &[0, 2]);
        other.filters[0].substeps = 3;
        let three = run(&other, &[0, 2]);
        let last = |run: &Run| (run.estimates()[0].mean(SAMPLES - 1).to_vec(), run.estimates()[0].std(SAMPLES - 1, 4));
        let ((a, a_std), (b, b_std)) = (last(&one), last(&three));
        assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-9 * (1.0 + a.abs())), "{a:?} {b:?}");
        assert!((a_std / b_std - 1.0).abs() < 1e-9);
        other.filters[0].adaptation.process_noise = true;
        let learnt = run(&other, &[0, 2]);
        assert!(learnt.estimates()[0].std(SAMPLES - 1, 4) <= FORCE);
    }
}

#[test]
fn a_simulated_disturbance_is_consistent_with_a_white_force_of_its_size() {
    let text = "duration = 40.0\n[plant]\nnatural_frequency = 6.0\ndisturbance_std = 2.0\n[force]\nwhite_noise = { std = 0.0 }\n\
                [[sensors]]\nmeasures = \"acceleration\"\nnoise_std = 0.1\n[[filters]]\nkind = \"ekf\"\naugment = [\"white_force\"]\n\
                [filters.initial_mean]\nnatural_frequency = 6.3\ndamping_ratio = 0.05\n\
                [filters.initial_std]\nnatural_frequency = 0.3\ndamping_ratio = 0.02\n";
    let (mut nis, mut miss) = (0.0, 0.0_f64);
    const SEEDS: u64 = 10;
    for seed in 0..SEEDS {
        let mut scenario = Scenario::from_toml(text).unwrap();
        scenario.seed = seed;
        let filter = &scenario.filters[0];
        let (sensor_std, process_std) = scenario.true_noise_for(filter);
        assert_eq!((sensor_std[0], process_std[Channel::WHITE_FORCE], process_std[Channel::VELOCITY]), (0.1, 2.0, 0.0));
        (scenario.filters[0].sensor_std, scenario.filters[0].process_std) = (sensor_std, process_std);
        let estimates = &finished(&scenario).estimates()[0].clone();
        let last = estimates.len() - 1;
        nis += mean(&estimates.nis()[1..]) / SEEDS as f64;
        miss += ((estimates.mean(last)[2] - 6.0) / estimates.std(last, 2)).powi(2) / SEEDS as f64;
    }
    assert!((nis - 1.0).abs() < 0.05, "{nis}");
    assert!(miss < 2.5, "{miss}");
}

const TIME_STEP: f64 = 0.01;
const LENGTH: usize = 4000;

/// The record of an oscillator with 6 rad/s and 5 %: of the force on it, `acts` is not recorded.
fn record(random: &mut Random, mut acts: impl FnMut(usize, &mut Random) -> f64) -> Record {
    let told: Vec<f64> = (0..LENGTH).map(|_| 4.0 * random.normal()).collect();
    let force: Vec<f64> = told.iter().enumerate().map(|(k, told)| told + acts(k, random)).collect();
    let motion = motion([WN, ZETA], TIME_STEP, Hold::Zero, &force, [0.0; 2]);
    let measured = motion.iter().map(|[x, ..]| x + 0.003 * random.normal()).collect();
    forced(TIME_STEP, Hold::Zero, told, vec![(Quantity::DISPLACEMENT, measured)])
}

fn inside(
    filters: &str,
    seeds: u64,
    acts: impl Fn(&mut Random) -> Box<dyn FnMut(usize, &mut Random) -> f64>,
) -> Vec<u32> {
    let text = format!("dt = 0.01\n[[sensors]]\nmeasures = \"displacement\"\nnoise_std = 0.003\n{filters}");
    let scenario = Scenario::from_toml(&text).unwrap();
    let mut inside = vec![0; scenario.filters.len()];
    for seed in 0..seeds {
        let mut random = Random::new(seed);
        let force = acts(&mut random);
        let run = finished_on(&scenario, record(&mut random, force));
        for (estimates, inside) in run.estimates().iter().zip(&mut inside) {
            assert_eq!(estimates.stop(), None, "seed {seed}");
            for (channel, truth) in [(Channel::NATURAL_FREQUENCY, 6.0), (Channel::DAMPING_RATIO, 0.05)] {
                let (mean, std) = last(estimates, channel);
                *inside += u32::from((mean - truth).abs() < 2.0 * std);
            }
        }
    }
    inside
}

const PLAIN: &str = "[[filters]]\nkind = \"ukf\"\n\
                     process_std = { natural_frequency = 0, damping_ratio = 0, displacement = 0, velocity = 1e-4 }\n";

#[test]
fn a_gauss_markov_force_has_its_memory_in_the_equation() {
    let (rate, std) = (2.0_f64, 1.5);
    let keep = (-rate * TIME_STEP).exp();
    let step = std * (1.0 - keep * keep).sqrt();
    let told = format!(
        "[[filters]]\nkind = \"ukf\"\nplant = {{ equation = \"x'' + 2 ζ ωₙ x' + ωₙ² x = f + u; u' = -2 u\" }}\n\
         initial_std = {{ u = {std} }}\n\
         process_std = {{ natural_frequency = 0, damping_ratio = 0, displacement = 0, velocity = 1e-4, u = {step} }}\n"
    );
    let counts = inside(&format!("{PLAIN}{told}"), 16, |random| {
        let mut force = std * random.normal();
        Box::new(move |_, random| {
            let now = force;
            force = keep * force + step * random.normal();
            now
        })
    });
    assert!(counts[0] < 12 && counts[1] >= 27, "{counts:?} of 32 bands");
}

#[test]
fn a_sine_of_unknown_frequency_is_an_oscillator_in_the_equation() {
    let told = "[[filters]]\nkind = \"ukf\"\n\
                plant = { equation = \"x'' + 2 ζ ωₙ x' + ωₙ² x = f + u; u' = s; s' = -w² u\" }\n\
                initial_mean = { w = 10.0 }\ninitial_std = { u = 3.0, s = 30.0, w = 1.0 }\n\
                process_std = { natural_frequency = 0, damping_ratio = 0, displacement = 0, velocity = 1e-4, u = 0, s = 0, w = 0 }\n";
    let counts = inside(&format!("{PLAIN}{told}"), 16, |random| {
        let (frequency, phase) = (9.0 + 2.0 * random.uniform(), std::f64::consts::TAU * random.uniform());
        Box::new(move |k, _| 3.0 * (frequency * TIME_STEP * k as f64 + phase).sin())
    });
    assert!(counts[0] < 12 && counts[1] >= 27, "{counts:?} of 32 bands");
}
