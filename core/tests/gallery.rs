//! Twelve equations of the gallery are identified from simulated records.

use std::path::Path;

use kalmanscope_core::diagnosis::Diagnosis;
use kalmanscope_core::{Diagnostics, Run, Scenario};

/// The scenarios of the gallery, with their names.
fn gallery() -> Vec<(String, Scenario)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/equations");
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let read = |path: &std::path::PathBuf| {
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let scenario = Scenario::from_toml(&std::fs::read_to_string(path).unwrap());
        (name.clone(), scenario.unwrap_or_else(|error| panic!("{name}: {error}")))
    };
    files.iter().map(read).collect()
}

/// The faults of a scenario's estimates in words; none where all is right.
fn faults(scenario: &Scenario) -> Vec<String> {
    let mut run = Run::new(scenario).unwrap();
    run.finish();
    let estimates = &run.estimates()[0];
    if let Some(stop) = estimates.stop() {
        return vec![format!("stopped: {stop:?}")];
    }
    let diagnostics = Diagnostics::new(estimates, run.record());
    let verdict = Diagnosis::new(&diagnostics, estimates, run.record(), None).unwrap().verdict.unwrap();
    let last = estimates.len() - 1;
    let mut faults = Vec::new();
    for (place, &channel) in estimates.channels().iter().enumerate().filter(|(_, channel)| channel.is_parameter()) {
        let truth = run.record().truth(channel).unwrap()[last];
        let (mean, std) = (estimates.canonical_mean(last, place), estimates.std(last, place));
        let told = format!("{} {mean:.4} ± {std:.4}, truth {truth}", channel.symbol());
        if (mean - truth).abs() > 4.0 * std {
            faults.push(told.clone());
        }
        if std > 0.8 * estimates.initial_std(place) {
            faults.push(format!("nothing is learnt: {told}"));
        }
    }
    if !verdict.kind.is_good() {
        faults.push(format!("{:?}: {}", verdict.kind, verdict.reason));
    }
    faults
}

#[test]
fn each_equation_is_identified_and_the_verdict_is_right() {
    let gallery = gallery();
    assert_eq!(gallery.len(), 12);
    let mut all = Vec::new();
    for (name, scenario) in gallery {
        for seed in [1, 2, 3] {
            let faults = faults(&Scenario { seed, ..scenario.clone() });
            all.extend(faults.into_iter().map(|fault| format!("{name}, seed {seed}: {fault}")));
        }
    }
    assert!(all.is_empty(), "{}", all.join("\n"));
}
