//! Maps by the graphics processor beside those by the processor.

use std::sync::{Arc, LazyLock};
use std::time::{Duration, Instant};

use kalmanscope_core::{Channel, Scenario, Source};
use kalmanscope_gpu::{Gpu, Software};
use kalmanscope_lab::{Axis, Crew, Ensemble, Measure, Plan, Runner, Sheet, Slice};

/// An adapter, a program where there is no graphics processor. Without one there is no test, and that is a failure.
static GPU: LazyLock<Gpu> = LazyLock::new(|| match pollster::block_on(Gpu::find(Software::Allowed)) {
    Ok(gpu) => gpu,
    Err(error) => panic!("these tests need a Vulkan driver, such as Mesa's lavapipe: {error}"),
});

pub(crate) fn gpu() -> &'static Gpu {
    &GPU
}

/// Limits the relative difference of scores where both filters have converged.
pub(crate) const CLOSE: f64 = 0.02;

/// The usual scenario with the filter of a kind, of some samples.
pub(crate) fn scenario(kind: &str, samples: usize) -> Scenario {
    let mut scenario = Scenario { duration: (samples - 1) as f64 * 0.01, ..Scenario::default() };
    scenario.filters.retain(|filter| filter.name == kind);
    assert_eq!((scenario.filters.len(), scenario.samples()), (1, samples));
    scenario
}

/// A map with all scores that sums give.
pub(crate) fn map(scenario: Scenario, axes: &[String]) -> Arc<Runner> {
    let axes = axes.iter().map(|text| Axis::parse(text).unwrap()).collect();
    let measures = Measure::of_sums(&kalmanscope_lab::channels(&scenario, &[0]));
    let plan = Plan { filters: vec![0], measures, axes, ..Plan::default() };
    Arc::new(Runner::new(Ensemble::new(scenario, plan).unwrap(), Source::Simulated).unwrap())
}

/// The comparison of two maps.
#[derive(Debug, Default)]
pub(crate) struct Comparison {
    pub(crate) cells: usize,
    /// Cells with the same class: stopped, lost, converged within 5 %.
    pub(crate) same: usize,
    /// Cells in which both have converged.
    pub(crate) converged: usize,
    /// Those of them whose scores are all close.
    pub(crate) close: usize,
    /// The largest difference of a score of theirs, and which.
    pub(crate) worst: f64,
    pub(crate) worst_score: String,
    pub(crate) stopped: [usize; 2],
    pub(crate) times: [Duration; 2],
}

impl Comparison {
    pub(crate) fn same_share(&self) -> f64 {
        self.same as f64 / self.cells as f64
    }

    pub(crate) fn close_share(&self) -> f64 {
        self.close as f64 / (self.converged as f64).max(1.0)
    }
}

/// Runs all cells of a map both ways.
pub(crate) fn compare(runner: &Arc<Runner>) -> Comparison {
    let ensemble = runner.ensemble();
    let cells: Vec<usize> = (0..ensemble.cells()).collect();
    let mut exact = Sheet::new(ensemble);
    let begin = Instant::now();
    let work = Crew::new(0).unwrap().start(runner, cells.clone(), || {});
    while let Some(Slice { cells, rows }) = work.wait() {
        exact.fill(&cells, &rows);
    }
    let exact_time = begin.elapsed();
    assert!(Gpu::serves(runner));
    let begin = Instant::now();
    let rows = pollster::block_on(gpu().rows(runner, &cells, &|| true)).unwrap();
    let time = begin.elapsed();
    let mut comparison = Comparison { cells: cells.len(), times: [exact_time, time], ..Comparison::default() };
    let measures = &ensemble.plan().measures;
    for (&cell, row) in cells.iter().zip(rows.chunks(ensemble.width())) {
        comparison.take(measures, &ensemble.at(cell), exact.row(cell).unwrap(), row);
    }
    comparison
}

impl Comparison {
    fn take(&mut self, measures: &[Measure], scenario: &Scenario, exact: &[f64], row: &[f64]) {
        let of = |row: &[f64], measure: Measure| row[measures.iter().position(|other| *other == measure).unwrap()];
        let truth = scenario.plant.parameter(Channel::NATURAL_FREQUENCY).unwrap().at(scenario.duration);
        let class = |row: &[f64]| {
            let is_near = of(row, Measure::Error(Channel::NATURAL_FREQUENCY)).abs() <= 0.05 * truth;
            (of(row, Measure::Stopped), of(row, Measure::Diverged), is_near)
        };
        let (class, other) = (class(exact), class(row));
        self.same += usize::from(class == other);
        self.stopped[0] += usize::from(class.0 > 0.0);
        self.stopped[1] += usize::from(other.0 > 0.0);
        if class != (0.0, 0.0, true) || other != class {
            return;
        }
        self.converged += 1;
        let mut largest = 0.0_f64;
        for (measure, (&exact, &number)) in measures.iter().zip(exact.iter().zip(row)) {
            let difference = match measure {
                // Numbers about zero, or counts.
                Measure::Error(_) | Measure::Settled(_) | Measure::Consistency => continue,
                Measure::Inside(_) => (number - exact).abs(),
                _ => (number - exact).abs() / exact.abs().max(f64::MIN_POSITIVE),
            };
            let difference = if exact == number { 0.0 } else { difference };
            if difference.is_nan() || difference > largest {
                largest = if difference.is_nan() { f64::INFINITY } else { difference };
                if largest > self.worst {
                    (self.worst, self.worst_score) = (largest, format!("{measure}: {number} for {exact}"));
                }
            }
        }
        self.close += usize::from(largest <= CLOSE);
    }
}
