//! Arguments and files that are refused, and results that cannot be written.

use crate::{Folder, SAMPLE};

/// Two filters of which one weighs its readings, and a good verdict.
const TWO: &str = "duration = 4.0\n[plant]\nnatural_frequency = 6.0\n[[filters]]\nname = \"one\"\nkind = \"ekf\"\n\
                   [[filters]]\nname = \"other\"\nkind = \"ukf\"\nrobust = \"huber\"\n";

/// The command line, and a part of the sentence.
const REFUSED: &[(&str, &str)] = &[
    ("run", "<SCENARIO>"),
    ("run x.toml --speed 3", "--speed"),
    ("runn a.toml", "'run'"),
    ("run a.toml --record-ot b", "'--record-out'"),
    ("run missing.toml", "error: missing.toml: "),
    ("run two.toml --seed 9223372036854775808", "9223372036854775807"),
    ("run two.toml --fail-on bad", "recovered"),
    ("run two.toml --out a.pdf", "--out a.pdf: the ending must be .csv, .svg, .html, .json or .toml"),
    ("run two.toml --out a.toml", "--out a.toml: a scenario is written with --fix N only"),
    ("run two.toml --fix 1", "--out"),
    ("run two.toml --fix 1 --out a.csv", "--fix: --out must name the .toml file to write"),
    ("run right.toml --fix 1 --out a.toml", "there is nothing to fix"),
    ("run two.toml --record missing.csv", "error: missing.csv: "),
    ("run two.toml --record empty.csv", "error: empty.csv: the file is empty"),
    (
        "run two.toml --record no-sensor.csv",
        "the record does not measure velocity, but the scenario has a sensor for it",
    ),
    ("run two.toml --record word.csv", "error: word.csv: line 3, column `displacement`: `oops` is not a number"),
    (
        "run two.toml --record still-time.csv",
        "line 4: the time in `t` stands still from 1 s to 1 s: about 2 rows have the same time, as rounded ones: state the sample \
         rate, and the rows count as even",
    ),
    ("run two.toml --record short.csv", "1 row(s) of numbers remain, but at least 2 are needed"),
    ("run long.toml", "more than 1 MB"),
    ("run /dev/zero", "neither a file nor a pipe"),
    ("run .", "neither a file nor a pipe"),
    ("run two.toml --record /dev/zero", "neither a file nor a pipe"),
    ("run device.toml", "neither a file nor a pipe"),
    ("run word.csv", "this is a record, not a scenario: `kalmanscope-cli import"),
    ("import nowhere.csv", "error: nowhere.csv: "),
    ("import empty.csv", "empty.csv: the file is empty"),
    ("import binary.csv", "binary.csv: the file is not text"),
    ("import word.csv", "word.csv: line 3, column `displacement`: `oops` is not a number"),
    ("import unsorted.csv", "state the sample rate"),
    ("import good.csv --missing some", "expected a number, or `none`"),
    ("import good.csv --time-unit mm", "expected a unit of time"),
    ("import good.csv --band 60 90", "must be below the Nyquist frequency, 50 Hz"),
    ("import good.csv --with good.csv --offset 0", "--joined"),
    ("import good.csv --with short.csv --joined both.csv", "--offset"),
    ("import good.csv --with short.csv --joined short.csv --offset 0", "would overwrite"),
    ("import good.csv --with good.csv --joined both.csv --offset 500", "fewer than 2 samples in common"),
    ("import good.csv --decay d.csv", "there are no three accelerations with a time"),
    ("import still.csv --out a.toml", "still.csv: all readings of the displacement are the same"),
    ("sweep two.toml --out a.csv --vary plant.mass=1:2:3", "the scenario has no number `plant.mass` to vary"),
    ("sweep two.toml --out a.csv --vary seed=1:2", "is not an axis"),
    ("sweep two.toml --out a.csv --vary seed=1:3:3 --seeds 3", "two axes vary `seed`"),
    ("sweep two.toml --out a.csv --score speed", "is no score; there are nis"),
    ("sweep two.toml --out a.csv --filter KF", "no filter `KF`; its filters are `one` and `other`"),
    ("sweep two.toml --out a.csv --shard 4/3", "expected I/N"),
    ("sweep two.toml --out a.txt", "must be a .csv file, so that finished rows can be kept beside it, or -"),
    ("sweep two.toml --out - --vary filters.KF.fading=1:1.1:2", "to vary; its filters are `one` and `other`"),
    ("sweep two.toml --out - --vary filters.one.fading=1:1.1:2 --vary filters#1.fading=1:1.2:2", "`filters#1.fading`"),
    ("tune two.toml", "--turn"),
    ("tune two.toml --turn filters.one.mass", "the scenario has no number `filters.one.mass` to vary"),
    ("tune two.toml --turn filters.one.fading=1", "is not a range"),
    ("tune two.toml --turn plant.damping_ratio=0:1", "only settings of filters can be varied"),
    ("tune two.toml --turn filters.one.fading --filter UKF", "the scenario has no filter `UKF`"),
    ("tune two.toml --turn filters.one.fading --goal speed", "expected likelihood, consistency or free_run.SENSOR"),
    ("posterior two.toml --filter other", "there is no posterior: the filter weighs its readings"),
    ("posterior two.toml --filter third", "the scenario has no filter `third`"),
    ("population mass.toml", "no number `plant.mass`"),
    ("stream alone.toml -", "random members"),
    ("stream two.toml missing.csv", "missing.csv"),
];

