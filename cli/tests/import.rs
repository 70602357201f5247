//! Measured records on the command line, from the file to the free run.

use std::path::{Path, PathBuf};
use std::process::Command;

use tempfile::TempDir;

use crate::{ended, program};

const SCENARIO: &str = "duration = 60.0\ndt = 0.04\nhold = \"first\"\nseed = 5\n[plant]\nnatural_frequency = 6.0\n\
                        [[sensors]]\nmeasures = \"displacement\"\nnoise_std = 0.002\n[[filters]]\nkind = \"ekf\"\n";

fn command(arguments: &[&str]) -> Command {
    let mut command = program();
    command.args(arguments);
    command
}

#[track_caller]
fn succeeds(command: &mut Command) -> (String, String) {
    let (code, stdout, stderr) = ended(command);
    assert_eq!(code, Some(0), "{command:?}: {stderr}");
    (stdout, stderr)
}

#[track_caller]
fn fails(command: &mut Command) -> String {
    crate::fails(command, 2).1
}

/// A simulated record as a spreadsheet writes it: semicolons, decimal commas, millimetres, a line of units.
fn sheet(folder: &Path, name: &str, seed: u32) -> PathBuf {
    let scenario = folder.join("truth.toml");
    std::fs::write(&scenario, SCENARIO).unwrap();
    let record = folder.join("record.csv");
    let seed = seed.to_string();
    succeeds(command(&["run", "--seed", &seed, "--record-out"]).arg(&record).arg(&scenario));
    let mut sheet = "Zeit;Kraft;Weg\ns;;mm\n".to_owned();
    for line in std::fs::read_to_string(&record).unwrap().lines().skip(1) {
        let cells: Vec<f64> = line.split(',').take(3).map(|cell| cell.parse().unwrap()).collect();
        sheet.push_str(&format!("{:.2};{:.5};{:.4}\n", cells[0], cells[1], 1000.0 * cells[2]).replace('.', ","));
    }
    let path = folder.join(name);
    std::fs::write(&path, sheet).unwrap();
    path
}

/// The value of a parameter in the table.
#[track_caller]
fn value(table: &str, name: &str) -> f64 {
    let line = table.lines().find(|line| line.contains(name)).unwrap();
    line.split_once(name).unwrap().1.split_whitespace().next().unwrap().parse().unwrap()
}

#[test]
fn a_record_is_imported_identified_and_runs_freely() {
    let folder = TempDir::new().unwrap();
    let (record, other) = (sheet(folder.path(), "a.csv", 5), sheet(folder.path(), "b.csv", 6));
    let scenario = folder.path().join("a.toml");
    succeeds(command(&["import", "--out"]).arg(&scenario).arg(&record));
    let written = std::fs::read_to_string(&scenario).unwrap();
    assert!(written.starts_with("# UTF-8, semicolons between cells, decimal commas, names in line 1, units in line 2"));
    assert!(written.contains("file = \"a.csv\"") && written.contains("# guess of ωₙ"), "{written}");
    let (table, remarks) = succeeds(command(&["run", "--holdout"]).arg(&other).arg(&scenario));
    assert!(remarks.contains("time in `Zeit`, input in `Kraft`, displacement in `Weg`"), "{remarks}");
    assert!((value(&table, "natural frequency") / 6.0 - 1.0).abs() < 0.005, "{table}");
    assert!((value(&table, "damping ratio") / 0.05 - 1.0).abs() < 0.05, "{table}");
    let fits: Vec<f64> =
        table.split("fit ").skip(1).map(|rest| rest.split(' ').next().unwrap().parse().unwrap()).collect();
    // An EKF and a UKF: free run and one step ahead on the record, free run on the other one.
    assert_eq!(fits.len(), 6, "{table}");
    assert!(fits.iter().all(|fit| *fit > 95.0), "{fits:?}");
    assert!(table.contains(&format!("free run of the final models over {}", other.display())), "{table}");
}

#[test]
fn another_meaning_of_the_columns_comes_from_a_file_of_its_own() {
    let folder = TempDir::new().unwrap();
    let record = sheet(folder.path(), "a.csv", 5);
    let scenario = folder.path().join("truth.toml");
    let map = folder.path().join("map.toml");
    std::fs::write(
        &map,
        "to = 20.0\n[time]\ncolumn = \"Zeit\"\n[input]\ncolumn = \"Kraft\"\n[sensors.displacement]\ncolumn = \"Weg\"\nunit = \"mm\"\n",
    )
    .unwrap();
    let run = |map: &Path| {
        let mut run = command(&["run", "--record"]);
        run.arg(&record).arg("--map").arg(map).arg(&scenario);
        run
    };
    let (table, _) = succeeds(&mut run(&map));
    assert!(table.starts_with("501 samples from 0 s to 20 s, 0.04 s apart"), "{table}");
    std::fs::write(&map, "[time]\nrate = -1.0\n").unwrap();
    assert!(fails(&mut run(&map)).contains("record.time.rate"), "{}", fails(&mut run(&map)));
    std::fs::write(&map, "speed = 3\n").unwrap();
    assert!(fails(&mut run(&map)).contains("unknown field `speed`"), "{}", fails(&mut run(&map)));
}

#[test]
fn what_cannot_be_read_is_said_with_file_line_and_column() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("bad.csv");
    for (contents, sentence) in [
        (&b""[..], "the file is empty"),
        (b"\x7FELF\x00\x00\x01", "the file is not text"),
        (b"Zeit;x\n0;1\n1;oops\n2;3\n", "line 3, column `x`: `oops` is not a number"),
        (b"u;x\n2;1\n1;2\n3;3\n", "state the sample rate"),
    ] {
        std::fs::write(&path, contents).unwrap();
        let said = fails(command(&["import"]).arg(&path));
        assert!(said.contains("bad.csv") && said.contains(sentence), "{said}");
        assert_eq!(said.lines().count(), 1, "{said}");
    }
    let missing = fails(&mut command(&["import", "nowhere.csv"]));
    assert!(missing.starts_with("error: nowhere.csv: "), "{missing}");
}

