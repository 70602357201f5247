//! Outputs of the built command: written whole or not at all, never over an input, and told by the exit code.
#![cfg(unix)]
#![expect(clippy::unwrap_used, reason = "a helper that fails is a test that fails")]

use std::fs;
use std::io::Write as _;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

const SCENARIO: &str = "duration = 5.0\n[[filters]]\nname = \"one\"\n";

struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn file(&self, name: &str, text: &str) -> PathBuf {
        fs::write(self.path(name), text).unwrap();
        self.path(name)
    }

    fn names(&self) -> Vec<String> {
        let names = fs::read_dir(self.0.path()).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> = names.collect();
        names.sort();
        names
    }

    /// Runs the command in the folder. Returns the exit code, standard output and standard error.
    fn call(&self, arguments: &[&str], input: &[u8]) -> (i32, String, String) {
        let mut command = Command::new(env!("CARGO_BIN_EXE_kalmanscope-cli"));
        command.current_dir(self.0.path()).args(arguments);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        // A command that does not read its input closes it.
        let _ = child.stdin.take().unwrap().write_all(input);
        let Output { status, stdout, stderr } = child.wait_with_output().unwrap();
        (status.code().unwrap(), String::from_utf8(stdout).unwrap(), String::from_utf8(stderr).unwrap())
    }

    /// A record as a laboratory writes it, and its scenario.
    fn measured(&self) -> (PathBuf, PathBuf) {
        let truth = "duration = 40.0\ndt = 0.04\nhold = \"first\"\n[plant]\nnatural_frequency = 6.0\n\
                     [[sensors]]\nmeasures = \"displacement\"\nnoise_std = 0.002\n";
        self.file("truth.toml", truth);
        assert_eq!(self.call(&["run", "truth.toml", "--record-out", "plain.csv"], b"").0, 0);
        let mut sheet = "Zeit [s];Kraft;Weg [mm]\n".to_owned();
        for line in read(&self.path("plain.csv")).lines().skip(1) {
            let cells: Vec<f64> = line.split(',').take(3).map(|cell| cell.parse().unwrap()).collect();
            sheet.push_str(&format!("{:.2};{:.5};{:.4}\n", cells[0], cells[1], 1000.0 * cells[2]).replace('.', ","));
        }
        let record = self.file("sheet.csv", &sheet);
        assert_eq!(self.call(&["import", "sheet.csv", "--out", "sheet.toml"], b"").0, 0);
        (record, self.path("sheet.toml"))
    }
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap()
}

#[test]
fn an_output_is_never_an_input() {
    let folder = Folder::new();
    let (record, scenario) = folder.measured();
    let (sheet, settings) = (read(&record), read(&scenario));
    symlink("sheet.csv", folder.path("link.csv")).unwrap();
    fs::hard_link(&record, folder.path("hard.csv")).unwrap();
    let before = folder.names();
    for arguments in [
        &["run", "truth.toml", "--record", "sheet.csv", "--out", "sheet.csv"][..],
        &["run", "sheet.toml", "--out", "./sheet.csv"],
        &["run", "sheet.toml", "--svg", "link.csv"],
        &["run", "sheet.toml", "--record-out", "hard.csv"],
        &["run", "sheet.toml", "--holdout", "plain.csv", "--out", "plain.csv"],
        &["run", "sheet.toml", "--then", "plain.csv", "--out", "plain.csv"],
        &["run", "sheet.toml", "--out", "sheet.toml"],
        &["run", "sheet.toml", "--out", "new.csv", "--svg", "new.csv"],
        &["run", "sheet.toml", "--out", "-", "--svg", "-"],
        &["report", "sheet.toml", "--out", "sheet.toml"],
        &["import", "sheet.csv", "--out", "sheet.csv"],
        &["sweep", "sheet.toml", "--out", "sheet.csv"],
        &["tune", "sheet.toml", "--turn", "filters.EKF.fading", "--out", "sheet.toml"],
    ] {
        let (code, out, error) = folder.call(arguments, b"");
        assert_eq!((code, out.as_str()), (2, ""), "{arguments:?}: {error}");
        assert!(error.contains(" would overwrite ") && error.lines().count() == 1, "{arguments:?}: {error}");
    }
    assert_eq!((read(&record), read(&scenario), folder.names()), (sheet, settings, before));
    let (code, _, error) = folder.call(&["run", "-", "--record", "-"], SCENARIO.as_bytes());
    assert!(code == 2 && error.contains("standard input is named twice"), "{error}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_result_that_cannot_be_written_is_told_by_each_command() {
    let folder = Folder::new();
    folder.measured();
    folder.file("scenario.toml", SCENARIO);
    for arguments in [
        &["run", "scenario.toml", "--out", "/dev/full"][..],
        &["run", "scenario.toml", "--svg", "/dev/full"],
        &["run", "scenario.toml", "--record-out", "/dev/full"],
        &["report", "scenario.toml", "--out", "/dev/full"],
        &["import", "sheet.csv", "--out", "/dev/full"],
        &["import", "sheet.csv", "--out", "nowhere/new.toml"],
        &["tune", "scenario.toml", "--turn", "filters.one.fading=1:1.1", "--out", "/dev/full"],
        &["sweep", "scenario.toml", "--out", "nowhere/new.csv"],
    ] {
        let (code, _, error) = folder.call(arguments, b"");
        let is_told = error.lines().any(|line| line.starts_with("error: "));
        assert!(code == 1 && is_told, "{arguments:?}: {code} {error}");
    }
    for arguments in [
        &["import", "sheet.csv"][..],
        &["run", "scenario.toml"],
        &["tune", "scenario.toml", "--turn", "filters.one.fading=1:1.1"],
    ] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_kalmanscope-cli"));
        let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let output = command.current_dir(folder.0.path()).args(arguments).stdout(full).output().unwrap();
        let error = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.code() == Some(1) && error.contains("standard output: "), "{arguments:?}: {error}");
    }
}

