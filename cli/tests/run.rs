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
    for part in
        ["6001 samples", "EKF with fading memory", "ωₙ", "rad/s", "±", "mean NIS", "χ²", "log likelihood", " ns"]
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
    let error = folder.refused(&["run", "scenario.toml", "--seed", "9223372036854775808"]);
    assert!(error.contains("--seed") && error.contains("9223372036854775807"), "{error}");
}

#[test]
fn a_picture_is_drawn_and_stays_small() {
    let names = ["<plain> & \"simple\"", "a very, very long name ".repeat(9).trim()].map(str::to_owned);
    let filters: String = names.iter().map(|name| format!("[[filters]]\nname = '{name}'\n")).collect();
    let many = "[[filters]]\nkind = \"ukf\"\n".repeat(14);
    let folder = Folder::of(&format!("duration = 120.0\n{filters}{many}"));
    let table = folder.quietly(&["run", "scenario.toml", "--svg", "plots.svg"]);
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
fn bare_scenarios_are_drawn_too() {
    for toml in ["filters = []\nsensors = []", "duration = 0.01\nforce = \"none\"", "sensors = []\nduration = 1.0"] {
        let folder = Folder::of(toml);
        let table = folder.quietly(&["run", "scenario.toml", "--svg", "plots.svg"]);
        assert!(table.contains(" samples from 0 s"), "{table}");
        assert!(folder.read("plots.svg").matches("<path").count() > 8, "{toml}");
    }
}

#[test]
fn a_filter_that_stops_is_reported_and_keeps_its_estimates() {
    let toml = "duration = 5.0\n[[filters]]\nname = \"wild\"\nfading = 1e60\n[[filters]]\nname = \"tame\"\n";
    let folder = Folder::of(toml);
    let (table, error) = folder.fails(&["run", "scenario.toml", "--out", "estimates.csv", "--svg", "plots.svg"], 1);
    assert_eq!(error, "");
    let told = table.lines().find(|line| line.contains("stopped at sample ")).unwrap();
    let sample: usize = told.split_whitespace().nth(3).unwrap().parse().unwrap();
    assert!(told.contains("(t = 0.") && told.contains(": the "), "{told}");
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

#[test]
fn verdicts_have_evidence_causes_and_an_exit_code() {
    let toml = "duration = 20.0\n[plant]\nnatural_frequency = 6.0\n[[filters]]\nname = \"wrong\"\nsensor_std = [0.05, 0.3]\n\
                [[filters]]\nname = \"right\"\n";
    let folder = Folder::of(toml);
    let short = folder.quietly(&["run", "scenario.toml"]);
    let most = short.split("\n\n").map(|part| part.lines().count()).max();
    assert!(short.contains("  cause 1: ") && most <= Some(10), "{short}");
    let table = folder.quietly(&["run", "scenario.toml", "--verbose"]);
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

    folder.quietly(&["run", "scenario.toml", "--fail-on", "overconfident,diverged,lost"]);
    let (same, error) = folder.fails(&["run", "scenario.toml", "--fail-on", "underconfident,lost"], 3);
    assert!(error.starts_with("--fail-on: the verdict on wrong is underconfident\n"), "{error}");
    assert!(same.contains("underconfident"), "{same}");
    let error = folder.refused(&["run", "scenario.toml", "--fail-on", "bad"]);
    assert!(error.contains("recovered"), "{error}");
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
