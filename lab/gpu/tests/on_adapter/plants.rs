//! Maps of any plant by the graphics processor have the classes and, where filters converge, the scores of the processor's.

use std::path::Path;
use std::time::Instant;

use crate::common::gpu;
use crate::tally::Tally;
use kalmanscope_core::score::Outcome;
use kalmanscope_core::simulate;
use kalmanscope_core::{Channel, FilterKind, FilterSettings, Hold, PlantKind, Propagation, Quantity, Scenario, Signal};
use kalmanscope_gpu::{GpuRun, serves};

/// The filters of an ensemble: not a whole number of groups of threads.
const FILTERS: usize = 70;

/// Scenarios with filters that differ by their guesses of the parameters.
fn guesses(mut scenario: Scenario, kind: FilterKind) -> Vec<Scenario> {
    scenario.filters.truncate(1);
    scenario.filters[0].kind = kind;
    let guess = |nth: usize| {
        let mut scenario = scenario.clone();
        for (at, channel) in scenario.plant.kind.parameters().enumerate() {
            let turn = (nth * (2 * at + 1) % FILTERS) as f64 / FILTERS as f64;
            scenario.filters[0].initial_mean[channel] *= 0.6 + 0.8 * turn;
        }
        scenario
    };
    (0..FILTERS).map(guess).collect()
}

/// Compares the filters of scenarios over their record, which is that of the first.
fn tally(name: &str, scenarios: &[Scenario]) -> Tally {
    let record = simulate(&scenarios[0]);
    let run = |scenario| GpuRun { scenario, place: 0, record: &record };
    let runs: Vec<GpuRun<'_>> = scenarios.iter().map(run).collect();
    assert!(serves(&runs[0]), "{name}");
    let begin = Instant::now();
    let outcomes = pollster::block_on(gpu().outcomes(&runs, &|| true)).unwrap();
    let time = begin.elapsed();
    let mut tally = Tally::default();
    for (scenario, outcome) in scenarios.iter().zip(&outcomes) {
        let class = |outcome: &Outcome| (outcome.stop.is_some(), outcome.diverged);
        let exact = Outcome::of(scenario, 0, &record).unwrap();
        tally.take([outcome.as_ref().unwrap(), &exact], class, |class| class == (false, false));
    }
    let Tally { runs, same, kept, close, worst: (worst, score) } = &tally;
    println!(
        "{name}: of {runs} runs {same} of the same class; of {kept} kept {close} close, the worst by {worst:.1e}: {score}; {time:.1?}"
    );
    tally
}

/// Most runs are of the same class, and most of those that are kept are close.
fn check(name: &str, scenarios: &[Scenario]) {
    let Tally { runs, same, kept, close, .. } = tally(name, scenarios);
    assert!(same as f64 >= 0.96 * runs as f64, "{name}: {same} of {runs}");
    assert!(kept * 3 > runs && close as f64 >= 0.9 * kept as f64, "{name}: {close} of {kept}");
}

/// A built-in plant that is shaken, with sensors of these quantities.
fn built_in(plant: PlantKind, quantities: &[Quantity], augment: &[Channel], hold: Hold) -> Scenario {
    let filters = vec![FilterSettings::default()];
    let mut scenario = Scenario { filters, hold, duration: 10.0, ..Scenario::default() };
    scenario.filters[0].augment = augment.to_vec();
    scenario.set_plant(plant);
    scenario.set_sensors(quantities);
    for &channel in augment {
        scenario.plant.set(channel, Signal::Constant(channel.usual().mean + 0.2 * channel.usual().std));
    }
    scenario
}

const KINDS: [FilterKind; 2] = [FilterKind::EKF, FilterKind::UKF];

#[test]
fn built_in_plants_have_the_scores_of_the_processor() {
    for plant in [PlantKind::DUFFING, PlantKind::BOUC_WEN, PlantKind::SHEAR_2] {
        for kind in KINDS {
            let name = format!("{plant:?}, {kind:?}");
            let quantities: Vec<Quantity> = plant.quantities().take(2).collect();
            check(&name, &guesses(built_in(plant, &quantities, &[], Hold::Zero), kind));
        }
    }
}

