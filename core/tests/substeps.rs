//! Predictions that are divided into several steps.

use std::sync::Arc;

use kalmanscope_core::record::Input;
use kalmanscope_core::{Hold, InputKind, Record, Run, Scenario};

const STEPS: usize = 4;

fn scenario(kind: &str, substeps: usize) -> Scenario {
    let text = format!(
        "duration = 8.0\ndt = 0.08\nhold = \"first\"\n[plant]\nkind = \"duffing\"\nnatural_frequency = 6.0\n\
         [[sensors]]\nmeasures = \"displacement\"\nnoise_std = 0.01\n[[filters]]\nkind = \"{kind}\"\nsmoother = true\n\
         substeps = {substeps}\n[filters.process_std]\ndisplacement = 0.0\nvelocity = 0.0\nnatural_frequency = 0.0\n\
         damping_ratio = 0.0\ncubic_stiffness = 0.0\n"
    );
    Scenario::from_toml(&text).unwrap()
}

/// The same record with four steps in place of one, its input linear and its measurements missing in between.
fn finer(record: &Record) -> Record {
    let n = (record.len() - 1) * STEPS + 1;
    let input = record.input();
    let between = |k: usize| {
        let (place, share) = (k / STEPS, (k % STEPS) as f64 / STEPS as f64);
        input[place] + share * (input[(place + 1).min(input.len() - 1)] - input[place])
    };
    let values = (0..n).map(between).collect();
    let measured = |k: usize| if k.is_multiple_of(STEPS) { record.measured(0)[k / STEPS] } else { f64::NAN };
    let columns = vec![(record.sensors()[0], (0..n).map(measured).collect())];
    let input = Input { kind: InputKind::Force, hold: Hold::First, values };
    Record::new(record.dt() / STEPS as f64, input, columns).unwrap()
}

#[test]
fn substeps_are_those_of_a_finer_record() {
    for kind in ["ekf", "ukf", "sr_ukf"] {
        let coarse = scenario(kind, STEPS);
        let mut run = Run::new(&coarse).unwrap();
        run.finish();
        let mut fine = Run::on_record(&scenario(kind, 1), Arc::new(finer(run.record()))).unwrap();
        fine.finish();
        let pairs = [(&run.estimates()[0], &fine.estimates()[0]), (&run.smoothed()[0], &fine.smoothed()[0])];
        for (which, (coarse, fine)) in pairs.into_iter().enumerate() {
            for k in 0..coarse.len() {
                for channel in 0..coarse.channels().len() {
                    let (found, expected) = (coarse.mean(k)[channel], fine.mean(STEPS * k)[channel]);
                    let (std, expected_std) = (coarse.std(k, channel), fine.std(STEPS * k, channel));
                    let place = format!("{kind}, {which}, sample {k}, channel {channel}");
                    assert!((found - expected).abs() <= 1e-6 * expected_std.max(1e-6), "{place}: {found} {expected}");
                    assert!((std / expected_std - 1.0).abs() < 1e-6, "{place}: {std} {expected_std}");
                }
            }
        }
    }
}

#[test]
fn an_impossible_number_of_substeps_is_named() {
    let mut scenario = scenario("ekf", 1);
    scenario.filters[0].substeps = 101;
    assert_eq!(
        scenario.validate().unwrap_err().to_string(),
        "`filters[0].substeps` is 101, but must be from 0 to 100 (0 for as many as its error asks for)"
    );
}