#[test]
fn what_is_wrong_is_refused_in_a_sentence_and_nothing_is_written() {
    let folder = Folder::new();
    let even = |row: fn(u32) -> String| (0..600).map(|k| format!("{}.{:02},{}\n", k / 100, k % 100, row(k))).collect();
    let rows: [(&str, &str, String); 2] = [
        ("good.csv", "t,force,x\n", even(|k| format!("{},{}", k * k % 17, k * k % 23))),
        ("still.csv", "t,force,displacement\n", even(|k| format!("{},0.5", k * k % 17))),
    ];
    rows.iter().for_each(|(name, head, rows)| drop(folder.file(name, &format!("{head}{rows}"))));
    let right = "duration = 20.0\n[plant]\nnatural_frequency = 6.0\n[[filters]]\nname = \"right\"\n";
    for (name, text) in [
        ("two.toml", TWO),
        ("right.toml", right),
        ("mass.toml", "[draw]\n\"plant.mass\" = { normal = [1.0, 0.1] }\n"),
        ("alone.toml", "[[filters]]\nkind = \"pf\"\n"),
        ("device.toml", "[record]\nfile = \"/dev/zero\"\n[record.sensors.displacement]\ncolumn = \"x\"\n"),
        ("empty.csv", ""),
        ("binary.csv", "\x7FELF\0\0\x01"),
        ("no-sensor.csv", "t,force,displacement\n0,0,0\n1,0,0\n"),
        ("word.csv", "t,force,displacement,velocity\n0,0,0,0\n1,0,oops,0\n2,0,0,0\n"),
        ("still-time.csv", "t,force,displacement,velocity\n0,0,0,0\n1,0,0,0\n1,0,1,0\n"),
        ("short.csv", "t,force,displacement,velocity\n0,0,0,0\n"),
        ("unsorted.csv", "u;x\n2;1\n1;2\n3;3\n"),
    ] {
        folder.file(name, text);
    }
    folder.file("long.toml", &format!("{TWO}#{}", " ".repeat(1_000_000)));
    let before = folder.names();
    for (line, sentence) in REFUSED {
        let arguments: Vec<&str> = line.split(' ').collect();
        let (out, error) = folder.fails(&arguments, 2);
        assert!(out.is_empty() && error.contains(sentence), "{line}: {error}");
        let remarks = if line.starts_with("import still") { 4 } else { 0 };
        assert!(error.contains("--help") || error.lines().count() <= 1 + remarks, "{line}: {error}");
    }
    assert_eq!(folder.names(), before);
}

#[test]
fn bad_scenarios_are_refused_with_file_and_place() {
    for (toml, message) in [
        ("dt = 0.01\nsped = 3", "line 2: `sped`: unknown field `sped`, expected one of `seed`, `dt`, "),
        ("dt = 0", "`dt` is 0, but must be a finite number above 0"),
        ("duration = 86400", "the simulation has more than 2000000 samples; shorten `duration` or enlarge `dt`"),
        ("[[filters]]\nfading = 0.5", "`filters[0].fading` is 0.5, but must be a finite number, at least 1"),
        ("dt = \"a\"", "line 1: `dt`: invalid type: string \"a\", expected f64"),
        ("dt = ", "TOML parse error at line 1, column 6"),
    ] {
        let (code, out, error) = Folder::new().fed(&["run", "-", "--out", "never.csv"], toml.as_bytes());
        assert!(code == 2 && error.starts_with(&format!("error: standard input: {message}")), "{error}");
        assert_eq!(out, "");
    }
}

#[test]
fn failures_to_write_are_reported_after_everything_else_is_done() {
    let folder = Folder::of(SAMPLE);
    let outputs = ["--out", "none/a.csv", "--out", "none/a.svg", "--record-out", "record.csv"];
    let (table, error) = folder.fails(&[&["run", "scenario.toml", "-v"], &outputs[..]].concat(), 1);
    assert_eq!(error.matches("error: none/a.").count(), 2, "{error}");
    assert!(table.contains("mean NIS") && folder.has("record.csv"));
}

#[test]
fn a_closed_pipe_is_not_an_error() {
    let folder = Folder::of(SAMPLE);
    let mut child = folder.command(&["run", "scenario.toml", "--out", "estimates.csv"]).spawn().unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), output.stderr.len()), (Some(0), 0));
    assert_eq!(folder.read("estimates.csv").lines().count(), 6002);
}
