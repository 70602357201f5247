//! The results of an independent program are reproduced to 1e-8.

use std::path::{Path, PathBuf};

use kalmanscope_core::Scenario;

use crate::run::{finished_on, record_of};

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

/// Counts the numbers that are the expected ones, relative to the number or, near a zero crossing, to 1e-3.
fn compared(case: &str) -> usize {
    let toml = std::fs::read_to_string(data(&format!("{case}.toml"))).unwrap();
    let scenario = Scenario::from_toml(&toml).unwrap();
    let file = std::fs::read(data(&format!("{case}.record.csv"))).unwrap();
    let run = finished_on(&scenario, record_of(file, &scenario));
    let estimates = &run.estimates()[0];
    assert_eq!(estimates.stop(), None);

    let mut expected = csv::Reader::from_path(data(&format!("{case}.expected.csv"))).unwrap();
    let mut compared = 0;
    for row in expected.records() {
        let row: Vec<f64> = row.unwrap().iter().map(|cell| cell.parse().unwrap()).collect();
        let k = row[0] as usize;
        let mut found = vec![k as f64, run.record().time(k)];
        found.extend(estimates.mean(k));
        found.extend((0..4).map(|i| estimates.std(k, i)));
        found.extend([estimates.nis()[k], estimates.log_likelihood(k)]);
        assert_eq!(found.len(), row.len());
        for (column, (found, expected)) in found.iter().zip(&row).enumerate() {
            if expected.is_nan() {
                assert!(found.is_nan(), "{case}: sample {k}, column {column} should be undefined");
                continue;
            }
            let deviation = (found - expected).abs() / expected.abs().max(1e-3);
            assert!(deviation < 1e-8, "{case}: sample {k}, column {column}: {found} instead of {expected}");
            compared += 1;
        }
    }
    compared
}

#[test]
fn every_case_holds_to_1e_8() {
    let files = std::fs::read_dir(data("")).unwrap().map(|file| file.unwrap().file_name().into_string().unwrap());
    let cases: Vec<String> = files.filter_map(|file| file.strip_suffix(".toml").map(str::to_owned)).collect();
    assert_eq!(cases.len(), 7, "{cases:?}");
    for case in cases {
        let compared = compared(&case);
        assert!(compared > 2000, "{case} compares only {compared} numbers");
    }
}
