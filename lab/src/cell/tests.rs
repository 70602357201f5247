//! One cell in slices of time.

use std::sync::Arc;

use crate::{CellTask, Ensemble, Plan, Runner};
use kalmanscope_core::{Axis, FilterKind, Scenario, Source, Task as _};

fn runner(scenario: Scenario, measures: &[&str], times: usize) -> Arc<Runner> {
    let axes = ["seed=1:2:2", "filters.EKF.fading=0.5:1.5:3"].map(|text| Axis::parse(text).unwrap()).to_vec();
    let measures = measures.iter().map(|text| text.parse().unwrap()).collect();
    let plan = Plan { filters: vec![0, 1], measures, axes, times };
    Arc::new(Runner::new(Ensemble::new(scenario, plan).unwrap(), Source::Simulated).unwrap())
}

fn in_slices(runner: &Arc<Runner>, cell: usize) -> (Vec<f64>, usize) {
    let (mut work, mut slices) = (CellTask::new(Arc::clone(runner), cell), 1);
    while !work.advance(&mut || false) {
        slices += 1;
    }
    (work.finish(), slices)
}

fn bits(row: &[f64]) -> Vec<u64> {
    row.iter().map(|number| number.to_bits()).collect()
}

#[test]
fn a_cell_in_slices_has_the_row_of_one_in_one_go() {
    let scenario = Scenario { duration: 3.0, ..Scenario::default() };
    let mut causes = 0;
    for (measures, times) in [
        (&["nis", "nees", "log_likelihood"][..], 0),
        (&["rmse.velocity"], 5),
        (&["verdict", "nis"], 0),
        (&["verdict"], 5),
        (&["verdict", "cause", "nis"], 5),
    ] {
        let runner = runner(scenario.clone(), measures, times);
        for cell in 0..6 {
            let row = runner.rows(&[cell]);
            assert_eq!(bits(&in_slices(&runner, cell).0), bits(&row), "{measures:?} {times} {cell}");
            causes += usize::from(measures.contains(&"cause") && row[1].is_finite());
        }
    }
    assert!(causes > 0, "one of the filters is wrong");
}

#[test]
fn a_cell_of_a_large_particle_filter_is_interrupted() {
    let mut scenario = Scenario { duration: 1.0, ..Scenario::default() };
    scenario.filters[1].kind = FilterKind::PF;
    scenario.filters[1].ensemble_size = 10_000;
    let runner = runner(scenario, &["nis"], 0);
    // 100 samples of some milliseconds each.
    let cell = 2;
    let (row, slices) = in_slices(&runner, cell);
    assert!(slices >= 100, "{slices}");
    assert_eq!(bits(&row), bits(&runner.rows(&[cell])));
}

#[test]
fn the_truth_of_a_cell_that_is_hard_to_follow_is_interrupted() {
    let hard = include_str!("../../../tests/hostile/hard-truth.toml");
    let mut scenario = Scenario { duration: 0.3, ..Scenario::from_toml(hard).unwrap() };
    scenario.filters.insert(0, scenario.filters[0].clone());
    scenario.filters[0].name = "EKF".to_owned();
    scenario.number_filters();
    let runner = runner(scenario, &["nis"], 0);
    let (row, slices) = in_slices(&runner, 2);
    assert!(slices > 10, "{slices}");
    assert_eq!(bits(&row), bits(&runner.rows(&[2])));
}
