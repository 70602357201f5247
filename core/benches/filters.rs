//! Time per step of the simulation and of each filter \[ns\], and per whole record, also of its diagnostics \[ms\].

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::{Criterion, criterion_group, criterion_main};
use kalmanscope_core::{Diagnostics, FilterKind, FilterSettings, PlantKind, Run, Scenario};

fn run(scenario: &Scenario) -> Run {
    Run::new(scenario).expect("the scenario is valid")
}

fn time_steps(steps: u64, scenario: &Scenario) -> Duration {
    let mut run = run(scenario);
    run.finish();
    let start = Instant::now();
    for _ in 0..steps {
        if !run.step() {
            run = self::run(scenario);
        }
    }
    black_box(&run);
    start.elapsed()
}

/// Prints the time of a step of the largest filters beside the one that limits them.
fn print_largest() {
    for (kind, plant, substeps) in [
        (FilterKind::PF, PlantKind::SDOF, 1),
        (FilterKind::PF, PlantKind::SDOF, 4),
        (FilterKind::PF, PlantKind::BOUC_WEN, 1),
        (FilterKind::ENKF, PlantKind::SHEAR_10, 1),
        (FilterKind::UKF, PlantKind::SHEAR_10, 100),
    ] {
        let filter = FilterSettings { kind, substeps, ensemble_size: 100_000, ..FilterSettings::default() };
        let mut scenario = Scenario { duration: 1.0, filters: vec![filter], ..Scenario::default() };
        scenario.set_plant(plant.clone());
        scenario.filters[0].sensor_std = scenario.sensors.iter().map(|sensor| sensor.noise_std).collect();
        let Ok(mut run) = Run::new(&scenario) else { continue };
        run.advance_to(1);
        let start = Instant::now();
        run.advance_to(4);
        let (name, estimated) = (kind.name(), 1e-6 * scenario.filters[0].time_of_step(&scenario));
        println!("{name} {} {substeps}: {:.0?}, estimated {estimated:.0} ms", plant.key(), start.elapsed() / 3);
    }
}

fn benchmarks(c: &mut Criterion) {
    print_largest();
    let scenario = Scenario::default();
    let mut group = c.benchmark_group("step of the simulation and");
    let no_filter = Scenario { filters: vec![], ..scenario.clone() };
    group.bench_function("no filter", |b| b.iter_custom(|steps| time_steps(steps, &no_filter)));
    for kind in FilterKind::ALL {
        let settings = FilterSettings { kind, ..scenario.filters[0].clone() };
        let one = Scenario { filters: vec![settings], ..scenario.clone() };
        group.bench_function(kind.name(), |b| b.iter_custom(|steps| time_steps(steps, &one)));
    }
    group.finish();

    let mut whole = run(&scenario);
    whole.finish();
    let mut diagnostics = Diagnostics::default();
    c.bench_function("diagnostics of a whole record of 6001 samples", |b| {
        b.iter(|| {
            diagnostics.restart(&whole.estimates()[0], whole.record());
            black_box(diagnostics.len())
        });
    });
    c.bench_function("whole record, EKF and UKF", |b| {
        b.iter(|| {
            let mut whole = run(&scenario);
            whole.finish();
            black_box(whole.len())
        });
    });
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(40);
    targets = benchmarks
}
criterion_main!(benches);
