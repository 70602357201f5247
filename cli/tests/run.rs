//! Runs: table, estimates, picture and verdicts.

#[cfg(target_os = "linux")]
use std::process::Command;

#[cfg(target_os = "linux")]
use crate::text;
use crate::{Folder, SAMPLE};

const HEADER: &str = "filter,k,t,displacement,velocity,natural_frequency,damping_ratio,std_displacement,std_velocity,\
                      std_natural_frequency,std_damping_ratio,nis,log_likelihood,innovation_displacement,\
                      innovation_velocity,innovation_std_displacement,innovation_std_velocity,predicted_displacement,\
                      predicted_velocity";

#[test]
fn the_sample_runs_and_prints_its_results() {
    let folder = Folder::of(SAMPLE);
    let table = folder.quietly(&["run", "scenario.toml", "--verbose", "--out", "estimates.csv"]);
    for part in ["6001 samples", "EKF with fading memory", "ωₙ", "rad/s", "±", "mean NIS", "χ²", "log likelihood"]
    {
        assert!(table.contains(part), "{part} in\n{table}");
    }
    let frequency = table.lines().find(|line| line.contains("natural frequency")).unwrap();
    assert!(frequency.contains(" 4.7") || frequency.contains(" 4.8"), "{frequency}");

    let estimates = folder.read("estimates.csv");
    let mut lines = estimates.lines();
    assert_eq!(lines.next(), Some(HEADER));
    let first: Vec<&str> = lines.next().unwrap().split(',').collect();
    assert_eq!(first[..3], ["EKF with fading memory", "0", "0.0000000000000000e0"]);
    assert_eq!(first[5], "8.0000000000000000e0");
    assert_eq!(first[11..], ["nan"; 8]);
    assert_eq!(lines.count(), 6000);
}

#[test]
fn the_seed_can_be_chosen() {
    let folder = Folder::of(SAMPLE);
    let record = |seed: &[&str]| {
        folder.quietly(&[&["run", "scenario.toml", "--record-out", "record.csv"], seed].concat());
        folder.read("record.csv")
    };
    let own = record(&[]);
    assert_eq!(own, record(&["--seed", "1"]));
    assert_ne!(own, record(&["--seed", "2"]));
}

#[test]
fn a_picture_is_drawn_and_stays_small() {
    let names = ["<plain> & \"simple\"", "a very, very long name ".repeat(9).trim()].map(str::to_owned);
    let filters: String = names.iter().map(|name| format!("[[filters]]\nname = '{name}'\n")).collect();
    let many = "[[filters]]\nkind = \"ukf\"\n".repeat(14);
    let folder = Folder::of(&format!("duration = 120.0\n{filters}{many}"));
    let table = folder.quietly(&["run", "scenario.toml", "--out", "plots.svg"]);
    assert!(names.iter().all(|name| table.contains(name)), "{table}");
    let svg = folder.read("plots.svg");
    assert!(svg.starts_with("<svg ") && svg.trim_end().ends_with("</svg>"));
    assert!((100_000..1_500_000).contains(&svg.len()), "{} bytes", svg.len());
    for part in ["&lt;plain&gt; &amp;", "natural frequency ωₙ [rad/s]", "time t [s]", "truth", "measurement", "#0072b2"]
    {
        assert!(svg.contains(part), "{part}");
    }
    assert!(!svg.contains("NaN") && !svg.contains("<plain>"));
}

#[test]
fn a_filter_that_stops_is_reported_and_keeps_its_estimates() {
    let toml = "duration = 5.0\n[[filters]]\nname = \"wild\"\nfading = 1e60\n[[filters]]\nname = \"tame\"\n";
    let folder = Folder::of(toml);
    let (table, error) = folder.fails(&["run", "scenario.toml", "--out", "estimates.csv", "--out", "plots.svg"], 1);
    assert_eq!(error, "");
    let line = table.lines().find(|line| line.contains("stopped at sample ")).unwrap();
    let sample: usize = line.split_whitespace().nth(3).unwrap().parse().unwrap();
    assert!(line.contains(" (0.") && line.contains(" s): the "), "{line}");
    let estimates = folder.read("estimates.csv");
    let rows = |name: &str| estimates.lines().filter(|line| line.starts_with(name)).count();
    assert!(sample > 1 && sample < 500);
    assert_eq!((rows("wild,"), rows("tame,")), (sample, 501));
    assert!(folder.read("plots.svg").contains("wild (EKF), stopped at 0."));
}

#[test]
fn estimates_have_the_signs_of_the_table() {
    let mirrored = SAMPLE
        .replace("natural_frequency = 8.0, damping_ratio = 0.1", "natural_frequency = -8.0, damping_ratio = -0.1");
    assert_ne!(mirrored, SAMPLE);
    let folder = Folder::of(&mirrored);
    folder.quietly(&["run", "scenario.toml", "--out", "estimates.csv"]);
    let text = folder.read("estimates.csv");
    let header: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    let column = header.iter().position(|name| *name == "natural_frequency").unwrap();
    let frequencies: Vec<f64> =
        text.lines().skip(1).map(|line| line.split(',').nth(column).unwrap().parse().unwrap()).collect();
    assert!(frequencies.len() > 1000 && frequencies.iter().all(|wn| *wn >= 0.0), "{:?}", &frequencies[..3]);
}