#[test]
fn a_column_that_is_left_out_is_no_input_and_each_is_explained() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("phone.csv");
    let mut text = "Time (s),Linear Acceleration x (m/s^2),Linear Acceleration y (m/s^2),spare\n".to_owned();
    for k in 0..2000 {
        let t = 0.01 * f64::from(k);
        let (decay, turn) = ((-0.2 * t).exp(), 8.0 * t);
        text.push_str(&format!("{t:.2},{:.6},{:.6},{:.3}\n", decay * turn.sin(), 0.01 * turn.cos(), (3.0 * t).sin()));
    }
    std::fs::write(&path, text).unwrap();
    let (toml, said) = succeeds(command(&["import"]).arg(&path));
    assert!(toml.contains("[record.input]"), "{toml}");
    assert!(said.contains("column `spare`: the input: guessed"), "{said}");
    assert!(said.contains("column `Linear Acceleration x`: acceleration: its name says so"), "{said}");
    assert!(
        said.contains("column `Linear Acceleration y`: left out: another column has that meaning already"),
        "{said}"
    );
    let asked = ["--sensor", "acceleration=Linear Acceleration y"];
    for words in [&["--no-input"][..], &["--input", "none"], &["--input", "nothing"], &asked] {
        let (toml, said) = succeeds(command(&["import"]).args(words).arg(&path));
        assert!(!toml.contains("[record.input]"), "{words:?}: {toml}");
        assert!(said.contains("column `spare`: left out: "), "{words:?}: {said}");
    }
    let (_, said) = succeeds(command(&["import", "--input", "spare"]).arg(&path));
    assert!(said.contains("column `spare`: the input: as asked"), "{said}");
}

#[test]
fn a_record_that_has_changed_is_said() {
    let folder = TempDir::new().unwrap();
    let record = sheet(folder.path(), "record.sheet.csv", 3);
    let scenario = folder.path().join("imported.toml");
    succeeds(command(&["import", "--out"]).arg(&scenario).arg(&record));
    let has_changed = |said: &str| said.contains("has changed since it was imported");
    let (_, said) = succeeds(command(&["run"]).arg(&scenario));
    assert!(!has_changed(&said), "{said}");
    let mut text = std::fs::read_to_string(&record).unwrap();
    let cut = text.trim_end().rfind('\n').unwrap();
    text.truncate(cut + 1);
    std::fs::write(&record, text).unwrap();
    let (_, said) = succeeds(command(&["run"]).arg(&scenario));
    assert!(has_changed(&said), "{said}");
}

#[test]
fn a_scenario_that_run_would_refuse_is_not_written() {
    let folder = TempDir::new().unwrap();
    let [record, out] = ["constant.csv", "constant.toml"].map(|name| folder.path().join(name));
    let rows: String = (0..600).map(|k| format!("{}.{:02},{},0.5\n", k / 100, k % 100, (k * k) % 17)).collect();
    std::fs::write(&record, format!("t,force,displacement\n{rows}")).unwrap();
    let error = fails(command(&["import", "--out"]).arg(&out).arg(&record));
    assert!(error.contains("error: ") && error.contains("displacement") && !out.exists(), "{error}");
}

/// Two clocks in nanoseconds, as numbers above 2⁵³: a second more is the same number, and the import ends all the same, in words.
#[test]
fn two_clocks_in_nanoseconds_come_to_an_end() {
    let folder = TempDir::new().unwrap();
    let row = |k: u32| {
        let (x, later) = (f64::from(k), 10_000_000 * u64::from(k));
        let (first, second) = (1_714_564_800_023_500_000 + later, 1_714_564_800_000_000_000 + later);
        format!("{first},{:.3},{second},{:.3}\n", x.sin(), (0.3 * x).sin())
    };
    let path = folder.path().join("clocks.csv");
    std::fs::write(&path, "time,force,stamp,x\n".to_owned() + &(0..30).map(row).collect::<String>()).unwrap();
    let (toml, said) = succeeds(command(&["import"]).arg(&path));
    assert!(said.contains("the columns have clocks of their own, `time` and `stamp`"), "{said}");
    assert!(toml.contains("no start values of ωₙ and ζ could be found"), "{toml}");
}

/// The program's own record is held between samples: an import finds that, and says by how much.
#[test]
fn the_course_of_an_input_between_samples_is_found_and_said() {
    let folder = TempDir::new().unwrap();
    for (hold, name) in [("zero", "held"), ("first", "linear")] {
        let [truth, record, scenario] =
            ["truth.toml", "record.csv", "s.toml"].map(|name| folder.path().join(format!("{hold}-{name}")));
        let text = SCENARIO.replace("\"first\"", &format!("\"{hold}\"")).replace("dt = 0.04", "dt = 0.1");
        std::fs::write(&truth, text).unwrap();
        succeeds(command(&["run", "--quiet", "--record-out"]).arg(&record).arg(&truth));
        succeeds(command(&["import", "--out"]).arg(&scenario).arg(&record));
        let toml = std::fs::read_to_string(&scenario).unwrap();
        assert!(
            toml.contains(&format!("the input is {name} between samples, the likeliest of linear, held and")),
            "{toml}"
        );
        assert_eq!(toml.contains("hold = \"first\""), hold == "first", "{toml}");
        let (table, _) = succeeds(command(&["run"]).arg(&scenario));
        assert!((value(&table, "natural frequency") / 6.0 - 1.0).abs() < 0.003, "{table}");
    }
}
