use std::sync::Arc;

use kalmanscope_core::scenario::Law;
use kalmanscope_core::{Channel, Run, Scenario, Source, simulate};
use kalmanscope_diagnosis::CAUSES;
use kalmanscope_lab::{Ensemble, MonteCarlo, RunVerdicts, Runner, Slice};

use crate::ensemble::plan;

/// A linear filter that knows the true model: its theory is exact.
fn scenario(noise: f64) -> Scenario {
    let text = "duration = 10.0\n[plant]\nnatural_frequency = 6.0\ndisturbance_std = 2.0\n[plant.initial]\ndisplacement = 0.0\n\
                [[sensors]]\nmeasures = \"displacement\"\nnoise_std = 0.02\n[[filters]]\nkind = \"kf\"\n\
                [filters.initial_mean]\nnatural_frequency = 6.0\n[filters.initial_std]\ndisplacement = 0.0\nvelocity = 0.0\n";
    let mut scenario = Scenario::from_toml(text).unwrap();
    let damping = scenario.plant.parameter(Channel::DAMPING_RATIO).unwrap().at(0.0);
    scenario.filters[0].initial_mean[Channel::DAMPING_RATIO] = damping;
    let (sensors, process) = scenario.true_noise();
    scenario.filters[0].sensor_std = sensors.iter().map(|std| noise * std).collect();
    scenario.filters[0].process_std = process;
    scenario
}

fn statistics(scenario: Scenario, seeds: usize) -> (MonteCarlo, Ensemble) {
    let ensemble = MonteCarlo::ensemble(scenario, vec![0], seeds, 20, RunVerdicts::Not).unwrap();
    (taken(&ensemble), ensemble)
}

fn taken(ensemble: &Ensemble) -> MonteCarlo {
    let runner = Runner::new(ensemble.clone(), Source::Simulated).unwrap();
    let mut statistics = MonteCarlo::new(ensemble);
    for cell in 0..ensemble.cells() {
        statistics.take(ensemble, &Slice { cells: vec![cell], rows: runner.rows(&[cell]) });
    }
    statistics
}

#[test]
fn the_theory_of_a_linear_filter_holds() {
    let (all, _) = statistics(scenario(1.0), 400);
    assert_eq!((all.done(), all.diverged(0)), (400, [0.0, 0.0]));
    let inside = |values: Vec<f64>, degrees: usize| {
        let interval = MonteCarlo::interval(degrees, 400).unwrap();
        values.iter().filter(|value| interval.contains(value)).count()
    };
    assert!(inside(all.nees(0).collect(), 2) >= 15, "{:?}", all.nees(0).collect::<Vec<_>>());
    assert!(inside(all.nis(0).collect(), 1) >= 15, "{:?}", all.nis(0).collect::<Vec<_>>());
    for (rmse, std) in all.rmse(0, 0).zip(all.std(0, 0)).skip(2) {
        assert!((rmse / std - 1.0).abs() < 0.15, "{rmse} {std}");
    }
    for ([low, middle, high], std) in all.quantiles(0, 0, [0.025, 0.5, 0.975]).into_iter().zip(all.std(0, 0)).skip(2) {
        assert!(low < middle && middle < high);
        assert!(((high - low) / (3.92 * std) - 1.0).abs() < 0.25, "{low} {high} {std}");
    }
}

#[test]
fn a_filter_that_takes_its_sensor_for_better_is_found_out() {
    let (all, _) = statistics(scenario(0.3), 100);
    let interval = MonteCarlo::interval(1, 100).unwrap();
    assert!(all.nis(0).all(|nis| nis > *interval.end()));
}

#[test]
fn a_trace_has_the_numbers_of_the_run_on_a_screen() {
    let (all, ensemble) = statistics(scenario(1.0), 1);
    let mut run = Run::new(&ensemble.at(0)).unwrap();
    run.finish();
    let estimates = &run.estimates()[0];
    let truth = run.record().truth(Channel::DISPLACEMENT).unwrap();
    for ((&k, nis), [error]) in all.samples().iter().zip(all.nis(0)).zip(all.quantiles(0, 0, [0.5])) {
        assert_eq!(nis, estimates.nis()[k]);
        assert!((error - (estimates.mean(k)[0] - truth[k])).abs() < 1e-7);
    }
    assert_eq!(all.finals(0, 0), [estimates.mean(estimates.len() - 1)[0]]);
}