#[test]
fn a_measured_record_runs_again_with_its_scenario() {
    let folder = Folder::new();
    folder.measured();
    let first = folder.call(&["run", "sheet.toml", "--out", "a.csv", "--record-out", "again.csv"], b"");
    assert_eq!(first.0, 0, "{}", first.2);
    let second = folder.call(&["run", "sheet.toml", "--record", "again.csv", "--out", "b.csv"], b"");
    assert_eq!(second.0, 0, "{}", second.2);
    assert!(read(&folder.path("a.csv")).lines().count() > 1000);
    assert_eq!(read(&folder.path("a.csv")), read(&folder.path("b.csv")));
}

#[test]
fn records_come_through_pipes_and_are_read_once() {
    let folder = Folder::new();
    let (record, scenario) = folder.measured();
    let bytes = fs::read(&record).unwrap();
    let line = |text: &str, key: &str| text.lines().find(|line| line.starts_with(key)).map(str::to_owned);
    for file in ["-", "/dev/stdin"] {
        let (code, out, error) = folder.call(&["import", file], &bytes);
        assert_eq!(code, 0, "{error}");
        assert_eq!(line(&out, "hash = "), line(&read(&scenario), "hash = "));
        assert_eq!(line(&out, "file = "), None);
    }
    let plain = folder.call(&["run", "sheet.toml", "--out", "a.csv"], b"");
    let piped = folder.call(&["run", "sheet.toml", "--record", "-", "--out", "b.csv"], &bytes);
    assert_eq!((plain.0, piped.0), (0, 0), "{}", piped.2);
    assert_eq!(read(&folder.path("a.csv")), read(&folder.path("b.csv")));
    let (code, out, error) = folder.call(&["run", "sheet.toml", "--holdout", "-"], &bytes);
    assert!(code == 0 && out.contains("free run of the final models over "), "{error}");
    let made = Command::new("mkfifo").arg(folder.path("pipe")).status().unwrap();
    assert!(made.success());
    let (pipe, sent) = (folder.path("pipe"), bytes.clone());
    let writer = std::thread::spawn(move || fs::write(pipe, sent).unwrap());
    let (code, out, error) = folder.call(&["import", "pipe"], b"");
    writer.join().unwrap();
    assert!(code == 0 && line(&out, "hash = ") == line(&read(&scenario), "hash = "), "{error}");
}

#[test]
fn a_dash_is_standard_output_and_the_table_goes_beside() {
    let folder = Folder::new();
    folder.file("scenario.toml", SCENARIO);
    let (code, out, error) = folder.call(&["run", "scenario.toml", "--out", "-"], b"");
    assert_eq!(code, 0, "{error}");
    assert!(out.starts_with("filter,k,t,") && !out.contains("mean NIS") && error.contains("mean NIS"), "{out}{error}");
    assert_eq!(folder.names(), ["scenario.toml"]);
}

