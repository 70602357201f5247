//! The built command, called as from a script.
#![expect(clippy::unwrap_used, reason = "a helper that fails is a test that fails")]

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

const SAMPLE: &str = include_str!("../../core/tests/sample.toml");

/// The page for authors, which has a lesson.
const AUTHORS: &str = include_str!("../../lessons/README.md");

const HEADER: &str = "filter,k,t,displacement,velocity,natural_frequency,damping_ratio,std_displacement,std_velocity,\
                      std_natural_frequency,std_damping_ratio,nis,log_likelihood,innovation_displacement,\
                      innovation_velocity,innovation_std_displacement,innovation_std_velocity,predicted_displacement,\
                      predicted_velocity";

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn file(folder: &TempDir, name: &str, text: &str) -> PathBuf {
    let path = folder.path().join(name);
    std::fs::write(&path, text).unwrap();
    path
}

fn command() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_kalmanscope-cli"));
    command.arg("run");
    command
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// Runs a command that must succeed with nothing on standard error; returns its standard output.
#[track_caller]
fn succeeds(command: &mut Command) -> String {
    let Output { status, stdout, stderr } = command.output().unwrap();
    assert_eq!((status.code(), text(&stderr).as_str()), (Some(0), ""), "{command:?}");
    text(&stdout)
}

/// Runs a command that must fail with this code; returns standard output and standard error.
#[track_caller]
fn fails(command: &mut Command, code: i32) -> (String, String) {
    let Output { status, stdout, stderr } = command.output().unwrap();
    assert_eq!(status.code(), Some(code), "{command:?}: {}", text(&stderr));
    (text(&stdout), text(&stderr))
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap()
}

#[test]
fn the_sample_runs_and_prints_its_results() {
    let folder = folder();
    let out = folder.path().join("estimates.csv");
    let table = succeeds(command().arg(file(&folder, "sample.toml", SAMPLE)).arg("--out").arg(&out));
    for part in
        ["6001 samples", "EKF with fading memory", "ωₙ", "rad/s", "±", "mean NIS", "χ²", "log likelihood", " ns"]
    {
        assert!(table.contains(part), "{part} in\n{table}");
    }
    let frequency = table.lines().find(|line| line.contains("natural frequency")).unwrap();
    assert!(frequency.contains(" 4.7") || frequency.contains(" 4.8"), "{frequency}");

    let estimates = read(&out);
    let mut lines = estimates.lines();
    assert_eq!(lines.next(), Some(HEADER));
    let first: Vec<&str> = lines.next().unwrap().split(',').collect();
    assert_eq!(first[..3], ["EKF with fading memory", "0", "0.0000000000000000e0"]);
    assert_eq!(first[5], "8.0000000000000000e0");
    assert_eq!(first[11..], ["nan"; 8]);
    assert_eq!(lines.count(), 6000);
}

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

/// A scenario of the menu that names a record is all that is needed, but a file beside it goes before.
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

#[test]
fn the_seed_can_be_chosen() {
    let folder = folder();
    let sample = file(&folder, "sample.toml", SAMPLE);
    let record = |name: &str, seed: Option<&str>| {
        let path = folder.path().join(name);
        succeeds(
            command().arg(&sample).arg("--record-out").arg(&path).args(seed.map(|n| ["--seed", n]).iter().flatten()),
        );
        read(&path)
    };
    let own = record("own.csv", None);
    assert_eq!(own, record("one.csv", Some("1")));
    assert_ne!(own, record("two.csv", Some("2")));
    let (_, error) = fails(command().arg(&sample).args(["--seed", "9223372036854775808"]), 2);
    assert!(error.contains("--seed") && error.contains("9223372036854775807"), "{error}");
}