/// Two filters of which one expects five times the noise.
const TWO: &str = "duration = 20.0\n[plant]\nnatural_frequency = 6.0\n[[filters]]\nname = \"wrong\"\nsensor_std = [0.05, 0.3]\n\
                   [[filters]]\nname = \"right\"\nsmoother = true\n";

/// The table of each scenario, as `tables.txt` has it. A changed table is written to `tables.new`.
#[test]
fn tables_are_those_of_the_file() {
    let plant = "duration = 5.0\n[plant]\nkind = \"shear_2\"\n";
    let jump = "duration = 25.0\n[plant]\nnatural_frequency = { step = { from = 6.0, to = 4.8, at = 20.0 } }\n";
    let known = "duration = 5.0\n[plant]\nnatural_frequency = 8\n[[filters]]\nkind = \"kf\"\nfading = 1.0\n";
    let runaway = "[plant]\nkind = \"duffing\"\ncubic_stiffness = -300\ninitial = { displacement = 0.5 }";
    let folder = Folder::new();
    folder.measured();
    let mut found = String::new();
    for (what, toml, options) in [
        ("an R that is too large", TWO, &[][..]),
        ("the same", TWO, &["--verbose"]),
        (
            "a sensor that the filter's plant lacks",
            &format!("{plant}[[sensors]]\nmeasures = \"velocity_2\"\nnoise_std = 0.1\n[[filters]]\nplant = \"sdof\""),
            &["--verbose"],
        ),
        ("a jump", &format!("{jump}[[filters]]\nfading = 1.0\njump = true"), &[]),
        ("known parameters", known, &["--verbose"]),
        ("a truth that ends", runaway, &[]),
        ("a filter that stops", "duration = 5.0\n[[filters]]\nfading = 1e300", &[]),
        ("few samples", "duration = 0.05", &[]),
        ("random members", "duration = 5.0\n[[filters]]\nkind = \"pf\"\nensemble_size = 50", &["--verbose"]),
        ("no sensors", "sensors = []\nduration = 1.0", &["--verbose"]),
        ("nothing", "filters = []\nsensors = []", &[]),
        ("one sample", "duration = 0.01\nforce = \"none\"", &[]),
        ("a measured record and another", &folder.read("sheet.toml"), &["--holdout", "sheet.csv"]),
        ("the same", &folder.read("sheet.toml"), &["--verbose"]),
    ] {
        folder.file("s.toml", toml);
        let run = [&["run", "s.toml"], options].concat();
        let (_, table, _) = folder.call(&run);
        let (_, with_history, _) = folder.call(&[&run[..], &["--out", "all.svg"]].concat());
        assert_eq!(table, with_history, "{what}");
        assert!(folder.read("all.svg").matches("<path").count() > 8, "{what}");
        let is_long = |part: &str| part.lines().count() > 10;
        assert!(options.contains(&"--verbose") || !table.split("\n\n").any(is_long), "{table}");
        found += &format!("==== {what}{}\n{table}\n", options.iter().map(|one| format!(" {one}")).collect::<String>());
    }
    let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/tables.txt");
    if found != std::fs::read_to_string(&file).unwrap_or_default() {
        std::fs::write(file.with_extension("new"), &found).unwrap();
        panic!("tables.new differs from tables.txt");
    }
}

#[test]
fn verdicts_have_an_exit_code() {
    let folder = Folder::of(TWO);
    folder.quietly(&["run", "scenario.toml", "--fail-on", "overconfident,diverged,lost"]);
    let (same, error) = folder.fails(&["run", "scenario.toml", "--fail-on", "underconfident,lost"], 3);
    assert!(error.starts_with("--fail-on: the verdict on wrong is underconfident\n"), "{error}");
    assert!(same.contains("underconfident"), "{same}");
}

/// 100,000 samples of eight filters have 380 MB of histories.
#[cfg(target_os = "linux")]
#[test]
fn a_long_run_without_outputs_of_its_history_needs_little_memory() {
    let filters = "[[filters]]\nfading = 1.0\n".repeat(8);
    let folder = Folder::of(&format!("duration = 1000.0\n[plant]\nnatural_frequency = 6.0\n{filters}"));
    // The address space is limited to 260 MB.
    let limited =
        format!("ulimit -v 260000; exec '{}' run scenario.toml --json", env!("CARGO_BIN_EXE_kalmanscope-cli"));
    let output = Command::new("sh").args(["-c", &limited]).current_dir(folder.0.path()).output().unwrap();
    let (out, error) = (text(&output.stdout), text(&output.stderr));
    assert!(output.status.code() == Some(0) && out.contains("EKF 8"), "{:?} {error}", output.status);
}
