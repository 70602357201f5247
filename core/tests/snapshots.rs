//! The built-in scenarios: the final numbers to ten digits, and a checksum of every bit of the histories.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use kalmanscope_core::diagnosis::Final;
use kalmanscope_core::{Run, Scenario, Summary};

use crate::run::{finished, finished_on_file};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/scenarios")
}

fn names() -> Vec<String> {
    let files = std::fs::read_dir(folder()).unwrap();
    let mut names: Vec<String> = files
        .filter_map(|file| file.unwrap().file_name().to_str().unwrap().strip_suffix(".toml").map(str::to_owned))
        .collect();
    names.sort();
    names
}

fn text(name: &str) -> String {
    std::fs::read_to_string(folder().join(format!("{name}.toml"))).unwrap()
}

fn scenario(name: &str) -> Scenario {
    Scenario::from_toml(&text(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn built_in(name: &str) -> Run {
    let scenario = scenario(name);
    let Some(mapping) = &scenario.record else { return finished(&scenario) };
    finished_on_file(&scenario, std::fs::read(folder().join("../records").join(&mapping.file)).unwrap())
}

fn summaries(run: &Run) -> Vec<Summary> {
    run.estimates().iter().map(|e| Summary::new(e, run.record())).collect()
}

fn described(run: &Run) -> String {
    let mut text = String::new();
    for summary in summaries(run) {
        let Summary { name, kind, samples, finals, nis, nees, log_likelihood, verdict, stop, .. } = summary;
        writeln!(text, "{name} ({}), {samples} samples", kind.name()).unwrap();
        for Final { channel, mean, std, score: _ } in finals {
            writeln!(text, "  {:17} {mean:17.9e} ± {std:.9e} {}", channel.name(), channel.unit()).unwrap();
        }
        // A measured record has no truth, and so no NEES.
        for (what, square) in [("NIS", nis), ("NEES", nees)] {
            let Some(square) = square else { continue };
            let place = if square.is_inside() { "inside" } else { "outside" };
            writeln!(text, "  mean {what:4}         {:17.9e}, {place}", square.mean).unwrap();
        }
        writeln!(text, "  log likelihood    {log_likelihood:17.9e}").unwrap();
        writeln!(text, "  {}", verdict.unwrap()).unwrap();
        assert_eq!(stop, None, "{name}");
    }
    writeln!(text, "checksum {:016x}", run.checksum()).unwrap();
    // An editor may remove spaces at the end of a line.
    text.lines().map(|line| line.trim_end().to_owned() + "\n").collect()
}

#[test]
fn built_in_scenarios_end_as_before() {
    let names = names();
    assert!(!names.is_empty());
    for name in names {
        insta::assert_snapshot!(name.clone(), described(&built_in(&name)));
    }
}

#[test]
fn each_begins_with_a_line_that_says_what_one_sees() {
    for name in names() {
        let text = text(&name);
        let first = text.lines().next().unwrap();
        assert!(first.starts_with("# ") && first.ends_with('.') && first.len() > 60, "{name}: {first}");
    }
}

#[test]
fn the_stiffness_loss_is_the_default() {
    assert_eq!(scenario("stiffness-loss"), Scenario::default());
}

/// Final errors of a parameter in standard deviations, one per filter.
fn final_errors(run: &Run, place: usize) -> Vec<f64> {
    let error = |s: &Summary| s.finals[place].score.unwrap().error.abs() / s.finals[place].std;
    summaries(run).iter().map(error).collect()
}

fn settled(run: &Run, filter: usize, start: f64) -> f64 {
    let truth = run.record().truth(kalmanscope_core::Channel::NATURAL_FREQUENCY).unwrap();
    let estimates = &run.estimates()[filter];
    let far = |&k: &usize| (estimates.mean(k)[2] / truth[k] - 1.0).abs() > 0.02;
    (0..estimates.len()).rev().find(far).map_or(start, |k| run.record().time(k))
}

#[test]
fn the_filters_do_what_the_first_lines_claim() {
    for name in ["constant", "free-vibration", "hammer", "chirp", "stiffness-loss", "acceleration-only"] {
        let run = built_in(name);
        for place in [2, 3] {
            assert!(final_errors(&run, place).iter().all(|&error| error < 3.0), "{name}");
        }
    }
    let (both, blind) = (built_in("stiffness-loss"), built_in("acceleration-only"));
    for filter in 0..2 {
        assert!((30.0..40.0).contains(&settled(&both, filter, 0.0)));
        assert!((settled(&both, filter, 0.0)..45.0).contains(&settled(&blind, filter, 0.0)));
        assert!(settled(&built_in("constant"), filter, 0.0) < 5.0);
    }

    let drift = summaries(&built_in("slow-drift"));
    let mean_nis = |i: usize| drift[i].nis.as_ref().unwrap().mean;
    assert!(mean_nis(0) < 2.2 && mean_nis(1) > 2.8, "fading follows, trusting the past does not");

    let known = summaries(&built_in("known-parameters"));
    let nis = |i: usize| known[i].nis.as_ref().unwrap();
    assert!(nis(0).is_inside() && nis(1).mean > 10.0);

    for summary in summaries(&built_in("no-excitation")) {
        let std = |place: usize| summary.finals[place].std;
        assert!(std(0) < 1e-4 && std(1) < 1e-3 && std(2) > 1.0 && std(3) > 0.05, "{summary:?}");
    }

    let hammer = built_in("hammer");
    let std_at = |t: f64| hammer.estimates()[0].std((t / 0.01) as usize, 3);
    for blow in [10.0, 20.0, 30.0, 40.0, 50.0] {
        assert!(std_at(blow + 3.0) < 0.9 * std_at(blow), "narrower after {blow} s");
        assert!(std_at(blow + 9.9) > 1.05 * std_at(blow + 3.0), "wider long after {blow} s");
    }

    let chirp = built_in("chirp");
    let std_at = |t: f64, place: usize| chirp.estimates()[0].std((t / 0.01) as usize, place);
    assert!(std_at(10.0, 2) < 0.005 * 6.0, "the frequency is known early");
    assert!(std_at(10.0, 3) > 0.1 * 0.05 && std_at(30.0, 3) < 0.01 * 0.05 * 2.0, "the damping at resonance");

    let free = built_in("free-vibration");
    let std_at = |t: f64| free.estimates()[0].std((t / 0.01) as usize, 3);
    assert!(std_at(4.0) < 0.02 * std_at(0.0) && std_at(29.0) > 2.0 * std_at(4.0));
}