#[test]
fn equations_have_the_scores_of_the_processor() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/equations");
    for equation in ["pendulum", "dry-friction", "helmholtz"] {
        for kind in KINDS {
            let text = std::fs::read_to_string(folder.join(equation).with_extension("toml")).unwrap();
            let scenario = Scenario { duration: 10.0, ..Scenario::from_toml(&text).unwrap() };
            let name = format!("{equation}, {kind:?}");
            check(&name, &guesses(scenario, kind));
        }
    }
}

/// An input that is linear between samples, with a gain, an offset and a bias of a sensor, accelerations, and a CKF.
#[test]
fn surroundings_of_a_plant_are_served() {
    let quantities: Vec<Quantity> = vec![Quantity::DISPLACEMENT, Quantity::ACCELERATION];
    let augment = [Channel::INPUT_GAIN, Channel::INPUT_OFFSET, quantities[1].bias()];
    for (kind, propagation) in [
        (FilterKind::EKF, Propagation::LocalLinearisation),
        (FilterKind::EKF, Propagation::RungeKutta),
        (FilterKind::UKF, Propagation::LocalLinearisation),
        (FilterKind::CKF, Propagation::LocalLinearisation),
    ] {
        let mut scenarios = guesses(built_in(PlantKind::SDOF, &quantities, &augment, Hold::First), kind);
        scenarios.iter_mut().for_each(|scenario| scenario.filters[0].propagation = Some(propagation));
        let name = format!("surroundings, {kind:?}, {propagation:?}");
        check(&name, &scenarios);
    }
}

/// A force that is another one at each sample, or in the middle between samples.
#[test]
fn white_forces_are_served() {
    for (kind, hold) in [(FilterKind::EKF, Hold::First), (FilterKind::UKF, Hold::Zero)] {
        let quantities = [Quantity::DISPLACEMENT, Quantity::ACCELERATION];
        let mut scenarios = guesses(built_in(PlantKind::SDOF, &quantities, &[], hold), kind);
        for Scenario { filters, .. } in &mut scenarios {
            filters[0].augment.push(Channel::WHITE_FORCE);
            filters[0].process_std[Channel::WHITE_FORCE] = 0.3;
            filters[0].initial_std[Channel::WHITE_FORCE] = 0.3;
        }
        let name = format!("white force, {kind:?}, {hold:?}");
        check(&name, &scenarios);
    }
}

/// Guesses from which many filters lose the truth.
#[test]
fn filters_that_are_lost_are_lost_on_both() {
    for kind in KINDS {
        let mut scenarios = guesses(built_in(PlantKind::DUFFING, &[Quantity::DISPLACEMENT], &[], Hold::Zero), kind);
        for (nth, scenario) in scenarios.iter_mut().enumerate() {
            scenario.filters[0].initial_mean[Channel::NATURAL_FREQUENCY] *= 0.1 + nth as f64 * 0.1;
        }
        let Tally { runs, same, kept, .. } = tally(&format!("lost, {kind:?}"), &scenarios);
        assert!(same as f64 >= 0.9 * runs as f64, "{kind:?}: {same} of {runs}");
        assert!(same - kept >= runs / 10, "{kind:?}: {} lost", same - kept);
    }
}

/// Parts of a step, and parameters that decay.
#[test]
fn settings_of_a_filter_are_served() {
    for kind in KINDS {
        let mut scenarios = guesses(built_in(PlantKind::DUFFING, &[Quantity::DISPLACEMENT], &[], Hold::Zero), kind);
        for scenario in &mut scenarios {
            (scenario.filters[0].substeps, scenario.filters[0].eta) = (2, 1e-3);
        }
        let name = format!("parts and decay, {kind:?}");
        check(&name, &scenarios);
    }
}
