//! Nanoseconds per step of each filter and of the simulation, and milliseconds per whole record.

use std::hint::black_box;
use std::sync::Arc;
use std::time::{Duration, Instant};

use criterion::{Criterion, criterion_group, criterion_main};
use kalmanscope_core::{FilterKind, FilterSettings, Run, Scenario};

fn run(scenario: &Scenario) -> Run {
    Run::new(scenario).expect("the scenario is valid")
}

/// The time of `steps` steps of runs that follow each other; beginning anew is part of it.
fn time_steps(steps: u64, begin: impl Fn() -> Run) -> Duration {
    let mut run = begin();
    let start = Instant::now();
    for _ in 0..steps {
        if !run.step() {
            run = begin();
        }
    }
    black_box(&run);
    start.elapsed()
}

fn benchmarks(c: &mut Criterion) {
    let scenario = Scenario::default();
    let mut simulated = run(&scenario);
    simulated.finish();
    let record = Arc::new(simulated.record().clone());

    let mut group = c.benchmark_group("step");
    for kind in FilterKind::ALL {
        let settings = FilterSettings { kind, ..scenario.filters[0].clone() };
        let one = Scenario { filters: vec![settings], ..scenario.clone() };
        let begin = || Run::on_record(&one, Arc::clone(&record)).expect("the scenario is valid");
        group.bench_function(kind.name(), |b| b.iter_custom(|steps| time_steps(steps, begin)));
    }
    let no_filter = Scenario { filters: vec![], ..scenario.clone() };
    group.bench_function("simulation", |b| b.iter_custom(|steps| time_steps(steps, || run(&no_filter))));
    group.finish();

    c.bench_function("whole record, EKF and UKF", |b| {
        b.iter(|| {
            let mut run = run(&scenario);
            run.finish();
            black_box(run.len())
        });
    });
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(40);
    targets = benchmarks
}
criterion_main!(benches);