#[test]
fn only_short_texts_in_files_and_pipes_are_read() {
    let folder = Folder::new();
    folder.file("scenario.toml", SCENARIO);
    folder.file("long.toml", &format!("{SCENARIO}#{}", " ".repeat(1_000_000)));
    folder.file("device.toml", "[record]\nfile = \"/dev/zero\"\n[record.sensors.displacement]\ncolumn = \"x\"\n");
    for (arguments, sentence) in [
        (&["run", "long.toml"][..], "more than 1 MB"),
        (&["lesson", "long.toml"], "more than 1 MB"),
        (&["run", "/dev/zero"], "neither a file nor a pipe"),
        (&["run", "."], "neither a file nor a pipe"),
        (&["run", "scenario.toml", "--record", "/dev/zero"], "neither a file nor a pipe"),
        (&["run", "scenario.toml", "--record", "scenario.toml", "--map", "/dev/zero"], "neither a file nor a pipe"),
        (&["run", "device.toml"], "neither a file nor a pipe"),
    ] {
        let (code, _, error) = folder.call(arguments, b"");
        assert!(code == 2 && error.contains(sentence) && error.lines().count() == 1, "{arguments:?}: {error}");
    }
}

#[test]
fn names_are_harmless_in_tables_and_messages() {
    let folder = Folder::new();
    folder.file("formula.toml", "duration = 1.0\n[[filters]]\nname = \"=1+1\"\n[[filters]]\nname = \"-x\"\n");
    let (code, _, error) = folder.call(&["run", "formula.toml", "--out", "estimates.csv"], b"");
    assert_eq!(code, 0, "{error}");
    let rows = read(&folder.path("estimates.csv"));
    assert!(rows.lines().skip(1).all(|row| row.starts_with("'=1+1,") || row.starts_with("'-x,")));
    assert!(rows.contains(",-"), "numbers keep their signs");
    folder.file("steering.toml", "\"\\u001b]0;title\\u0007\\u202e\" = 1\n");
    let (code, _, error) = folder.call(&["run", "steering.toml"], b"");
    assert!(code == 2 && !error.chars().any(|c| c == '\u{1b}' || c == '\u{7}' || c == '\u{202e}'), "{error:?}");
}

#[test]
fn a_file_of_others_is_no_part_of_a_sweep() {
    let folder = Folder::new();
    folder.file("scenario.toml", SCENARIO);
    folder.file("table.csv.part", "my own notes\n");
    let sweep = ["sweep", "scenario.toml", "--vary", "filters.one.fading=1:1.1:3", "--out", "table.csv"];
    let (code, _, error) = folder.call(&sweep, b"");
    assert!(code == 2 && error.contains("table.csv.part") && error.contains("stays as it is"), "{error}");
    assert_eq!(read(&folder.path("table.csv.part")), "my own notes\n");
    folder.file("table.csv.part", "# sweep 0123456789abcdef\na,b\n1,2\n");
    let (code, _, error) = folder.call(&sweep, b"");
    assert!(code == 0 && error.contains("of another sweep, and is begun anew"), "{error}");
    assert_eq!((read(&folder.path("table.csv")).lines().count(), folder.names().len()), (4, 2));
}

#[test]
fn many_threads_are_cut_to_the_work() {
    let folder = Folder::new();
    folder.file("scenario.toml", SCENARIO);
    let sweep = ["sweep", "scenario.toml", "--vary", "filters.one.fading=1:1.1:3", "--out", "t.csv"];
    let (code, _, error) = folder.call(&[&sweep[..], &["--threads", "100000000"]].concat(), b"");
    assert_eq!((code, read(&folder.path("t.csv")).lines().count()), (0, 4), "{error}");
}

#[test]
fn a_record_in_place_of_a_scenario_is_known_as_one() {
    let folder = Folder::new();
    folder.measured();
    for file in ["plain.csv", "sheet.csv"] {
        let (code, _, error) = folder.call(&["run", file], b"");
        assert!(code == 2 && error.contains("this is a record") && error.contains("import"), "{error}");
    }
}

