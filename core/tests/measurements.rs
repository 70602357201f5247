//! Measurements that take minutes, of start values and of the largest filters.
//!
//! ```text
//! cargo bench -p kalmanscope-core --bench measurements -- grid|losses|decays|ambient|largest
//! ```
#![expect(clippy::unwrap_used, reason = "a helper that fails is a measurement that fails")]

use std::time::Instant;

use kalmanscope_core::{FilterKind, Hold, PlantKind, Quantity, Run, Scenario};
use kalmanscope_diagnosis::VerdictKind;

use ambient::{Accelerometer, End, SETS, building, end, mass};
use start_values::{Excitation, SENSORS, grid, right, shares, worst_of_losses};

#[path = "common/ambient.rs"]
mod ambient;
#[path = "common/numbers.rs"]
#[expect(dead_code, reason = "tests need more of it")]
mod numbers;
#[path = "common/run.rs"]
#[expect(dead_code, reason = "tests need more of it")]
mod run;
#[path = "common/start_values.rs"]
#[expect(dead_code, reason = "tests need more of it")]
mod start_values;

fn main() {
    let all: [(&str, fn()); 5] = [
        ("grid", print_grid),
        ("losses", print_losses),
        ("decays", print_decays),
        ("ambient", print_ambient),
        ("largest", print_largest),
    ];
    let wanted: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    for (name, print) in all.iter().filter(|(name, _)| wanted.iter().any(|word| word == name)) {
        println!("== {name}");
        print();
    }
    if wanted.is_empty() {
        println!("one or more of: {}", all.map(|(name, _)| name).join(" "));
    }
}

fn print_grid() {
    let (all, parts) = grid(400..410, &[(9.0, 200.0), (2.3, 50.0), (35.0, 750.0)], true);
    for (name, counts) in parts.into_iter().chain([("all".to_owned(), all)]) {
        let [right, ends] = shares(counts);
        println!("{name}: {right:.1} % of the guesses and {ends:.1} % of the ends of {} are right", counts[2]);
    }
}

fn print_losses() {
    for excitation in Excitation::ALL {
        for sensor in SENSORS {
            let all =
                (200..204).map(|seed| worst_of_losses(sensor, excitation, [0.005, 0.02, 0.1][seed as usize % 3], seed));
            let worst = all.max_by(|a, b| a.0.total_cmp(&b.0)).expect("there are four");
            println!("{excitation:?} {}: {:.1} %, {}", sensor.key(), 100.0 * worst.0, worst.1);
        }
    }
}

fn print_decays() {
    println!("{:.1} % of the start values are right", 100.0 * right(5000..5600));
}

fn print_ambient() {
    use Accelerometer::{BandLimited, Filtered, Held, Instant, Mean};
    for rate in [20.0, 50.0] {
        for sensors in SETS {
            let all = [Mean, BandLimited, Filtered, Instant, Held];
            let kinds = if sensors.contains(&Quantity::ACCELERATION) { &all[..] } else { &all[..1] };
            for &kind in kinds {
                let ends: Vec<End> = (1300..1306).map(|seed| end(&building(rate, sensors, kind, seed), 0)).collect();
                let names: Vec<&str> = sensors.iter().map(|sensor| sensor.key()).collect();
                report(&format!("{rate} Hz {} {kind:?}", names.join("+")), &ends);
            }
        }
    }
    for rate in [20.0, 50.0] {
        for kind in [Mean, BandLimited, Filtered, Instant] {
            let ends: Vec<End> = (1350..1354).map(|seed| end(&building(rate, SETS[3], kind, seed), 0)).collect();
            report(&format!("{rate} Hz displacement+acceleration {kind:?}"), &ends);
        }
    }
    for kind in [Mean, BandLimited, Filtered, Instant] {
        for rate in [50.0, 100.0] {
            let ends: Vec<End> = (1300..1308).map(|seed| end(&mass(kind, rate, seed), 0)).collect();
            report(&format!("3.1 Hz, {rate} Hz, {kind:?}"), &ends);
        }
    }
}

