//! Nanoseconds per step of each filter, and milliseconds per whole record.

use std::hint::black_box;
use std::sync::Arc;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use kalmanscope_core::{FilterKind, FilterSettings, Run, Scenario};

fn benchmarks(c: &mut Criterion) {
    let scenario = Scenario::default();
    let mut simulated = Run::new(&scenario).expect("the default scenario is valid");
    simulated.finish();
    let record = Arc::new(simulated.record().clone());

    let mut group = c.benchmark_group("step");
    group.throughput(Throughput::Elements(record.len() as u64));
    for kind in FilterKind::ALL {
        let settings = FilterSettings { kind, ..scenario.filters[0].clone() };
        let one = Scenario { filters: vec![settings], ..scenario.clone() };
        group.bench_function(kind.name(), |b| {
            b.iter(|| {
                let mut run = Run::on_record(&one, Arc::clone(&record)).expect("the scenario is valid");
                run.finish();
                black_box(run.estimates()[0].len())
            });
        });
    }
    let no_filter = Scenario { filters: vec![], ..scenario.clone() };
    group.bench_function("simulation", |b| {
        b.iter(|| {
            let mut run = Run::new(&no_filter).expect("the scenario is valid");
            run.finish();
            black_box(run.record().len())
        });
    });
    group.finish();

    c.bench_function("whole record, EKF and UKF", |b| {
        b.iter(|| {
            let mut run = Run::new(&scenario).expect("the scenario is valid");
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
