//! Records that are read and written.

use std::path::Path;

use crate::{SAMPLE, command, fails, file, folder, read, succeeds, text};

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
        let folder = folder();
        let out = folder.path().join("estimates.csv");
        let part = |suffix: &str| data.join(format!("{case}.{suffix}"));
        succeeds(command().arg(part("toml")).arg("--record").arg(part("record.csv")).arg("--out").arg(&out));
        let (found, expected) = (rows(&out), rows(&part("expected.csv")));
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

#[test]
fn a_record_written_and_read_gives_the_same_estimates() {
    let folder = folder();
    let sample = file(&folder, "sample.toml", &SAMPLE.replace("duration = 60.0", "duration = 1.15"));
    let path = |name: &str| folder.path().join(name);
    succeeds(command().arg(&sample).arg("--out").arg(path("a.csv")).arg("--record-out").arg(path("record.csv")));
    succeeds(command().arg(&sample).arg("--out").arg(path("b.csv")).arg("--record").arg(path("record.csv")));
    assert_eq!(read(&path("a.csv")), read(&path("b.csv")));
    assert_eq!(read(&path("a.csv")).lines().count(), 117);
    assert!(read(&path("record.csv")).starts_with("t,force,displacement,velocity,true_displacement,"));
}

/// A scenario of the menu that names a record is all that is needed, but a file beside it comes before the built-in
/// one.
#[test]
fn a_record_that_comes_along_needs_no_file() {
    let folder = folder();
    let scenario = file(&folder, "s.toml", include_str!("../../assets/scenarios/earthquake.toml"));
    let output = command().arg(&scenario).output().unwrap();
    let (said, remarks) = (text(&output.stdout), text(&output.stderr));
    assert_eq!(output.status.code(), Some(0), "{remarks}");
    assert!(said.starts_with("1560 samples") && remarks.contains("input in `ground`"), "{said}\n{remarks}");
    file(&folder, "earthquake.csv", "time,ground (g),structure (g)\n0,0,0\n");
    let (_, error) = fails(command().arg(&scenario), 2);
    assert!(error.contains("earthquake.csv") && error.contains("1 row(s)"), "{error}");
}