fn report(name: &str, ends: &[End]) {
    let n = ends.len() as f64;
    let rms = |of: &dyn Fn(&End) -> f64| (ends.iter().map(|end| of(end).powi(2)).sum::<f64>() / n).sqrt();
    let mean = |of: &dyn Fn(&End) -> f64| ends.iter().map(of).sum::<f64>() / n;
    let good = ends.iter().filter(|end| end.verdict == VerdictKind::Consistent).count();
    println!(
        "{name}: guess rms {:.2} % {:.0} %; end mean {:+.2} % {:+.1} %, rms {:.2} % {:.1} %, in σ {:.1} {:.1}, within 0.5 %/20 %: {}, \
         consistent {good} of {n}",
        100.0 * rms(&|end| end.guess[0]),
        100.0 * rms(&|end| end.guess[1]),
        100.0 * mean(&|end| end.errors[0]),
        100.0 * mean(&|end| end.errors[1]),
        100.0 * rms(&|end| end.errors[0]),
        100.0 * rms(&|end| end.errors[1]),
        rms(&|end| end.sigmas[0]),
        rms(&|end| end.sigmas[1]),
        ends.iter().filter(|end| end.errors[0].abs() < 0.005 && end.errors[1].abs() < 0.2).count(),
    );
    let count = |of: &dyn Fn(&End) -> bool| ends.iter().filter(|end| of(end)).count();
    let (low_pass, white) = (count(&|end| end.reasons.contains("low-pass")), count(&|end| end.is_white));
    println!("    a low pass is said of {low_pass} of {n}, a white force is taken for {white}");
    ends.iter().take(2).for_each(|end| println!("    {}", end.text));
}

fn print_largest() {
    let largest = |kind, plant, substeps, hold| {
        let mut scenario = Scenario { duration: 1.0, hold, ..run::one_filter(kind) };
        scenario.filters[0].ensemble_size = 100_000;
        scenario.set_plant(plant);
        scenario.filters[0].substeps = substeps;
        scenario
    };
    let mut iterated = largest(FilterKind::IEKF, PlantKind::SHEAR_10, 100, Hold::First);
    iterated.filters[0].iterations = 100;
    let cases = [
        largest(FilterKind::PF, PlantKind::SDOF, 1, Hold::Zero),
        largest(FilterKind::ENKF, PlantKind::SDOF, 1, Hold::Zero),
        largest(FilterKind::PF, PlantKind::SDOF, 1, Hold::First),
        largest(FilterKind::ENKF, PlantKind::SDOF, 1, Hold::First),
        largest(FilterKind::PF, PlantKind::SDOF, 4, Hold::Zero),
        largest(FilterKind::PF, PlantKind::BOUC_WEN, 1, Hold::Zero),
        largest(FilterKind::PF, PlantKind::SHEAR_2, 1, Hold::Zero),
        largest(FilterKind::PF, PlantKind::SHEAR_10, 1, Hold::Zero),
        largest(FilterKind::ENKF, PlantKind::SHEAR_10, 1, Hold::Zero),
        largest(FilterKind::UKF, PlantKind::SHEAR_10, 100, Hold::Zero),
        iterated,
    ];
    for scenario in cases {
        let filter = &scenario.filters[0];
        let (plant, substeps) = (&scenario.plant.kind, filter.substeps);
        let begin = Instant::now();
        let Ok(mut run) = Run::new(&scenario) else {
            println!("{} {} {substeps}: refused", filter.kind.name(), plant.key());
            continue;
        };
        run.advance_to(1);
        let first = begin.elapsed();
        let begin = Instant::now();
        run.advance_to(4);
        let (name, step) = (filter.kind.name(), begin.elapsed() / 3);
        let estimated = 1e-6 * filter.time_of_step(&scenario);
        println!(
            "{name} {} {substeps} {:?}: first {first:.0?}, then {step:.0?}, estimated {estimated:.0} ms",
            plant.key(),
            scenario.hold
        );
    }
}
