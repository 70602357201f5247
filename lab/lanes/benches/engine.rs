//! Nanoseconds per step and run of filters that the engine takes side by side, beside the single filter without history, in
//! one run.
//!
//! ```text
//! cargo bench -p kalmanscope-lanes --bench engine -- [PART OF A CASE'S NAME]
//! ```
//!
//! Measurements take turns, and the least of many counts: whatever else the machine does only adds.

use std::hint::black_box;
use std::time::Instant;

use kalmanscope_core::filter::{Adaptation, Robust};
use kalmanscope_core::score::Outcome;
use kalmanscope_core::{Channel, FilterKind, FilterSettings, Hold, PlantKind, Scenario, simulate};
use kalmanscope_lanes::{InstructionSet, LaneRun, outcomes, serves};

/// Runs side by side, samples of a record, and measurements of each number.
const RUNS: usize = 8;
const SAMPLES: usize = 2001;
const REPEATS: usize = 40;

fn main() {
    println!("{:<44}{:>5}{:>10}{:>10}{:>10}{:>8}", "case", "n", "single", "SSE2", "AVX2", "ratio");
    let gain: &[Channel] = &[Channel::INPUT_GAIN];
    let all: &[Channel] = &[Channel::INPUT_GAIN, Channel::INPUT_OFFSET, Channel::UNKNOWN_FORCE];
    for kind in [FilterKind::EKF, FilterKind::UKF] {
        for (plant, augment, hold) in [
            (PlantKind::SDOF, &[][..], Hold::Zero),
            (PlantKind::DUFFING, &[], Hold::Zero),
            (PlantKind::SDOF, gain, Hold::First),
            (PlantKind::SDOF, all, Hold::Zero),
            (PlantKind::DUFFING, gain, Hold::First),
            (PlantKind::BOUC_WEN, &[], Hold::Zero),
            (PlantKind::BOUC_WEN, gain, Hold::First),
            (PlantKind::SHEAR_2, &[], Hold::Zero),
            (PlantKind::SHEAR_2, gain, Hold::First),
            (PlantKind::SHEAR_3, &[], Hold::Zero),
            (PlantKind::SHEAR_4, &[], Hold::Zero),
            (PlantKind::SHEAR_5, &[], Hold::Zero),
            (PlantKind::SHEAR_5, &[], Hold::First),
            (PlantKind::SHEAR_10, &[], Hold::Zero),
            (PlantKind::SHEAR_10, &[], Hold::First),
        ] {
            measure(kind, plant, augment, hold, "", |_| ());
        }
        let learns = |settings: &mut FilterSettings, sensor_noise, process_noise| {
            settings.adaptation = Adaptation { sensor_noise, process_noise, ..settings.adaptation };
        };
        for (plant, augment, hold) in [(PlantKind::SDOF, &[][..], Hold::Zero), (PlantKind::SDOF, gain, Hold::First)] {
            for rule in &Robust::ALL[1..] {
                measure(kind, plant.clone(), augment, hold, rule.info().key, |settings| settings.robust = *rule);
            }
            measure(kind, plant.clone(), augment, hold, "learns R", |settings| learns(settings, true, false));
            measure(kind, plant.clone(), augment, hold, "learns Q", |settings| learns(settings, false, true));
            measure(kind, plant.clone(), augment, hold, "jumps", |settings| settings.jump = true);
            measure(kind, plant, augment, hold, "logarithms", |settings| settings.log_parameters = true);
        }
    }
}

fn measure(
    kind: FilterKind,
    plant: PlantKind,
    augment: &[Channel],
    hold: Hold,
    what: &str,
    change: impl Fn(&mut FilterSettings),
) {
    let n = plant.channels().len() + augment.len();
    let keys: Vec<&str> = augment.iter().map(|channel| channel.key()).collect();
    let case = format!("{} {} {:?} {} {what}", kind.name(), plant.key(), hold, keys.join(" "));
    let wanted = std::env::args().skip(1).find(|argument| !argument.starts_with('-')).unwrap_or_default();
    if !case.contains(&wanted) {
        return;
    }
    let mut base = Scenario { duration: (SAMPLES - 1) as f64 * 0.01, hold, ..Scenario::default() };
    base.filters.truncate(1);
    base.filters[0].kind = kind;
    base.filters[0].augment = augment.to_vec();
    base.set_plant(plant);
    change(&mut base.filters[0]);
    let record = simulate(&base).without_truth();
    let guess = |i: usize| {
        let mut scenario = base.clone();
        for channel in [Channel::NATURAL_FREQUENCY, Channel::stiffness(0)] {
            scenario.filters[0].initial_mean[channel] *= 0.9 + 0.02 * i as f64;
        }
        scenario
    };
    let scenarios: Vec<Scenario> = (0..RUNS).map(guess).collect();
    let runs: Vec<LaneRun<'_>> =
        scenarios.iter().map(|scenario| LaneRun { scenario, place: 0, record: &record }).collect();
    let is_served = runs.iter().all(|run| serves(run).is_ok_and(|is_served| is_served));
    let mut least = [f64::INFINITY; 3];
    for repeat in 0..REPEATS {
        let one = &runs[repeat % RUNS];
        least[0] = least[0].min(time(|| Outcome::at(one.scenario, one.place, one.record, &[])));
        for (least, level) in least[1..].iter_mut().zip([InstructionSet::Baseline, InstructionSet::Avx2]) {
            *least = least.min(time(|| outcomes(level, &runs, &[])) / RUNS as f64);
        }
    }
    let [single, baseline, avx2] = least.map(|time| time / SAMPLES as f64);
    if !is_served {
        println!("{case:<44}{n:>5}{single:>10.0}{:>28}", "by itself");
        return;
    }
    println!("{case:<44}{n:>5}{single:>10.0}{baseline:>10.0}{avx2:>10.0}{:>8.1}", single / avx2);
}

fn time<R>(work: impl FnOnce() -> R) -> f64 {
    let start = Instant::now();
    black_box(work());
    start.elapsed().as_secs_f64() * 1e9
}
