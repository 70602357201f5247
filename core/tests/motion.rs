//! Filters of plants that are not linear in their motion are not biased by the way that their means move.
//! Predictions may be divided into several steps.

use std::sync::Arc;

use kalmanscope_core::{Channel, FilterSettings, Hold, InputKind, PlantKind, Propagation, Record, Scenario};

use crate::numbers::{Random, farthest, rms};
use crate::run::{finished, finished_on, forced, plants, truth};

/// An equation and its true parameters; the time of a swing \[s\] and the size of its motion \[m\]; the standard deviation of the force
/// \[m/s²\] and the displacement at the beginning \[m\].
type Case = (&'static str, &'static [(&'static str, f64)], f64, f64, f64, f64);

const CASES: [Case; 13] = [
    ("x'' - a x' + b x'^3 + k x = f", &[("a", 0.4), ("b", 0.1), ("k", 9.0)], 2.1, 0.7, 6.0, 0.5),
    ("x'' + d x' - a x + b x^3 = f", &[("d", 0.25), ("a", 4.0), ("b", 4.0)], 2.2, 1.2, 8.0, 1.0),
    ("x'' + c x' + k x - q x^5 + 0.3 x^7 = f", &[("c", 0.3), ("k", 16.0), ("q", 2.0)], 1.6, 0.5, 6.0, 0.8),
    ("x'' + c x' + r tanh(x'/0.3) + k x = f", &[("c", 0.2), ("r", 2.0), ("k", 25.0)], 1.26, 0.6, 15.0, 0.5),
    ("x'' + c x' + d (1 - exp(-a x)) exp(-a x) = f", &[("c", 0.3), ("d", 20.0), ("a", 0.8)], 1.7, 0.3, 2.5, 0.3),
    (
        "x1'' + c x1' + k x1 + g (x1 - x2)^3 = f; x2'' + c x2' + 2 x2 - g (x1 - x2)^3 = 0",
        &[("c", 0.2), ("k", 9.0), ("g", 5.0)],
        2.0,
        0.8,
        6.0,
        0.5,
    ),
    ("x'' + c x' abs(x') + w sin(x) = f", &[("c", 0.1), ("w", 9.81)], 2.2, 0.7, 3.0, 1.2),
    ("x'' - m (1 - x^2) x' + k x = f", &[("m", 1.0), ("k", 6.0)], 2.6, 1.4, 3.0, 1.0),
    ("x'' + c x' log(2 + abs(x')) + k x + b x^3 = f", &[("c", 0.3), ("k", 10.0), ("b", 4.0)], 1.7, 0.8, 10.0, 1.0),
    (
        "x'' + k x + b x^3 + g z = f; z' = x' - r z",
        &[("k", 12.0), ("b", 5.0), ("g", 4.0), ("r", 2.0)],
        1.5,
        0.6,
        8.0,
        0.5,
    ),
    ("x'' + c x' + a (exp(b x) - 1) = f", &[("c", 0.3), ("a", 8.0), ("b", 1.2)], 2.0, 1.0, 8.0, 0.5),
    ("x'' + c x' + k x + b x^3 = f", &[("c", 0.24), ("k", 36.0), ("b", 10.0)], 1.05, 0.4, 10.0, 0.2),
    ("x'' + c x' + b x^3 = f", &[("c", 0.3), ("b", 20.0)], 1.6, 0.7, 10.0, 1.0),
];

const SPREAD: f64 = 0.05;

fn scenario(case: &Case, kinds: &[&str], samples: f64, noise: f64, length: usize, seed: u64) -> Scenario {
    let (equation, truth, swing, size, force, begin) = case;
    let (dt, noise) = (swing / samples, noise * size);
    let mut random = Random::new(seed);
    let each = |of: &mut dyn FnMut(f64) -> f64| -> String {
        truth.iter().map(|(name, value)| format!("{name} = {:e}\n", of(*value))).collect()
    };
    let masses: &[&str] = if equation.contains("x2") { &["", "_2"] } else { &[""] };
    let motion = |first: f64, others: f64| -> String {
        let of_mass = |(place, mass): (usize, &&str)| {
            let displacement = if place == 0 { first } else { others };
            format!("displacement{mass} = {displacement:e}\nvelocity{mass} = {others:e}\n")
        };
        let internal = if equation.contains("z'") { format!("z = {others:e}\n") } else { String::new() };
        masses.iter().enumerate().map(of_mass).collect::<String>() + &internal
    };
    let sensor = |mass: &&str| format!("[[sensors]]\nmeasures = \"displacement{mass}\"\nnoise_std = {noise:e}\n");
    let sensors: String = masses.iter().map(sensor).collect();
    let belief = format!(
        "[filters.initial_mean]\n{}{}[filters.initial_std]\n{}{}[filters.process_std]\n{}{}",
        each(&mut |value| value * (1.0 + SPREAD * random.normal())),
        motion(*begin, 0.0),
        each(&mut |value| value * SPREAD),
        motion(noise, noise),
        each(&mut |_| 0.0),
        motion(1e-7 * size, 1e-7 * size)
    );
    let filters: String = kinds.iter().map(|kind| format!("[[filters]]\nkind = \"{kind}\"\n{belief}")).collect();
    let text = format!(
        "seed = {seed}\ndt = {dt:e}\nduration = {:e}\n[force.white_noise]\nstd = {force:e}\n[plant]\nequation = \"{equation}\"\n{}\
         initial = {{ displacement = {begin:e}, velocity = 0.0 }}\n{sensors}{filters}",
        dt * length as f64,
        each(&mut |value| value),
    );
    Scenario::from_toml(&text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn hold(name: &str, scenarios: impl Iterator<Item = Scenario>) {
    let mut errors: Vec<Vec<f64>> = Vec::new();
    for scenario in scenarios {
        let run = finished(&scenario);
        let (last, record) = (run.samples() - 1, run.record());
        assert_eq!(record.len(), run.samples(), "{name}");
        errors.resize(run.estimates().len(), Vec::new());
        for (estimates, errors) in run.estimates().iter().zip(&mut errors) {
            assert_eq!((estimates.stop(), estimates.len()), (None, last + 1), "{name}");
            let parameters = estimates.channels().iter().enumerate().filter(|(_, channel)| channel.is_parameter());
            let error = |(place, channel)| {
                (estimates.mean(last)[place] - truth(record, channel)[last]) / estimates.std(last, place)
            };
            errors.extend(parameters.map(|(place, channel)| error((place, *channel))));
        }
    }
    let rms: Vec<f64> = errors.iter().map(|errors| rms(errors)).collect();
    assert!(rms.iter().all(|rms| (0.8..1.25).contains(rms)), "{name}: rms of error over σ {rms:.2?}");
}

#[test]
fn errors_of_equations_are_as_large_as_their_bands_say() {
    for case in &CASES {
        // A Duffing oscillator.
        let kinds = if case.0.contains("k x + b x^3 = f") { &["ekf", "ukf", "iekf"][..] } else { &["ekf", "ukf"] };
        let drawn = |seed: u64| {
            // From 20 to 120 samples a swing, with noise from 0.2 to 1 % of the motion.
            let share = (seed % 8) as f64 / 7.0;
            let (samples, noise) = (20.0 * 6.0_f64.powf(share), 0.01 * 0.2_f64.powf(((3 * seed) % 8) as f64 / 7.0));
            scenario(case, kinds, samples, noise, 500, 9000 + 31 * seed)
        };
        hold(case.0, (0..40).map(drawn));
    }
}

#[test]
fn the_plant_says_how_the_mean_moves() {
    let linear = PlantKind::SDOF;
    let steps = |filter: &FilterSettings, plant: &PlantKind| filter.steps(plant, InputKind::Force, 0.02);
    let usual = FilterSettings::default();
    for plant in plants() {
        let expected = if plant.info().is_linear { Propagation::LocalLinearisation } else { Propagation::RungeKutta };
        assert_eq!(usual.propagation_for(&plant), expected, "{plant:?}");
        assert_eq!(steps(&usual, &plant) == 1, plant.info().is_linear, "{plant:?}");
    }
    // A filter moves as its own plant does.
    let own = FilterSettings { plant: Some(PlantKind::DUFFING), ..usual.clone() };
    assert_eq!(own.propagation_for(&linear), Propagation::RungeKutta);
    // A setting wins over the automatic number, and the textbook's steps are single ones.
    let set = FilterSettings { substeps: 3, ..usual.clone() };
    assert_eq!([steps(&set, &linear), steps(&set, &PlantKind::DUFFING)], [3, 3]);
    let local = Propagation::LocalLinearisation;
    let book = FilterSettings { propagation: Some(local), ..usual.clone() };
    assert_eq!((book.propagation_for(&PlantKind::DUFFING), steps(&book, &PlantKind::DUFFING)), (local, 1));
    // A stiffer spring and a longer step ask for more.
    let mut stiff = usual.clone();
    stiff.initial_mean[Channel::NATURAL_FREQUENCY] = 30.0;
    assert!(steps(&stiff, &PlantKind::DUFFING) > 2 * steps(&usual, &PlantKind::DUFFING));
    assert!(usual.steps(&PlantKind::DUFFING, InputKind::Force, 0.1) > steps(&usual, &PlantKind::DUFFING));
}

const STEPS: usize = 4;

fn divided(kind: &str, substeps: usize) -> Scenario {
    let text = format!(
        "duration = 8.0\ndt = 0.08\nhold = \"first\"\n[plant]\nkind = \"duffing\"\nnatural_frequency = 6.0\n\
         [[sensors]]\nmeasures = \"displacement\"\nnoise_std = 0.01\n[[filters]]\nkind = \"{kind}\"\nsmoother = true\n\
         substeps = {substeps}\n[filters.process_std]\ndisplacement = 0.0\nvelocity = 0.0\nnatural_frequency = 0.0\n\
         damping_ratio = 0.0\ncubic_stiffness = 0.0\n"
    );
    Scenario::from_toml(&text).unwrap()
}

fn finer(record: &Record) -> Record {
    let n = (record.len() - 1) * STEPS + 1;
    let input = record.input();
    let between = |k: usize| {
        let (place, share) = (k / STEPS, (k % STEPS) as f64 / STEPS as f64);
        input[place] + share * (input[(place + 1).min(input.len() - 1)] - input[place])
    };
    let values = (0..n).map(between).collect();
    let measured = |k: usize| if k.is_multiple_of(STEPS) { record.measured(0)[k / STEPS] } else { f64::NAN };
    let columns = vec![(record.sensors()[0], (0..n).map(measured).collect())];
    forced(record.dt() / STEPS as f64, Hold::First, values, columns)
}

#[test]
fn substeps_are_those_of_a_finer_record() {
    for kind in ["ekf", "ukf", "sr_ukf"] {
        let coarse = divided(kind, STEPS);
        let run = finished(&coarse);
        let fine = finished_on(&divided(kind, 1), Arc::new(finer(run.record())));
        let pairs = [(&run.estimates()[0], &fine.estimates()[0]), (&run.smoothed()[0], &fine.smoothed()[0])];
        for (which, (coarse, fine)) in pairs.into_iter().enumerate() {
            let far = farthest(coarse, fine, STEPS);
            assert!(far < 1e-6, "{kind}, {which}: {far}");
        }
    }
}