#[test]
fn a_picture_is_drawn_and_stays_small() {
    let folder = folder();
    let (picture, names) = (
        folder.path().join("plots.svg"),
        ["<plain> & \"simple\"", "a very, very long name ".repeat(9).trim()].map(str::to_owned),
    );
    let filters: String = names.iter().map(|name| format!("[[filters]]\nname = '{name}'\n")).collect();
    let many = "[[filters]]\nkind = \"ukf\"\n".repeat(14);
    let scenario = file(&folder, "many.toml", &format!("duration = 120.0\n{filters}{many}"));
    let table = succeeds(command().arg(&scenario).arg("--svg").arg(&picture));
    assert!(names.iter().all(|name| table.contains(name)), "{table}");
    let svg = read(&picture);
    assert!(svg.starts_with("<svg ") && svg.trim_end().ends_with("</svg>"));
    assert!((100_000..1_500_000).contains(&svg.len()), "{} bytes", svg.len());
    for part in ["&lt;plain&gt; &amp;", "natural frequency ωₙ [rad/s]", "time t [s]", "truth", "measurement", "#0072B2"]
    {
        assert!(svg.contains(part), "{part}");
    }
    assert!(!svg.contains("NaN") && !svg.contains("<plain>"));
}

#[test]
fn bare_scenarios_are_drawn_too() {
    for toml in ["filters = []\nsensors = []", "duration = 0.01\nforce = \"none\"", "sensors = []\nduration = 1.0"] {
        let folder = folder();
        let picture = folder.path().join("plots.svg");
        let table = succeeds(command().arg(file(&folder, "bare.toml", toml)).arg("--svg").arg(&picture));
        assert!(table.contains(" samples from 0 s"), "{table}");
        assert!(read(&picture).matches("<polyline").count() > 8, "{toml}");
    }
}

#[test]
fn a_scenario_can_come_from_standard_input() {
    let mut child =
        command().arg("-").stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    child.stdin.take().unwrap().write_all(b"dt = -1").unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(text(&output.stderr), "error: standard input: `dt` is -1, but must be a finite number above 0\n");
}

#[test]
fn bad_scenarios_are_refused_with_file_and_place() {
    let folder = folder();
    let missing = folder.path().join("missing.toml");
    let (table, error) = fails(command().arg(&missing), 2);
    assert!(table.is_empty() && error.starts_with(&format!("error: {}: ", missing.display())), "{error}");
    for (toml, message) in [
        ("dt = 0.01\nsped = 3", "line 2: `sped`: unknown field `sped`, expected one of `seed`, `dt`, "),
        ("dt = 0", "`dt` is 0, but must be a finite number above 0"),
        ("duration = 86400", "`duration` is 2000000 times dt or more, but every sample is kept here"),
        ("[[filters]]\nfading = 0.5", "`filters[0].fading` is 0.5, but must be a finite number, at least 1"),
        ("dt = \"a\"", "line 1: `dt`: invalid type: string \"a\", expected f64"),
        ("dt = ", "TOML parse error at line 1, column 6"),
    ] {
        let path = file(&folder, "bad.toml", toml);
        let out = folder.path().join("never.csv");
        let (table, error) = fails(command().arg(&path).arg("--out").arg(&out), 2);
        assert!(error.starts_with(&format!("error: {}: {message}", path.display())), "{error}");
        assert!(table.is_empty() && !out.exists());
    }
}

#[test]
fn bad_records_are_refused_with_file_and_place() {
    let folder = folder();
    let sample = file(&folder, "sample.toml", SAMPLE);
    let missing = folder.path().join("missing.csv");
    let (_, error) = fails(command().arg(&sample).arg("--record").arg(&missing), 2);
    assert!(error.starts_with(&format!("error: {}: ", missing.display())), "{error}");
    for (record, message) in [
        (
            "t,force,displacement\n0,0,0\n1,0,0\n",
            "the record does not measure velocity, but the scenario has a sensor for it\n",
        ),
        (
            "t,force,displacement,velocity\n0,0,0,0\n1,0,oops,0\n",
            "line 3, column `displacement`: `oops` is not a number\n",
        ),
        (
            "t,force,displacement,velocity\n0,0,0,0\n1,0,0,0\n1,0,0,0\n",
            "line 4: the time stands still from 1 s to 1 s\n",
        ),
        ("t,force,displacement,velocity\n0,0,0,0\n", "1 row(s) of numbers remain, but at least 2 are needed\n"),
        ("", "the file is empty\n"),
    ] {
        let path = file(&folder, "bad.csv", record);
        let (table, error) = fails(command().arg(&sample).arg("--record").arg(&path), 2);
        assert!(error.starts_with(&format!("error: {}: {message}", path.display())), "{error}");
        assert!(table.is_empty());
    }
}

