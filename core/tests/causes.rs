//! Rules about which cause may stand first.

use kalmanscope_core::diagnosis::{Diagnosis, Remedy};
use kalmanscope_core::{Diagnostics, Run, Scenario};

/// The causes of the first filter's verdict without the truth.
fn remedies(scenario: &Scenario) -> Vec<Remedy> {
    let mut run = Run::new(scenario).unwrap();
    run.finish();
    let record = run.record().clone().with_truth(Vec::new()).unwrap();
    let estimates = &run.estimates()[0];
    let diagnostics = Diagnostics::new(estimates, &record);
    let diagnosis = Diagnosis::new(&diagnostics, estimates, &record, None).unwrap();
    let mut trials = diagnosis.trials(scenario, 0, &diagnostics, estimates, &record).unwrap();
    while !trials.advance(&mut || true) {}
    trials.remedies()
}

fn keys(remedies: &[Remedy]) -> Vec<&'static str> {
    remedies.iter().map(|remedy| remedy.first.cause.key).collect()
}

#[test]
fn an_accelerometer_under_a_broadband_force_is_not_still() {
    for seed in 3..7 {
        let scenario = Scenario::from_toml(&format!(
            "seed = {seed}\ndt = 0.01\nduration = 30.0\nforce = {{ white_noise = {{ std = 10.0 }} }}\n\
             [plant]\nnatural_frequency = 6.0\ndamping_ratio = 0.05\ninput_gain = 1.5\n\
             [[sensors]]\nmeasures = \"acceleration\"\nnoise_std = 0.5\n[[filters]]\nkind = \"ekf\"\n"
        ))
        .unwrap();
        let found = keys(&remedies(&scenario));
        assert_eq!(found.first(), Some(&"input_gain"), "seed {seed}: {found:?}");
        assert!(!found.contains(&"no_excitation"), "seed {seed}: {found:?}");
    }
}

#[test]
fn a_drift_is_no_sudden_change() {
    let mut scenario = Scenario::from_toml(include_str!("../../assets/scenarios/slow-drift.toml")).unwrap();
    scenario.filters.truncate(1);
    for seed in 0..3 {
        scenario.seed = seed;
        let found = remedies(&scenario);
        assert_ne!(keys(&found).first(), Some(&"sudden_change"), "seed {seed}: {:?}", keys(&found));
    }
}

#[test]
fn remedies_that_end_good_stand_first() {
    let scenario = Scenario::from_toml(
        "seed = 3\ndt = 0.01\nduration = 40.0\nforce = { white_noise = { std = 10.0 } }\n\
         [plant]\nnatural_frequency = { step = { from = 6.0, to = 5.2, at = 24.0 } }\ndamping_ratio = 0.03\n\
         [[sensors]]\nmeasures = \"displacement\"\nnoise_std = 0.002\n\
         [[sensors]]\nmeasures = \"acceleration\"\nnoise_std = 0.3\n\
         [[filters]]\nkind = \"ekf\"\nprocess_std = { displacement = 1e-8, velocity = 1e-6, natural_frequency = 6e-5, \
         damping_ratio = 3e-7 }\n",
    )
    .unwrap();
    for seed in 3..6 {
        let found = remedies(&Scenario { seed, ..scenario.clone() });
        let ends_good = |remedy: &Remedy| remedy.after.as_ref().is_some_and(|verdict| verdict.kind.is_good());
        assert!(!found.is_empty());
        if found.iter().any(ends_good) {
            assert!(ends_good(&found[0]), "seed {seed}: {:?}", keys(&found));
        }
        // A factor that silences a sensor is no explanation.
        assert_ne!(found[0].first.cause.key, "sensor_noise", "seed {seed}: {}", found[0].first.sentence);
    }
}
