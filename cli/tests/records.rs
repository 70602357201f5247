//! Records that are read and written.

use std::path::Path;

use kalmanscope_core::{PlantKind, Quantity};

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

/// Every plant under every input, with all of its sensors: what `--record-out` writes is what `--record` reads, to the last bit.
#[test]
fn records_of_every_plant_input_and_sensor_come_back() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    for kind in PlantKind::ALL {
        let all: Vec<Quantity> = kind.quantities().collect();
        // A scenario has at most twelve sensors.
        for (input, some) in
            ["force", "ground_acceleration"].iter().flat_map(|input| all.chunks(12).map(move |some| (input, some)))
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
            let scenario = file(&folder, "s.toml", &text);
            let record = path("record.csv");
            let run = |out: &str, option: &str| {
                let out = path(out);
                succeeds(command().arg(&scenario).arg("--quiet").arg("--out").arg(&out).arg(option).arg(&record));
                read(&out)
            };
            let [simulated, again] =
                [("a.csv", "--record-out"), ("b.csv", "--record")].map(|(out, option)| run(out, option));
            assert_eq!(simulated, again, "{kind:?}, {input}");
            assert_eq!(simulated.lines().count(), 32);
        }
    }
}

/// A column without a name has the scenario's meaning.
#[test]
fn an_input_without_a_name_is_the_scenarios() {
    let folder = folder();
    let rows: String = (0..40).map(|k| format!("{},{},{}\n", 0.05 * f64::from(k), k % 3, k % 5)).collect();
    let record = file(&folder, "r.csv", &format!("t,channel 1,roof\n{rows}"));
    let scenario = |input: &str| {
        let text = SAMPLE.replace("[[sensors]]\nmeasures = \"velocity\"\nnoise_std = 0.06\n", "");
        let text = text.replace("sensor_std = [0.01, 0.06]", "sensor_std = [0.01]");
        file(&folder, "s.toml", &format!("input = \"{input}\"\n{text}"))
    };
    let estimates = |input: &str| {
        let out = folder.path().join("out.csv");
        let output =
            command().arg(scenario(input)).arg("--record").arg(&record).arg("--out").arg(&out).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        read(&out)
    };
    assert_ne!(estimates("force"), estimates("ground_acceleration"), "the ground pushes the other way");
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
