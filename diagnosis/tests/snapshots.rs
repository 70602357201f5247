//! The built-in scenarios: the final numbers to ten digits, and a checksum of every bit of the histories.

use std::fmt::Write as _;
use std::path::Path;

use kalmanscope_core::import::{build, read};
use kalmanscope_core::{Channel, Run, Scenario};
use kalmanscope_diagnosis::{Final, Summary};

use crate::run::{assets, built_in, finished, finished_on, truth};

fn run(name: &str) -> Run {
    let scenario = built_in(name);
    let Some(mapping) = &scenario.record else { return finished(&scenario) };
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/records");
    let table = read(std::fs::read(folder.join(&mapping.file)).unwrap(), mapping.dialect).unwrap();
    finished_on(&scenario, build(&table, mapping, scenario.input, scenario.hold, &[]).unwrap().record)
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
            let place = if square.interval.contains(&square.mean) { "inside" } else { "outside" };
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
    for (name, _) in assets("scenarios") {
        insta::assert_snapshot!(name.clone(), described(&run(&name)));
    }
}

#[test]
fn each_begins_with_a_line_that_says_what_one_sees() {
    let all = assets("scenarios");
    assert!(!all.is_empty());
    for (name, text) in all {
        let first = text.lines().next().unwrap();
        assert!(first.starts_with("# ") && first.ends_with('.') && first.len() > 60, "{name}: {first}");
    }
}

#[test]
fn the_stiffness_loss_is_the_default() {
    assert_eq!(built_in("stiffness-loss"), Scenario::default());
}

fn settled(run: &Run, filter: usize, start: f64) -> f64 {
    let truth = truth(run.record(), Channel::NATURAL_FREQUENCY);
    let estimates = &run.estimates()[filter];
    let far = |&k: &usize| (estimates.mean(k)[2] / truth[k] - 1.0).abs() > 0.02;
    (0..estimates.len()).rev().find(far).map_or(start, |k| run.record().time(k))
}

#[test]
fn the_filters_do_what_the_first_lines_claim() {
    let (both, blind) = (run("stiffness-loss"), run("acceleration-only"));
    for filter in 0..2 {
        assert!((30.0..40.0).contains(&settled(&both, filter, 0.0)));
        assert!((settled(&both, filter, 0.0)..45.0).contains(&settled(&blind, filter, 0.0)));
        assert!(settled(&run("constant"), filter, 0.0) < 5.0);
    }

    let drift = summaries(&run("slow-drift"));
    let mean_nis = |i: usize| drift[i].nis.as_ref().unwrap().mean;
    assert!(mean_nis(0) < 2.2 && mean_nis(1) > 2.8, "fading follows, trusting the past does not");

    for summary in summaries(&run("no-excitation")) {
        let std = |place: usize| summary.finals[place].std;
        assert!(std(0) < 1e-4 && std(1) < 1e-3 && std(2) > 1.0 && std(3) > 0.05, "{summary:?}");
    }

    let hammer = run("hammer");
    let std_at = |t: f64| hammer.estimates()[0].std((t / 0.01) as usize, 3);
    for blow in [10.0, 20.0, 30.0, 40.0, 50.0] {
        assert!(std_at(blow + 3.0) < 0.9 * std_at(blow), "narrower after {blow} s");
        assert!(std_at(blow + 9.9) > 1.05 * std_at(blow + 3.0), "wider long after {blow} s");
    }

    let chirp = run("chirp");
    let std_at = |t: f64, place: usize| chirp.estimates()[0].std((t / 0.01) as usize, place);
    assert!(std_at(10.0, 2) < 0.005 * 6.0, "the frequency is known early");
    assert!(std_at(10.0, 3) > 0.1 * 0.05 && std_at(30.0, 3) < 0.01 * 0.05 * 2.0, "the damping at resonance");

    let free = run("free-vibration");
    let std_at = |t: f64| free.estimates()[0].std((t / 0.01) as usize, 3);
    assert!(std_at(4.0) < 0.02 * std_at(0.0) && std_at(29.0) > 2.0 * std_at(4.0));
}
