//! A stiffness that goes up and down in steps, under a force that nobody measures.

use std::sync::Arc;

use kalmanscope_core::import::{Builder, read};
use kalmanscope_core::{Channel, Run, Scenario};

use crate::lesson_records::staircase;
use crate::lesson_records::staircase::{DWELL, FREQUENCIES, RATE};

/// Records of other forces and noise than the one that comes along.
const SEEDS: std::ops::RangeInclusive<u64> = 101..=110;

/// The filters of the built-in scenario on another record, after a change.
fn followed(seed: u64, change: impl Fn(&mut Scenario)) -> Run {
    let mut scenario = Scenario::from_toml(include_str!("../../assets/scenarios/staircase.toml")).unwrap();
    change(&mut scenario);
    let table = read(staircase::file(seed), None).unwrap();
    let mapping = scenario.record.clone().unwrap();
    let imported = Builder::new(&table, &mapping, scenario.input, scenario.hold).unwrap().finish().unwrap();
    let mut run = Run::on_record(&scenario, Arc::new(imported.record)).unwrap();
    run.finish();
    run
}

/// The relative errors of the natural frequency at the end of each dwell.
fn errors(run: &Run, filter: usize) -> Vec<f64> {
    let estimates = &run.estimates()[filter];
    let place = estimates.place(Channel::NATURAL_FREQUENCY).unwrap();
    let error = |dwell: u32| {
        let end = f64::from((dwell + 1) * DWELL) - 1.0 / f64::from(RATE);
        let k = ((end / run.record().dt()).round() as usize).min(estimates.len() - 1);
        estimates.mean(k)[place] / staircase::natural_frequency((dwell + 1) * DWELL * RATE - 1) - 1.0
    };
    (0..FREQUENCIES.len() as u32).map(error).collect()
}

#[test]
fn fading_memory_follows_each_step_within_two_per_cent() {
    for seed in SEEDS {
        let run = followed(seed, |_| {});
        for filter in 0..run.estimates().len() {
            let errors = errors(&run, filter);
            assert!(errors.iter().all(|error| error.abs() < 0.02), "seed {seed}, filter {filter}: {errors:?}");
        }
    }
}

#[test]
fn a_filter_that_never_forgets_is_left_behind() {
    for seed in SEEDS {
        let run = followed(seed, |scenario| scenario.filters.iter_mut().for_each(|filter| filter.fading = 1.0));
        let errors = errors(&run, 0);
        assert!(errors[3] < -0.05, "seed {seed}: {errors:?}");
    }
}
