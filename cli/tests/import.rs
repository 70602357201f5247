//! Measured records on the command line, from the file to the free run.

use crate::{Folder, sheet, value};

const SCENARIO: &str = "duration = 60.0\ndt = 0.04\nhold = \"first\"\nseed = 5\n[plant]\nnatural_frequency = 6.0\n\
                        [[sensors]]\nmeasures = \"displacement\"\nnoise_std = 0.002\n[[filters]]\nkind = \"ekf\"\n";

/// A folder with simulated records as a spreadsheet writes them, with a line of units, each of a seed.
fn folder(records: &[(&str, &str)]) -> Folder {
    let folder = Folder::of(SCENARIO);
    for (name, seed) in records {
        folder.succeeds(&["run", "scenario.toml", "--seed", seed, "--record-out", "record.csv"]);
        folder.file(name, &("Zeit;Kraft;Weg\ns;;mm\n".to_owned() + &sheet(&folder.read("record.csv"), 1.0)));
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
    let (table, remarks) = folder.succeeds(&["run", "--verbose", "--holdout", "b.csv", "a.toml"]);
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
    for words in [&["--no-input"][..], &asked] {
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