#[test]
fn times_are_no_more_than_the_samples() {
    let short = Scenario { duration: 0.1, ..Scenario::default() };
    let ensemble = MonteCarlo::ensemble(short, vec![0, 1], 3, 200, RunVerdicts::Not).unwrap();
    assert_eq!(ensemble.trace().samples(), (1..=10).collect::<Vec<_>>());
    assert_eq!(ensemble.width(), 2 * (2 + 3 * 4) + 2 * 10 * 10);
}

#[test]
fn a_population_is_counted() {
    let mut scenario = Scenario { duration: 20.0, ..Scenario::default() };
    scenario.filters.truncate(1);
    let law = |text: &str| (text.to_owned(), Law::Normal([0.05, 0.05]));
    scenario.draw.extend([law("plant.damping_ratio"), law("filters.1.initial_mean.damping_ratio")]);
    let seeds = 200;
    let ensemble = MonteCarlo::ensemble(scenario.clone(), vec![0], seeds, 5, RunVerdicts::Verdicts).unwrap();
    let statistics = taken(&ensemble);
    let is_possible = |cell: &usize| ensemble.at(*cell).validate().is_ok();
    let possible: Vec<usize> = (0..seeds).filter(is_possible).collect();
    assert_eq!((statistics.done(), statistics.impossible()), (seeds, seeds - possible.len()));
    assert_eq!(statistics.runs(), possible.len());
    assert!((20..45).contains(&statistics.impossible()), "{}", statistics.impossible());
    let places = ensemble.trace();
    let damping = places.channels(0).iter().position(|&channel| channel == Channel::DAMPING_RATIO).unwrap();
    let truth = |cell: usize| ensemble.at(cell).plant.parameter(Channel::DAMPING_RATIO).unwrap().at(0.0);
    for (last, &cell) in statistics.last_errors(0, damping).iter().zip(&possible) {
        assert!((last.truth - truth(cell)).abs() < 1e-12);
    }
    assert_eq!(ensemble.member(3), [ensemble.at(3).filters[0].initial_mean[Channel::DAMPING_RATIO], truth(3)]);
    assert_eq!(statistics.verdicts(0).iter().sum::<usize>(), possible.len());
    let other = Ensemble::new(scenario.clone(), plan(&[0], &[], &["filters.1.fading=1:1.1:3"])).unwrap();
    assert_eq!((other.drawn().len(), other.at(0).plant), (0, scenario.plant.clone()));
    let both = plan(&[0], &[], &["seed=1:9:9", "plant.damping_ratio=0.01:0.1:3"]);
    assert!(Ensemble::new(scenario, both).unwrap_err().to_string().contains("is drawn for each seed"));
}

#[test]
fn guesses_are_drawn_over_a_given_record() {
    let mut scenario = Scenario { duration: 10.0, ..Scenario::default() };
    let record = Arc::new(simulate(&scenario));
    let law = Law::LogUniform([3.0, 20.0]);
    scenario.draw.insert("filters.*.initial_mean.natural_frequency".to_owned(), law);
    let ensemble = MonteCarlo::ensemble(scenario.clone(), vec![0, 1], 12, 0, RunVerdicts::Not).unwrap();
    let runner = Runner::new(ensemble, Source::Measured(Arc::clone(&record))).unwrap();
    assert!(runner.runs(&[0, 5, 11]).iter().flatten().all(|run| Arc::ptr_eq(&run.record, &record)));
    scenario.draw.insert("plant.damping_ratio".to_owned(), law);
    let ensemble = MonteCarlo::ensemble(scenario, vec![0], 12, 0, RunVerdicts::Not).unwrap();
    let error = Runner::new(ensemble, Source::Measured(record)).err().unwrap().to_string();
    assert!(error.contains("`seed` is none"), "{error}");
}

#[test]
fn first_causes_are_counted() {
    let mut scenario = Scenario::from_toml(include_str!("../../assets/populations/input-gain.toml")).unwrap();
    scenario.duration = 30.0;
    scenario.number_filters();
    let ensemble = MonteCarlo::ensemble(scenario, vec![0], 3, 0, RunVerdicts::Causes).unwrap();
    let statistics = taken(&ensemble);
    let (counts, unexplained) = statistics.causes(0);
    let named: Vec<(&str, usize)> =
        CAUSES.iter().zip(counts).filter(|(_, count)| **count > 0).map(|(cause, count)| (cause.key, *count)).collect();
    assert_eq!((named, unexplained), (vec![("input_gain", 3)], 0));
}
