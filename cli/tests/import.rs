//! Measured records on the command line, from the file to the free run.

use crate::{Folder, sheet, value};

const SCENARIO: &str = "duration = 60.0\ndt = 0.04\nhold = \"first\"\nseed = 5\n[plant]\nnatural_frequency = 6.0\n\
                        [[sensors]]\nmeasures = \"displacement\"\nnoise_std = 0.002\n[[filters]]\nkind = \"ekf\"\n";

/// A folder with simulated records as a spreadsheet writes them, with a line of units, each of a seed.
fn folder(records: &[(&str, &str)]) -> Folder {
    let folder = Folder::of(SCENARIO);
    for (name, seed) in records {
        folder.succeeds(&["run", "scenario.toml", "--seed", seed, "--record-out", "record.csv"]);
        folder.file(name, &("Zeit;Kraft;Weg\ns;;mm\n".to_owned() + &sheet(&folder.read("record.csv"))));
    }
    folder
}

#[test]
fn a_record_is_imported_identified_and_runs_freely() {
    let folder = folder(&[("a.csv", "5"), ("b.csv", "6")]);
    folder.succeeds(&["import", "--out", "a.toml", "a.csv"]);
    let written = folder.read("a.toml");
    assert!(written.starts_with("# UTF-8, semicolons between cells, decimal commas, names in line 1, units in line 2"));
    assert!(written.contains("file = \"a.csv\"") && written.contains("# guess of ωₙ"), "{written}");
    let (table, remarks) = folder.succeeds(&["run", "--holdout", "b.csv", "a.toml"]);
    assert!(remarks.contains("time in `Zeit`, input in `Kraft`, displacement in `Weg`"), "{remarks}");
    assert!((value(&table, "natural frequency") / 6.0 - 1.0).abs() < 0.005, "{table}");
    assert!((value(&table, "damping ratio") / 0.05 - 1.0).abs() < 0.05, "{table}");
    let fits: Vec<f64> =
        table.split("fit ").skip(1).map(|rest| rest.split(' ').next().unwrap().parse().unwrap()).collect();
    // An EKF and a UKF: free run and one step ahead on the record, free run on the other one.
    assert_eq!(fits.len(), 6, "{table}");
    assert!(fits.iter().all(|fit| *fit > 95.0), "{fits:?}");
    assert!(table.contains("free run of the final models over b.csv"), "{table}");
}

#[test]
fn another_meaning_of_the_columns_comes_from_a_file_of_its_own() {
    let folder = folder(&[("a.csv", "5")]);
    let run = ["run", "--record", "a.csv", "--map", "map.toml", "scenario.toml"];
    folder.file(
        "map.toml",
        "to = 20.0\n[time]\ncolumn = \"Zeit\"\n[input]\ncolumn = \"Kraft\"\n[sensors.displacement]\ncolumn = \"Weg\"\nunit = \"mm\"\n",
    );
    let (table, _) = folder.succeeds(&run);
    assert!(table.starts_with("501 samples from 0 s to 20 s, 0.04 s apart"), "{table}");
    for (map, reason) in [("[time]\nrate = -1.0\n", "record.time.rate"), ("speed = 3\n", "unknown field `speed`")] {
        folder.file("map.toml", map);
        let said = folder.refused(&run);
        assert!(said.contains(reason), "{said}");
    }
}

#[test]
fn what_cannot_be_read_is_said_with_file_line_and_column() {
    let folder = Folder::new();
    for (contents, sentence) in [
        (&b""[..], "the file is empty"),
        (b"\x7FELF\x00\x00\x01", "the file is not text"),
        (b"Zeit;x\n0;1\n1;oops\n2;3\n", "line 3, column `x`: `oops` is not a number"),
        (b"u;x\n2;1\n1;2\n3;3\n", "state the sample rate"),
    ] {
        std::fs::write(folder.path("bad.csv"), contents).unwrap();
        let said = folder.refused(&["import", "bad.csv"]);
        assert!(said.contains("bad.csv") && said.contains(sentence), "{said}");
        assert_eq!(said.lines().count(), 1, "{said}");
    }
    let missing = folder.refused(&["import", "nowhere.csv"]);
    assert!(missing.starts_with("error: nowhere.csv: "), "{missing}");
}

#[test]
fn a_column_that_is_left_out_is_no_input_and_each_is_explained() {
    let folder = Folder::new();
    let mut text = "Time (s),Linear Acceleration x (m/s^2),Linear Acceleration y (m/s^2),spare\n".to_owned();
    for k in 0..2000 {
        let t = 0.01 * f64::from(k);
        let (decay, turn) = ((-0.2 * t).exp(), 8.0 * t);
        text.push_str(&format!("{t:.2},{:.6},{:.6},{:.3}\n", decay * turn.sin(), 0.01 * turn.cos(), (3.0 * t).sin()));
    }
    folder.file("phone.csv", &text);
    let (toml, said) = folder.succeeds(&["import", "phone.csv"]);
    assert!(toml.contains("[record.input]"), "{toml}");
    assert!(said.contains("column `spare`: the input: guessed"), "{said}");
    assert!(said.contains("column `Linear Acceleration x`: acceleration: its name says so"), "{said}");
    assert!(said.contains("column `Linear Acceleration y`: left out: another axis moves more"), "{said}");
    let asked = ["--sensor", "acceleration=Linear Acceleration y"];
    for words in [&["--no-input"][..], &["--input", "none"], &["--input", "nothing"], &asked] {
        let (toml, said) = folder.succeeds(&[&["import", "phone.csv"], words].concat());
        assert!(!toml.contains("[record.input]"), "{words:?}: {toml}");
        assert!(said.contains("column `spare`: left out: "), "{words:?}: {said}");
    }
    let (_, said) = folder.succeeds(&["import", "--input", "spare", "phone.csv"]);
    assert!(said.contains("column `spare`: the input: as asked"), "{said}");
}

