//! Free runs: of the truth, in pieces, and where there is nothing to fit.

use kalmanscope_core::free_run::{fit, one_step};
use kalmanscope_core::{Identified, Pass, Run, Sample, Scenario, Sink as _, Task as _, Work};

use crate::run::finished;

fn knowing(scenario: &Scenario, values: &[f64]) -> Identified {
    let mut history = Pass::history(scenario, 0).unwrap();
    history.push(&Sample::unmeasured(values, &vec![0.0; values.len() * values.len()]));
    Identified::at(scenario, &scenario.filters[0], &history, 0)
}

fn at_end(scenario: &Scenario, run: &Run) -> Identified {
    Identified::at(scenario, &scenario.filters[0], &run.estimates()[0], run.len() - 1)
}

fn scenario(text: &str) -> Scenario {
    Scenario::from_toml(text).unwrap()
}

#[test]
fn the_truth_runs_freely_through_its_own_record() {
    for (kind, hold) in [("sdof", "zero"), ("sdof", "first"), ("duffing", "first")] {
        let text = format!(
            "duration = 20.0\nhold = \"{hold}\"\n[plant]\nkind = \"{kind}\"\nnatural_frequency = 6.0\n[plant.initial]\ndisplacement = 0.3\n\
             [[sensors]]\nmeasures = \"displacement\"\nnoise_std = 0.0\n[[sensors]]\nmeasures = \"acceleration\"\n\
             noise_std = 0.0\n[[filters]]\nkind = \"ekf\"\nsensor_std = [0.01, 0.1]\n"
        );
        let scenario = scenario(&text);
        let run = finished(&scenario);
        let channels = run.estimates()[0].channels();
        let truth: Vec<f64> = channels.iter().map(|&channel| run.record().truth(channel).unwrap()[100]).collect();
        let free = knowing(&scenario, &truth).run(run.record(), 0..run.len());
        for fit in &free.fits {
            let fit = fit.unwrap();
            assert!(fit.percent > 99.999, "{kind} {hold}: {fit:?}");
            assert!(fit.readings > 1900);
        }
    }
}

#[test]
fn a_free_run_in_pieces_is_that_in_one_go() {
    for kind in ["sdof", "duffing"] {
        let text = format!("duration = 20.0\n[plant]\nkind = \"{kind}\"\n[plant.initial]\ndisplacement = 0.3\n");
        let scenario = scenario(&text);
        let run = finished(&scenario);
        let model = at_end(&scenario, &run);
        let (own, record) = (model.clone(), run.record().clone());
        let mut running =
            Work::new(
                |progress| async move { own.run_in_pieces(&record, 100..1900, |share| progress.set(share)).await },
            );
        let mut pieces = 1;
        while !running.advance(&mut || false) {
            assert!(running.progress() < 1.0);
            pieces += 1;
        }
        assert!(pieces > 20, "{pieces}");
        assert_eq!(running.progress(), 1.0);
        assert_eq!(running.finish(), model.run(run.record(), 100..1900));
    }
}

#[test]
fn without_sensors_or_with_one_sample_there_is_no_fit() {
    let blind = scenario("duration = 2.0\nsensors = []\n[[filters]]\nkind = \"ekf\"\nsensor_std = []\n");
    let run = finished(&blind);
    let free = at_end(&blind, &run).run(run.record(), 0..run.len());
    assert_eq!((free.fitted, free.fits.len()), (100, 0));
    let scenario = scenario("duration = 2.0\n");
    let run = finished(&scenario);
    for part in [5..6, 5..5, 500..600] {
        let free = at_end(&scenario, &run).run(run.record(), part);
        assert_eq!(free.fitted, 0);
        assert!(free.part.len() <= 1 && free.predicted.iter().all(|column| column.len() == free.part.len()));
    }
}

#[test]
fn a_filter_that_has_stopped_before_the_part_has_no_fit_one_step_ahead() {
    let scenario = scenario("duration = 2.0\n");
    let mut run = Run::new(&scenario).unwrap();
    run.advance_to(20);
    let estimates = run.estimates()[0].clone();
    run.finish();
    assert_eq!(one_step(&estimates, run.record(), 0, 50..run.len()), None);
    assert!(one_step(&run.estimates()[0], run.record(), 0, 50..run.len()).is_some());
}

#[test]
fn a_motion_that_is_no_number_is_not_fitted() {
    let scenario = scenario("duration = 2.0\n");
    let run = finished(&scenario);
    for value in [1e155, 1e300, f64::INFINITY, f64::NAN, -1e155] {
        let channels = run.estimates()[0].channels().len();
        for place in 0..channels {
            let mut values = run.estimates()[0].mean(run.len() - 1).to_vec();
            values[place] = value;
            let free = knowing(&scenario, &values).run(run.record(), 0..run.len());
            assert_eq!(free.fits.len(), run.record().sensors().len(), "{value} {place}");
        }
    }
}

#[test]
fn fits_are_shares_of_the_spread() {
    let measured = [1.0, -1.0, f64::NAN, 1.0, -1.0];
    let exact = fit(&measured, &[1.0, -1.0, 5.0, 1.0, -1.0]).unwrap();
    assert_eq!((exact.rms, exact.percent, exact.readings), (0.0, 100.0, 4));
    assert_eq!(fit(&measured, &[0.0; 5]).unwrap().percent, 0.0);
    assert_eq!(fit(&measured, &[f64::NAN; 5]).unwrap().rms, f64::INFINITY);
    assert_eq!(fit(&[f64::NAN], &[0.0]), None);
}
