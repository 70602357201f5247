//! Populations of the built command: shares, verdicts and causes.

use crate::Folder;
use kalmanscope_core::document::{self, Document};

/// The first causes of the first filter's bad verdicts, with their numbers of members, and the members with a good verdict.
fn causes(name: &str, members: &str) -> Vec<(String, i64)> {
    let file = format!("{}/../assets/populations/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    let (text, _) = Folder::new().succeeds(&["population", &file, "--members", members, "--causes", "--json"]);
    let document = document::from_json(&text).unwrap();
    let named = |cause: &Document| {
        let name = cause["name"].as_str().expect("a cause has a name");
        (name.to_owned(), cause["first"].as_i64().expect("a cause has members"))
    };
    document["filters"][0]["causes"].as_array().unwrap().iter().map(named).collect()
}

#[test]
fn what_is_wrong_with_a_population_is_found() {
    for (name, cause) in [
        ("input-gain", "the gain of the input"),
        ("sensor-bias", "a sensor's bias or drift"),
        ("hardening-spring", "a spring that hardens, softens or yields"),
        ("noise-too-small", "R of a sensor"),
    ] {
        let causes = causes(name, "5");
        let right: i64 = causes.iter().filter(|(found, _)| found == cause).map(|(_, members)| members).sum();
        assert!(right >= 4, "{name}: {causes:?}");
    }
    assert_eq!(causes("well-tuned", "8"), []);
}

#[test]
fn shares_are_printed_with_their_intervals() {
    let text = "duration = 5.0\n[plant]\nnatural_frequency = 6.0\n[[filters]]\nkind = \"ekf\"\n[[filters]]\nname = \"b\"\nkind = \"ukf\"\n\
                [draw]\n\"filters.2.initial_mean.natural_frequency\" = { normal = [8.0, 1.0] }\n\
                \"plant.damping_ratio\" = { normal = [0.05, 0.04] }\n";
    let folder = Folder::of(text);
    let run = |scenario: &str, more: &[&str]| folder.succeeds(&[&["population", scenario], more].concat()).0;
    let all = run("scenario.toml", &["--members", "60", "--quiet"]);
    assert!(all.starts_with("60 members; "), "{all}");
    assert!(all.contains(" are impossible scenarios and were left out"), "{all}");
    assert!(all.contains("drawn: filters.b.initial_mean.natural_frequency, normal: mean 8, σ 1"), "{all}");
    assert!(all.contains("verdict: ") && all.contains("ζ inside ±2σ at the end"), "{all}");
    folder.file("none.toml", &text.replace("[0.05, 0.04]", "[-1.0, 0.01]"));
    let none = run("none.toml", &["--members", "5", "--quiet"]);
    assert!(none.contains("; 5 are impossible") && !none.contains("NaN"), "{none}");
    // One filter of them has the numbers that it has beside the others.
    let one = run("scenario.toml", &["--members", "60", "--quiet", "--filter", "b"]);
    let of_b = |text: &str| text[text.find("\nb\n").unwrap()..].to_owned();
    assert_eq!(of_b(&one), of_b(&all));
    // The same on any number of threads, and in a sweep.
    assert_eq!(run("scenario.toml", &["--members", "60", "--threads", "1"]), all);
    let (table, _) = folder.succeeds(&["sweep", "scenario.toml", "--seeds", "4", "--score", "nis", "--out", "-"]);
    let heading = "seed,filters.b.initial_mean.natural_frequency,plant.damping_ratio,EKF.nis,b.nis";
    assert_eq!(table.lines().next(), Some(heading));
    assert_eq!(table.lines().count(), 5);
}

#[test]
fn guesses_are_drawn_over_a_measured_record_and_no_truth_is() {
    let text = "duration = 5.0\n[plant]\nnatural_frequency = 6.0\n[[filters]]\nkind = \"ekf\"\n[draw]\n\
                \"filters.1.initial_mean.natural_frequency\" = { log_uniform = [2.0, 20.0] }\n";
    let folder = Folder::of(text);
    folder.succeeds(&["run", "scenario.toml", "--quiet", "--record-out", "record.csv"]);
    let of_record = ["--members", "20", "--record", "record.csv"];
    let (shares, _) = folder.succeeds(&[&["population", "scenario.toml"], &of_record[..]].concat());
    assert!(shares.contains("ωₙ within 1 % at the end"));
    folder.file("truth.toml", &text.replace("filters.1.initial_mean", "plant"));
    let said = folder.refused(&[&["population", "truth.toml"], &of_record[..]].concat());
    assert!(said.contains("the record is given"), "{said}");
}