#[test]
fn failures_to_write_are_reported_after_everything_else_is_done() {
    let folder = folder();
    let sample = file(&folder, "sample.toml", SAMPLE);
    let good = folder.path().join("record.csv");
    for option in ["--out", "--svg"] {
        let nowhere = folder.path().join("no such folder/file");
        let (table, error) = fails(command().arg(&sample).arg(option).arg(&nowhere).arg("--record-out").arg(&good), 1);
        assert!(error.starts_with(&format!("error: {}: ", nowhere.display())), "{error}");
        assert!(table.contains("mean NIS") && good.exists());
        std::fs::remove_file(&good).unwrap();
    }
}

#[test]
fn a_filter_that_stops_is_reported_and_keeps_its_estimates() {
    let folder = folder();
    let toml = "duration = 5.0\n[[filters]]\nname = \"wild\"\nfading = 1e60\n[[filters]]\nname = \"tame\"\n";
    let (out, picture) = (folder.path().join("estimates.csv"), folder.path().join("plots.svg"));
    let stopping = file(&folder, "stopping.toml", toml);
    let (table, error) = fails(command().arg(stopping).arg("--out").arg(&out).arg("--svg").arg(&picture), 1);
    assert_eq!(error, "");
    let told = table.lines().find(|line| line.contains("stopped at sample ")).unwrap();
    let sample: usize = told.split_whitespace().nth(3).unwrap().parse().unwrap();
    assert!(told.contains("(t = 0.") && told.contains(": the "), "{told}");
    let estimates = read(&out);
    let rows = |name: &str| estimates.lines().filter(|line| line.starts_with(name)).count();
    assert!(sample > 1 && sample < 500);
    assert_eq!((rows("wild,"), rows("tame,")), (sample, 501));
    assert!(read(&picture).contains("wild (EKF), stopped at 0."));
}

#[test]
fn a_closed_pipe_is_not_an_error() {
    let folder = folder();
    let out = folder.path().join("estimates.csv");
    let sample = file(&folder, "sample.toml", SAMPLE);
    let mut child =
        command().arg(sample).arg("--out").arg(&out).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), text(&output.stderr).as_str()), (Some(0), ""));
    assert_eq!(read(&out).lines().count(), 6002);
}

#[test]
fn the_command_line_is_checked() {
    let (_, error) = fails(&mut command(), 2);
    assert!(error.contains("<SCENARIO>"), "{error}");
    let (_, error) = fails(command().args(["x.toml", "--speed", "3"]), 2);
    assert!(error.contains("--speed"), "{error}");
    let help = succeeds(command().arg("--help"));
    assert!(
        ["--record", "--seed", "--out", "--record-out", "--svg", "--fail-on"]
            .iter()
            .all(|option| help.contains(option)),
        "{help}"
    );
}

#[test]
fn estimates_have_the_signs_of_the_table() {
    let folder = folder();
    let mirrored = SAMPLE
        .replace("natural_frequency = 8.0, damping_ratio = 0.1", "natural_frequency = -8.0, damping_ratio = -0.1");
    assert_ne!(mirrored, SAMPLE);
    let sample = file(&folder, "sample.toml", &mirrored);
    let out = folder.path().join("estimates.csv");
    succeeds(command().arg(&sample).arg("--out").arg(&out));
    let text = read(&out);
    let header: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    let column = header.iter().position(|name| *name == "natural_frequency").unwrap();
    let frequencies: Vec<f64> =
        text.lines().skip(1).map(|line| line.split(',').nth(column).unwrap().parse().unwrap()).collect();
    assert!(frequencies.len() > 1000 && frequencies.iter().all(|wn| *wn >= 0.0), "{:?}", &frequencies[..3]);
}