#[test]
fn a_record_that_has_changed_is_said() {
    let folder = folder(&[("sheet.csv", "3")]);
    folder.succeeds(&["import", "--out", "imported.toml", "sheet.csv"]);
    let has_changed = |said: &str| said.contains("has changed since it was imported");
    let (_, said) = folder.succeeds(&["run", "imported.toml"]);
    assert!(!has_changed(&said), "{said}");
    let text = folder.read("sheet.csv");
    let cut = text.trim_end().rfind('\n').unwrap();
    folder.file("sheet.csv", &text[..=cut]);
    let (_, said) = folder.succeeds(&["run", "imported.toml"]);
    assert!(has_changed(&said), "{said}");
}

#[test]
fn a_scenario_that_run_would_refuse_is_not_written() {
    let folder = Folder::new();
    let rows: String = (0..600).map(|k| format!("{}.{:02},{},0.5\n", k / 100, k % 100, (k * k) % 17)).collect();
    folder.file("constant.csv", &format!("t,force,displacement\n{rows}"));
    let error = folder.refused(&["import", "--out", "constant.toml", "constant.csv"]);
    assert!(error.contains("error: ") && error.contains("displacement") && !folder.has("constant.toml"), "{error}");
}

/// Two clocks in nanoseconds, as numbers above 2⁵³: a second more is the same number, and the import ends all the same, in words.
#[test]
fn two_clocks_in_nanoseconds_come_to_an_end() {
    let folder = Folder::new();
    let row = |k: u32| {
        let (x, later) = (f64::from(k), 10_000_000 * u64::from(k));
        let (first, second) = (1_714_564_800_023_500_000 + later, 1_714_564_800_000_000_000 + later);
        format!("{first},{:.3},{second},{:.3}\n", x.sin(), (0.3 * x).sin())
    };
    folder.file("clocks.csv", &("time,force,stamp,x\n".to_owned() + &(0..30).map(row).collect::<String>()));
    let (toml, said) = folder.succeeds(&["import", "clocks.csv"]);
    assert!(said.contains("the columns have clocks of their own, `time` and `stamp`"), "{said}");
    assert!(toml.contains("no start values of ωₙ and ζ could be found"), "{toml}");
}

/// The program's own record is held between samples: an import finds that, and says by how much.
#[test]
fn the_course_of_an_input_between_samples_is_found_and_said() {
    let folder = Folder::new();
    for (hold, name) in [("zero", "held"), ("first", "linear")] {
        let text = SCENARIO.replace("\"first\"", &format!("\"{hold}\"")).replace("dt = 0.04", "dt = 0.1");
        folder.file("truth.toml", &text);
        folder.succeeds(&["run", "--quiet", "--record-out", "record.csv", "truth.toml"]);
        folder.succeeds(&["import", "--out", "s.toml", "record.csv"]);
        let toml = folder.read("s.toml");
        assert!(
            toml.contains(&format!("the input is {name} between samples, the likeliest of linear, held and")),
            "{toml}"
        );
        assert_eq!(toml.contains("hold = \"first\""), hold == "first", "{toml}");
        let (table, _) = folder.succeeds(&["run", "s.toml"]);
        assert!((value(&table, "natural frequency") / 6.0 - 1.0).abs() < 0.003, "{table}");
    }
}

/// A file as phyphox writes it: two seconds of rest, and a free decay of 7 rad/s with 2 % damping.
fn phyphox() -> String {
    let mut text =
        "\"Time (s)\",\"Acceleration x (m/s^2)\",\"Acceleration y (m/s^2)\",\"Acceleration z (m/s^2)\"\n".to_owned();
    let noise = |n: f64| ((n * 12.9898).sin() * 43_758.545_3).fract();
    for k in 0..3000 {
        let t = f64::from(k) / 100.0;
        let a = if t < 2.0 { 0.0 } else { 1.8 * (-0.14 * (t - 2.0)).exp() * (7.0 * (t - 2.0)).cos() };
        let [x, y, z] = [1.0, 2.0, 3.0].map(|n| 0.03 * noise(n + f64::from(k)));
        text.push_str(&format!("{t:E},{:E},{:E},{:E}\n", 0.1 + 0.28 * a + x, 9.7 + 0.96 * a + y, z));
    }
    text
}

#[test]
fn the_free_decay_of_a_phone_is_imported() {
    let folder = Folder::new();
    folder.file("phone.csv", &phyphox());
    let (_, said) = folder.succeeds(&["import", "phone.csv", "--decay", "decay.csv", "--out", "decay.toml"]);
    assert!(said.contains("a free decay: ") && said.contains("along (0.28, 0.96, 0.0"), "{said}");
    let (_, table, _) = folder.call(&["run", "decay.toml"]);
    assert!((value(&table, "natural frequency") / 7.0 - 1.0).abs() < 0.002, "{table}");
    // An output is no input, and other files are refused in words.
    folder.refused(&["import", "phone.csv", "--decay", "phone.csv"]);
    folder.file("other.csv", "t,force,displacement\n0,0,0\n0.01,1,2\n0.02,1,3\n");
    let said = folder.refused(&["import", "other.csv", "--decay", "d.csv"]);
    assert!(said.contains("there are no three accelerations with a time"), "{said}");
}
