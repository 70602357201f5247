//! How long a sample of the largest filters takes.

use std::time::Instant;

use kalmanscope_core::{FilterKind, Hold, PlantKind, Run, Scenario};

/// Prints the times beside those that the core expects.
pub(crate) fn print() {
    let largest = |kind, plant, substeps, hold| {
        let mut scenario = Scenario { duration: 1.0, hold, ..Scenario::default() };
        scenario.filters.truncate(1);
        (scenario.filters[0].kind, scenario.filters[0].ensemble_size) = (kind, 100_000);
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
        let (plant, substeps) = (scenario.plant.kind, filter.substeps);
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
