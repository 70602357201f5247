//! Readings in, estimates out.

use std::io::{BufRead as _, BufReader, Write as _};

use kalmanscope_core::document;
use kalmanscope_core::{Scenario, simulate};

use crate::{Folder, SAMPLE};

const STREAM: [&str; 3] = ["stream", "scenario.toml", "-"];

#[test]
fn a_stream_of_a_record_ends_where_its_run_does() {
    let folder = Folder::of(SAMPLE);
    let run = ["run", "scenario.toml", "--quiet", "--record-out", "-", "--out", "estimates.csv"];
    let record = folder.quietly(&run);
    let (code, table, error) = folder.fed(&STREAM, record.as_bytes());
    assert_eq!((error.as_str(), code), ("", 0));
    let scenario = Scenario::from_toml(SAMPLE).unwrap();
    assert_eq!(table.lines().count(), simulate(&scenario).len() + 1, "a header, and a line a sample");
    let cells = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
    let (header, last) = (cells(table.lines().next().unwrap()), cells(table.lines().last().unwrap()));
    let estimates = folder.read("estimates.csv");
    let names = cells(estimates.lines().next().unwrap());
    let mut compared = 0;
    for name in scenario.filters.iter().map(|filter| filter.name.as_str()) {
        let row = cells(estimates.lines().rfind(|line| line.starts_with(&format!("{name},"))).unwrap());
        for (column, value) in names.iter().zip(&row).filter(|(column, _)| column.starts_with("std_")) {
            let Some(place) = header.iter().position(|one| *one == format!("{name}.{column}")) else { continue };
            let [found, expected]: [f64; 2] = [&last[place], value].map(|cell| cell.parse().unwrap());
            assert!((found - expected).abs() <= 1e-6 * expected, "{name} {column}: {found} {expected}");
            compared += 1;
        }
    }
    assert!(compared >= 4, "{compared}");
}

#[test]
fn hindsight_comes_with_a_look_ahead() {
    let text = format!("{SAMPLE}\n[[filters]]\nname = \"late\"\nsmoother = true\nlook_ahead = 0.2\n");
    let folder = Folder::of(&text);
    let dt = Scenario::from_toml(&text).unwrap().dt;
    let record = folder.quietly(&["run", "scenario.toml", "--quiet", "--record-out", "-"]);
    let (code, table, error) = folder.fed(&STREAM, record.as_bytes());
    assert_eq!((error.as_str(), code), ("", 0));
    let rows: Vec<Vec<&str>> = table.lines().map(|line| line.split(',').collect()).collect();
    assert!(rows.iter().all(|row| row.len() == rows[0].len()), "every row has every column");
    let column =
        |name: &str| rows[0].iter().position(|one| *one == name).unwrap_or_else(|| panic!("{name}: {:?}", rows[0]));
    assert_eq!(rows[0].iter().filter(|name| name.ends_with("hindsight_t")).count(), 1, "of that filter alone");
    let [t, then] = ["t", "late.hindsight_t"].map(column);
    let [at_once, later] = ["late.std_displacement", "late.hindsight_std_displacement"].map(column);
    let waits = (0.2 / dt).round() as usize;
    let number = |row: usize, column: usize| rows[row][column].parse::<f64>().unwrap();
    assert!(rows[1..=waits].iter().all(|row| row[then].is_empty()), "nothing is old enough");
    for row in waits + 1..rows.len() {
        assert!((number(row, t) - number(row, then) - 0.2).abs() < 1e-9);
        assert!(number(row, later) <= number(row - waits, at_once), "row {row}");
    }
    let (_, lines, _) = folder.fed(&[&STREAM[..], &["--json"]].concat(), record.as_bytes());
    let last = document::from_json(lines.lines().last().unwrap()).unwrap();
    assert!(last["late"]["hindsight_t"].is_f64() && last["late"]["hindsight_natural_frequency"].is_f64(), "{last}");
    let first = document::from_json(lines.lines().next().unwrap()).unwrap();
    assert!(first["late"]["hindsight_t"].is_null(), "nothing is old enough");
}

#[test]
fn every_line_is_answered_at_once() {
    let folder = Folder::of(SAMPLE);
    let mut child = folder.command(&["stream", "scenario.toml", "--json"]).spawn().unwrap();
    let mut to = child.stdin.take().unwrap();
    let mut from = BufReader::new(child.stdout.take().unwrap());
    for k in 0..5 {
        // A sensor with its own clock, and one that is late by a step and a half.
        writeln!(to, "{{\"t\": {}, \"force\": 1.0}}", 0.01 * f64::from(k)).unwrap();
        writeln!(to, "{{\"t\": {}, \"displacement\": 0.001}}", (0.01 * f64::from(k) - 0.015).max(0.001)).unwrap();
        for _ in 0..2 {
            let mut line = String::new();
            from.read_line(&mut line).unwrap();
            let time = document::from_json(&line).unwrap()["t"].as_f64().expect(&line);
            assert!(time >= 0.01 * f64::from(k) - 1e-12, "{line}");
        }
    }
    drop(to);
    assert!(child.wait().unwrap().success());
}

#[test]
fn bad_lines_are_said_and_left_out() {
    let folder = Folder::of(SAMPLE);
    let lines = "t,displacement\n0,0\n0.01,0.001\noops,1\n0.02\n0.02,inf\n1e300,0\n0.03,0.002\n";
    let (code, table, error) = folder.fed(&STREAM, lines.as_bytes());
    assert_eq!((table.lines().count(), code), (4, 0), "{table}");
    for words in [
        "line 4: `t` is “oops”, but must be a number; it is left out",
        "line 5: it has 1 cells, but the header has 2; it is left out",
        "line 6: the reading of displacement is infinite, but must be a number or NaN; it is left out",
        "line 7: the time is 1e300 s",
    ] {
        assert!(error.contains(words), "{error}");
    }
    let (code, _, error) = folder.fed(&STREAM, b"0.1,0.2\n");
    assert!(error.contains("a header such as `t,force,displacement,velocity` must come first"), "{error}");
    assert_eq!(code, 0);
}

#[test]
fn filters_that_count_samples_are_left_out_in_words() {
    let both = "[[filters]]\nname = \"P\"\nkind = \"pf\"\n[[filters]]\nname = \"E\"\nkind = \"ekf\"\n";
    let folder = Folder::of(both);
    let (code, table, error) = folder.fed(&STREAM, b"t,displacement\n0,0\n");
    assert!(table.starts_with("t,E.displacement,"), "{table}");
    assert_eq!(
        (error.trim_end(), code),
        ("P is left out: a filter with random members follows samples at equal times only", 0)
    );
}
