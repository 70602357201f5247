//! Time per step of each filter, of the simulation and of the diagnostics \[ns\], and time per whole record \[ms\].

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::{Criterion, criterion_group, criterion_main};
use kalmanscope_core::{
    Diagnosis, Diagnostics, FilterKind, FilterSettings, LiveDiagnosis, Run, Scenario, Spectrum, frequency_response,
};

fn run(scenario: &Scenario) -> Run {
    Run::new(scenario).expect("the scenario is valid")
}

fn time_steps(steps: u64, scenario: &Scenario) -> Duration {
    let mut run = run(scenario);
    run.finish();
    let start = Instant::now();
    for _ in 0..steps {
        if !run.step() {
            run.restart(scenario).expect("the scenario is valid");
        }
    }
    black_box(&run);
    start.elapsed()
}

fn time_followed_steps(steps: u64, scenario: &Scenario) -> Duration {
    let mut run = run(scenario);
    run.finish();
    let mut diagnostics = Diagnostics::new(&run.estimates()[0], run.record());
    let start = Instant::now();
    for _ in 0..steps {
        if run.step() {
            diagnostics.follow(&run.estimates()[0], run.record());
        } else {
            run.restart(scenario).expect("the scenario is valid");
            diagnostics.restart(&run.estimates()[0], run.record());
        }
    }
    black_box((&run, &diagnostics));
    start.elapsed()
}

/// The samples of the window of a live diagnosis, and those between two diagnoses on a screen.
const LIVE: (usize, usize) = (2000, 60);

fn followed(sensors: usize) -> (Run, Diagnostics) {
    let mut scenario = Scenario { duration: 900.0, ..Scenario::default() };
    scenario.filters.truncate(1);
    while scenario.sensors.len() > sensors {
        scenario.remove_sensor(scenario.sensors[sensors].measures);
    }
    let mut run = run(&scenario);
    run.finish();
    let diagnostics = Diagnostics::new(&run.estimates()[0], run.record());
    (run, diagnostics)
}

fn time_following(samples: u64, run: &Run) -> Duration {
    let (window, portion) = LIVE;
    let mut live = LiveDiagnosis::default();
    let mut end = window;
    let start = Instant::now();
    for _ in 0..samples.div_ceil(portion as u64) {
        end = if end + portion > run.len() { window } else { end + portion };
        live.follow(end - window..end, &run.estimates()[0], run.record());
    }
    black_box(&live);
    start.elapsed()
}

fn benchmarks(c: &mut Criterion) {
    let scenario = Scenario::default();
    let mut group = c.benchmark_group("step of the simulation and");
    let no_filter = Scenario { filters: vec![], ..scenario.clone() };
    group.bench_function("no filter", |b| b.iter_custom(|steps| time_steps(steps, &no_filter)));
    for kind in FilterKind::ALL {
        let settings = FilterSettings { kind, ..scenario.filters[0].clone() };
        let one = Scenario { filters: vec![settings], ..scenario.clone() };
        group.bench_function(kind.name(), |b| b.iter_custom(|steps| time_steps(steps, &one)));
        let name = format!("{} and its diagnostics", kind.name());
        group.bench_function(name, |b| b.iter_custom(|steps| time_followed_steps(steps, &one)));
    }
    group.finish();

    for sensors in [1, 2] {
        let (run, diagnostics) = followed(sensors);
        let estimates = &run.estimates()[0];
        let mut group = c.benchmark_group(format!("live diagnosis, sensors {sensors}"));
        group.bench_function("a sample followed", |b| b.iter_custom(|samples| time_following(samples, &run)));
        let mut live = LiveDiagnosis::default();
        let window = 7013..7013 + LIVE.0;
        group.bench_function("a verdict", |b| {
            b.iter(|| black_box(live.over(window.clone(), &diagnostics, estimates, run.record(), None)));
        });
        group.bench_function("a verdict from one pass", |b| {
            b.iter(|| black_box(Diagnosis::over(window.clone(), &diagnostics, estimates, run.record(), None)));
        });
        group.finish();
    }

    let mut whole = run(&scenario);
    whole.finish();
    let mut diagnostics = Diagnostics::default();
    c.bench_function("diagnostics of a whole record of 6001 samples", |b| {
        b.iter(|| {
            diagnostics.restart(&whole.estimates()[0], whole.record());
            black_box(diagnostics.len())
        });
    });
    c.bench_function("diagnosis of a whole record of 6001 samples", |b| {
        b.iter(|| black_box(Diagnosis::new(&diagnostics, &whole.estimates()[0], whole.record(), None)));
    });
    let frequencies: Vec<f64> = (0..384).map(|i| 1.0 + f64::from(i) / 8.0).collect();
    c.bench_function("frequency response of a belief at 384 frequencies", |b| {
        b.iter(|| black_box(frequency_response::believed(&whole.estimates()[0], 3000, &frequencies)));
    });
    c.bench_function("spectrum of a whole record at 192 frequencies", |b| {
        b.iter(|| {
            let mut spectrum = Spectrum::new(frequencies[..192].to_vec(), 0.01, 40.0);
            spectrum.extend(whole.record().input());
            black_box(spectrum.density())
        });
    });
    c.bench_function("whole record, EKF and UKF", |b| {
        b.iter(|| {
            whole.restart(&scenario).expect("the scenario is valid");
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