#[test]
fn results_are_one_document_of_json_or_nothing() {
    let folder = Folder::new();
    folder.measured();
    let (code, out, error) = folder.call(&["run", "sheet.toml", "--holdout", "plain.csv", "--json", "--map", "x"], b"");
    assert!(code == 2 && out.is_empty(), "{error}");
    let (code, out, error) = folder.call(&["run", "sheet.toml", "--holdout", "sheet.csv", "--json"], b"");
    assert_eq!(code, 0, "{error}");
    let results = kalmanscope_core::Document::from_json(&out).unwrap();
    for key in ["samples", "start", "dt", "measured", "filters", "free_runs"] {
        assert!(results.get(key).is_some(), "{key} in {out}");
    }
    let kalmanscope_core::Document::List(filters) = results.get("filters").unwrap() else { panic!("{out}") };
    for key in ["name", "verdict", "evidence", "causes", "estimates", "mean_nis", "log_likelihood", "stopped"] {
        assert!(filters.iter().all(|filter| filter.get(key).is_some()), "{key} in {out}");
    }
    let kalmanscope_core::Document::List(free_runs) = results.get("free_runs").unwrap() else { panic!("{out}") };
    assert_eq!(free_runs.len(), 2 * filters.len());
    let (code, out, error) = folder.call(&["run", "sheet.toml", "--quiet"], b"");
    assert_eq!((code, out.as_str(), error.as_str()), (0, "", ""));
}

#[test]
fn each_command_has_an_example() {
    let folder = Folder::new();
    for command in ["run", "report", "import", "sweep", "tune", "lesson"] {
        let (code, out, _) = folder.call(&[command, "--help"], b"");
        assert!(code == 0 && out.contains(&format!("  kalmanscope-cli {command} ")), "{out}");
    }
}

#[test]
fn words_that_are_nearly_right_are_known() {
    let folder = Folder::new();
    for (arguments, word) in
        [(&["runn", "a.toml"][..], "'run'"), (&["run", "a.toml", "--record-ot", "b"], "'--record-out'")]
    {
        let (code, _, error) = folder.call(arguments, b"");
        assert!(code == 2 && error.contains(word), "{error}");
    }
    for shell in ["bash", "zsh", "fish", "powershell"] {
        let (code, out, error) = folder.call(&["completions", shell], b"");
        assert!(code == 0 && out.contains("record-out"), "{error}");
    }
}

#[test]
fn extreme_axes_are_drawn() {
    let folder = Folder::new();
    let record: String =
        (0..40).map(|k| format!("{k},0,{}\n", if k % 2 == 0 { "1.7e308" } else { "-1.7e308" })).collect();
    folder.file("record.csv", &format!("t,force,displacement\n{record}"));
    folder.file("scenario.toml", "[[sensors]]\nmeasures = \"displacement\"\nnoise_std = 1.0\n");
    let (code, _, error) =
        folder.call(&["run", "scenario.toml", "--record", "record.csv", "--quiet", "--svg", "a.svg"], b"");
    assert!(code < 2, "{code} {error}");
    assert!(read(&folder.path("a.svg")).ends_with("</svg>\n"));
}

/// 100,000 samples of eight filters have 380 MB of histories.
#[cfg(target_os = "linux")]
#[test]
fn a_long_run_without_outputs_of_its_history_needs_little_memory() {
    let folder = Folder::new();
    let filter = "[[filters]]\nfading = 1.0\n";
    folder.file("long.toml", &format!("duration = 1000.0\n[plant]\nnatural_frequency = 6.0\n{}", filter.repeat(8)));
    // The address space is limited to 260 MB.
    let limited = format!("ulimit -v 260000; exec '{}' run long.toml --json", env!("CARGO_BIN_EXE_kalmanscope-cli"));
    let output = Command::new("sh").args(["-c", &limited]).current_dir(folder.0.path()).output().unwrap();
    let (out, error) = (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap());
    assert!(output.status.code() == Some(0) && out.contains("EKF 8"), "{:?} {error}", output.status);
}

#[test]
fn filters_of_one_name_are_parted_and_this_is_said() {
    let folder = Folder::new();
    folder.file("two.toml", "duration = 2.0\n[[filters]]\nname = \"a\"\n[[filters]]\nname = \"a\"\nkind = \"ukf\"\n");
    let (code, out, error) = folder.call(&["run", "two.toml"], b"");
    assert!(code == 0 && out.contains("a 2 (UKF)") && error.contains("called `a 2` in place of `a`"), "{out}{error}");
    folder.file("unnamed.toml", "duration = 2.0\n[[filters]]\n[[filters]]\n");
    let sweep = ["sweep", "unnamed.toml", "--vary", "filters.EKF 2.fading=1:1.1:2", "--out", "t.csv"];
    let (code, _, error) = folder.call(&sweep, b"");
    assert_eq!(code, 0, "{error}");
    let table = read(&folder.path("t.csv"));
    let names: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    let different: std::collections::BTreeSet<&&str> = names.iter().collect();
    assert!(different.len() == names.len() && names.contains(&"EKF.nis") && names.contains(&"EKF 2.nis"), "{names:?}");
}