#[test]
fn verdicts_have_evidence_causes_and_an_exit_code() {
    let folder = folder();
    let toml = "duration = 20.0\n[plant]\nnatural_frequency = 6.0\n[[filters]]\nname = \"wrong\"\nsensor_std = [0.05, 0.3]\n\
                [[filters]]\nname = \"right\"\n";
    let scenario = file(&folder, "scenario.toml", toml);
    let table = succeeds(command().arg(&scenario));
    let (_, wrong) = table.split_once("\nwrong (EKF)\n").unwrap();
    let (wrong, right) = wrong.split_once("\nright (EKF)\n").unwrap();
    let mut lines = wrong.lines();
    assert!(lines.next().unwrap().starts_with("  underconfident: innovations² of the "), "{wrong}");
    assert!(lines.next().unwrap().starts_with("    innovations of "), "{wrong}");
    let cause =
        wrong.lines().position(|line| line.starts_with("  cause 1: R of a sensor: R of the displacement is ")).unwrap();
    let lines: Vec<&str> = wrong.lines().collect();
    assert!(lines[cause].ends_with(", then consistent)"), "{}", lines[cause]);
    assert!(lines[cause + 1].starts_with("    write in its [[filters]]: sensor_std = [0.0"), "{}", lines[cause + 1]);
    assert!(right.starts_with("  consistent: ") && !right.contains("cause"), "{right}");

    succeeds(command().arg(&scenario).args(["--fail-on", "overconfident,diverged,lost"]));
    let (same, error) = fails(command().arg(&scenario).args(["--fail-on", "underconfident,lost"]), 3);
    assert!(error.starts_with("--fail-on: the verdict on wrong is underconfident\n"), "{error}");
    assert!(same.contains("underconfident"), "{same}");
    let (_, error) = fails(command().arg(&scenario).args(["--fail-on", "bad"]), 2);
    assert!(error.contains("consistent-but-for-a-time"), "{error}");
}

/// The command that checks a lesson, and the lesson of the page for authors.
fn lesson() -> (Command, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_kalmanscope-cli"));
    command.arg("lesson");
    let lesson = AUTHORS.split_once("```toml\n").and_then(|(_, rest)| rest.split_once("```")).unwrap().0;
    (command, lesson.to_owned())
}

#[test]
fn the_claims_of_a_lesson_are_tried() {
    let folder = folder();
    let (mut command, text) = lesson();
    let lines = succeeds(command.arg(file(&folder, "lesson.toml", &text)));
    let lines: Vec<&str> = lines.lines().collect();
    assert_eq!(lines.len(), 4, "{lines:?}");
    assert!(lines[..3].iter().all(|line| line.starts_with("holds ")), "{lines:?}");
    assert!(lines[0].contains("A filter that forgets, step 1: nis of EKF from 30 s to 35 s, above 20.0"), "{lines:?}");
    assert_eq!(lines[3], "3 claims on 10 seeds: 0 fail");
}

#[test]
fn a_claim_that_fails_is_printed_and_has_an_exit_code() {
    let folder = folder();
    let (mut command, text) = lesson();
    let wrong = file(&folder, "lesson.toml", &text.replace("above = 20.0", "below = 20.0"));
    let (lines, message) = fails(command.arg(wrong).args(["--seeds", "3"]), 1);
    assert_eq!(message, "");
    assert!(lines.starts_with("FAILS   0.0 % (98 %)  A filter that forgets, step 1"), "{lines}");
    assert!(lines.ends_with("3 claims on 3 seeds: 1 fail\n"), "{lines}");
}

#[test]
fn bad_lessons_are_refused_with_file_and_place() {
    let folder = folder();
    let text = lesson().1;
    for (part, other, message) in [
        ("look = ", "lok = ", "lok"),
        ("answer = 2", "answer = 3", "step 1: the question has the `answer` 3"),
        ("filters.EKF.fading\" = 1.02", "filters.EKF.fadng\" = 1.02", "step 2: the scenario has no setting"),
        ("above = 20.0", "", "step 1: the check of `nis` needs `above` or `below`"),
        ("stiffness-loss", "stiffness", "there is no built-in scenario `stiffness`"),
    ] {
        let path = file(&folder, "bad.toml", &text.replacen(part, other, 1));
        let (lines, error) = fails(lesson().0.arg(path), 2);
        assert_eq!(lines, "");
        assert!(error.contains("bad.toml: ") && error.contains(message), "{error}");
    }
    let (_, error) = fails(lesson().0.arg(folder.path().join("none.toml")), 2);
    assert!(error.contains("none.toml"), "{error}");
}
