//! The time of a whole map and of Monte Carlo, by one thread and by all, beside single filters, in one run; and of the map on a
//! graphics processor, or on a program in its place, which its name tells.
//!
//! ```text
//! cargo bench -p kalmanscope-gpu
//! ```
//!
//! Each number is the least of a few repeats.

use std::sync::Arc;
use std::time::{Duration, Instant};

use kalmanscope_core::score::Outcome;
use kalmanscope_core::simulate;
use kalmanscope_core::{Axis, Scenario, Source};
use kalmanscope_gpu::{Gpu, Software};
use kalmanscope_lab::{Ensemble, Measure, MonteCarlo, Plan, Priority, Runner, Sheet, Threads, channels};

/// Cells along each axis of the map, and samples of its record.
const SIDE: usize = 128;
const SAMPLES: usize = 2000;

/// Monte Carlo: seeds, and samples of each record.
const SEEDS: usize = 10_000;
const LONG: usize = 6000;

const REPEATS: usize = 3;

/// The cells of a first picture.
const COARSE: usize = 64;

fn main() {
    let gpu = pollster::block_on(Gpu::find(Software::Allowed));
    if let Err(error) = &gpu {
        println!("without a graphics processor: {error}");
    }
    for kind in ["EKF", "UKF"] {
        let runner = map(kind);
        let steps = (SIDE * SIDE * SAMPLES) as f64;
        let scenario = runner.ensemble().scenario();
        let record = simulate(scenario);
        let single = least(|| {
            let begin = Instant::now();
            let outcome = Outcome::of(scenario, 0, &record);
            assert!(outcome.is_ok_and(|outcome| outcome.samples == record.len()));
            begin.elapsed()
        });
        println!("{kind}: a single filter, {:.0} ns a step", nanoseconds(single) / SAMPLES as f64);
        let mut alone = 0.0;
        for threads in [1, 0] {
            let Ok(team) = Threads::new(threads, 0) else { continue };
            let mut first = Duration::MAX;
            let all = least(|| {
                let (coarse, all) = fill(&team, &runner);
                first = first.min(coarse);
                all
            });
            if threads == 1 {
                alone = nanoseconds(all);
            }
            println!(
                "{kind}: map {SIDE} × {SIDE} × {SAMPLES}, {} threads: first picture {:.0} ms, all {:.2} s, {:.0} ns a step, {:.2} \
                 times as fast as one thread",
                team.count(),
                nanoseconds(first) / 1e6,
                all.as_secs_f64(),
                nanoseconds(all) / steps,
                alone / nanoseconds(all),
            );
        }
        if let Ok(gpu) = &gpu {
            let all: Vec<usize> = runner.ensemble().coarse_to_fine();
            let time = |cells: &[usize]| {
                least(|| {
                    let begin = Instant::now();
                    let rows = pollster::block_on(gpu.rows(&runner, cells, &|| true));
                    assert!(rows.is_ok_and(|(served, _)| served == cells));
                    begin.elapsed()
                })
            };
            let (first, whole) = (time(&all[..COARSE]), time(&all));
            println!(
                "{kind}: map {SIDE} × {SIDE} × {SAMPLES}, {}, single precision: first picture {:.0} ms, all {:.2} s, {:.0} ns a step",
                gpu.name(),
                nanoseconds(first) / 1e6,
                whole.as_secs_f64(),
                nanoseconds(whole) / steps,
            );
        }
    }
    let scenario = Scenario { duration: LONG as f64 * 0.01, ..Scenario::default() };
    for times in [0, 60] {
        let Ok(ensemble) = MonteCarlo::ensemble(scenario.clone(), vec![0], SEEDS, times) else { continue };
        let Ok(runner) = Runner::new(ensemble, Source::Simulated).map(Arc::new) else { continue };
        let Ok(team) = Threads::new(0, 0) else { continue };
        let (_, all) = fill(&team, &runner);
        println!(
            "Monte Carlo of {SEEDS} seeds × {LONG} samples, looked at at {times} times, {} threads: {:.1} s, {:.0} ns a sample",
            team.count(),
            all.as_secs_f64(),
            nanoseconds(all) / (SEEDS * LONG) as f64
        );
    }
}

fn map(kind: &str) -> Arc<Runner> {
    let mut scenario = Scenario { duration: (SAMPLES - 1) as f64 * 0.01, ..Scenario::default() };
    scenario.filters.retain(|filter| filter.name == kind);
    let axes = [
        format!("filters.{kind}.initial_mean.natural_frequency=2:14:{SIDE}"),
        format!("filters.{kind}.process_std=0.01:100:{SIDE}:log"),
    ];
    let axes = axes.iter().flat_map(|text| Axis::parse(text)).collect();
    let measures = Measure::of_sums(&channels(&scenario, &[0]));
    let plan = Plan { filters: vec![0], measures, axes, ..Plan::default() };
    let runner = Ensemble::new(scenario, plan).and_then(|ensemble| Runner::new(ensemble, Source::Simulated));
    match runner {
        Ok(runner) => Arc::new(runner),
        Err(error) => panic!("the map is possible: {error}"),
    }
}

/// The time until all is covered coarsely, and until every cell is known.
fn fill(team: &Threads, runner: &Arc<Runner>) -> (Duration, Duration) {
    let begin = Instant::now();
    let mut sheet = Sheet::new(runner.ensemble());
    let work = team.rows(Priority::Map, runner, runner.ensemble().coarse_to_fine(), |_| {});
    let mut first = None;
    while let Some(slice) = work.wait() {
        sheet.fill(&slice.cells, &slice.rows);
        if first.is_none() && sheet.covers_all() {
            first = Some(begin.elapsed());
        }
    }
    assert!(sheet.is_complete());
    (first.unwrap_or_default(), begin.elapsed())
}

fn least(mut measure: impl FnMut() -> Duration) -> Duration {
    (0..REPEATS).map(|_| measure()).min().unwrap_or_default()
}

fn nanoseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e9
}
