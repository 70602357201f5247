//! Records that are read and written.

use std::path::Path;

use kalmanscope_core::{PlantKind, Quantity};

use crate::{Folder, SAMPLE};

/// The columns of an estimates file from `k` on, of every row.
fn rows(path: &Path) -> Vec<Vec<f64>> {
    let mut reader = csv::Reader::from_path(path).unwrap();
    let first = reader.headers().unwrap().iter().position(|name| name == "k").unwrap();
    reader.records().map(|row| row.unwrap().iter().skip(first).map(|cell| cell.parse().unwrap()).collect()).collect()
}

#[test]
fn reference_cases_are_reproduced() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../core/tests/data");
    for case in ["ekf-basic", "ukf-fading-stiffness-loss", "kf-known-parameters", "ekf-acceleration-only"] {
        let folder = Folder::new();
        let part = |suffix: &str| data.join(format!("{case}.{suffix}"));
        let [scenario, record] = ["toml", "record.csv"].map(|suffix| part(suffix).display().to_string());
        folder.quietly(&["run", &scenario, "--record", &record, "--out", "estimates.csv"]);
        let (found, expected) = (rows(&folder.path("estimates.csv")), rows(&part("expected.csv")));
        assert!(expected.len() > 200, "{case}");
        for expected in expected {
            let found = &found[expected[0] as usize];
            // The reference has neither innovations nor predictions.
            assert!(found.len() > expected.len());
            for (found, expected) in found.iter().zip(&expected) {
                let close = (found - expected).abs() <= 1e-8 * expected.abs().max(1e-3);
                assert!(close || (found.is_nan() && expected.is_nan()), "{case}: {found} instead of {expected}");
            }
        }
    }
}

/// Every plant under every input, with all of its sensors: what `--record-out` writes is what `--record` reads, to the last bit.
#[test]
fn records_of_every_plant_input_and_sensor_come_back() {
    let folder = Folder::new();
    // Longer chains take long and are the same.
    for kind in PlantKind::ALL.into_iter().filter(|kind| kind.masses() <= 10) {
        let all: Vec<Quantity> = kind.quantities().collect();
        // A scenario has at most 24 sensors.
        for (input, some) in
            ["force", "ground_acceleration"].iter().flat_map(|input| all.chunks(24).map(move |some| (input, some)))
        {
            let sensors: String = some
                .iter()
                .map(|quantity| format!("[[sensors]]\nmeasures = \"{}\"\nnoise_std = 0.01\n", quantity.key()))
                .collect();
            let text = format!(
                "dt = 0.03\nduration = 0.9\ninput = \"{input}\"\n[plant]\nkind = \"{}\"\n{sensors}\
                 [[filters]]\nkind = \"ekf\"\n",
                kind.key()
            );
            folder.file("s.toml", &text);
            let [simulated, again] = ["--record-out", "--record"].map(|option| {
                folder.quietly(&["run", "s.toml", "--quiet", "--out", "out.csv", option, "record.csv"]);
                folder.read("out.csv")
            });
            assert_eq!(simulated, again, "{kind:?}, {input}");
            assert_eq!(simulated.lines().count(), 32);
        }
    }
}

#[test]
fn an_input_without_a_name_is_the_scenarios() {
    let folder = Folder::new();
    let rows: String = (0..40).map(|k| format!("{},{},{}\n", 0.05 * f64::from(k), 2 * k % 3, 2 * k % 5)).collect();
    folder.file("r.csv", &format!("t,channel 1,roof\n{rows}"));
    let estimates = |input: &str| {
        let text = SAMPLE.replace("[[sensors]]\nmeasures = \"velocity\"\nnoise_std = 0.06\n", "");
        let text = text.replace("sensor_std = [0.01, 0.06]", "sensor_std = [0.01]");
        folder.file("s.toml", &format!("input = \"{input}\"\n{text}"));
        folder.succeeds(&["run", "s.toml", "--record", "r.csv", "--out", "out.csv"]);
        folder.read("out.csv")
    };
    assert_ne!(estimates("force"), estimates("ground_acceleration"), "the ground pushes the other way");
}

/// A scenario of the menu that names a record is all that is needed, but a file beside it comes before the built-in
/// one.
#[test]
fn a_record_that_comes_along_needs_no_file() {
    let folder = Folder::of(include_str!("../../assets/scenarios/earthquake.toml"));
    let (said, remarks) = folder.succeeds(&["run", "scenario.toml"]);
    assert!(said.starts_with("1560 samples") && remarks.contains("input in `ground`"), "{said}\n{remarks}");
    folder.file("earthquake.csv", "time,ground (g),structure (g)\n0,0,0\n");
    let error = folder.refused(&["run", "scenario.toml"]);
    assert!(error.contains("earthquake.csv") && error.contains("1 row(s)"), "{error}");
}
