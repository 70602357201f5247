//! Words: results, names, messages and help.

use crate::Folder;
use kalmanscope_core::document;

#[test]
fn results_are_one_document_of_json_or_nothing() {
    let folder = Folder::new();
    folder.measured();
    let (out, _) = folder.fails(&["run", "sheet.toml", "--holdout", "plain.csv", "--json", "--map", "x"], 2);
    assert_eq!(out, "");
    let (out, _) = folder.succeeds(&["run", "sheet.toml", "--holdout", "sheet.csv", "--json"]);
    let results = document::from_json(&out).unwrap();
    for key in ["samples", "start", "dt", "measured", "filters", "free_runs"] {
        assert!(results.get(key).is_some(), "{key} in {out}");
    }
    let filters = results["filters"].as_array().unwrap();
    for key in ["name", "verdict", "evidence", "causes", "estimates", "mean_nis", "log_likelihood", "stopped"] {
        assert!(filters.iter().all(|filter| filter.get(key).is_some()), "{key} in {out}");
    }
    assert_eq!(results["free_runs"].as_array().unwrap().len(), 2 * filters.len());
    assert_eq!(folder.quietly(&["run", "sheet.toml", "--quiet"]), "");
}

#[test]
fn names_are_harmless_in_tables_and_messages() {
    let folder = Folder::new();
    folder.file("formula.toml", "duration = 1.0\n[[filters]]\nname = \"=1+1\"\n[[filters]]\nname = \"-x\"\n");
    folder.succeeds(&["run", "formula.toml", "--out", "estimates.csv"]);
    let rows = folder.read("estimates.csv");
    assert!(rows.lines().skip(1).all(|row| row.starts_with("'=1+1,") || row.starts_with("'-x,")));
    assert!(rows.contains(",-"), "numbers keep their signs");
    folder.file("steering.toml", "\"\\u001b]0;title\\u0007\\u202e\" = 1\n");
    let error = folder.refused(&["run", "steering.toml"]);
    assert!(!error.chars().any(|c| c == '\u{1b}' || c == '\u{7}' || c == '\u{202e}'), "{error:?}");
}

#[test]
fn filters_of_one_name_are_parted_and_this_is_said() {
    let folder = Folder::new();
    folder.file("two.toml", "duration = 2.0\n[[filters]]\nname = \"a\"\n[[filters]]\nname = \"a\"\nkind = \"ukf\"\n");
    let (out, error) = folder.succeeds(&["run", "two.toml"]);
    assert!(out.contains("a 2 (UKF)") && error.contains("called `a 2` in place of `a`"), "{out}{error}");
    folder.file("unnamed.toml", "duration = 2.0\n[[filters]]\n[[filters]]\n");
    let sweep = ["sweep", "unnamed.toml", "--vary", "filters.EKF 2.fading=1:1.1:2", "--out", "t.csv"];
    folder.succeeds(&sweep);
    let table = folder.read("t.csv");
    let names: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    let different: std::collections::BTreeSet<&&str> = names.iter().collect();
    assert!(different.len() == names.len() && names.contains(&"EKF.nis") && names.contains(&"EKF 2.nis"), "{names:?}");
}

#[test]
fn each_command_has_an_example() {
    let folder = Folder::new();
    for command in ["run", "report", "import", "sweep", "tune"] {
        let (out, _) = folder.succeeds(&[command, "--help"]);
        assert!(out.contains(&format!("  kalmanscope-cli {command} ")), "{out}");
    }
}

#[test]
fn words_that_are_nearly_right_are_known() {
    let folder = Folder::new();
    for (arguments, word) in
        [(&["runn", "a.toml"][..], "'run'"), (&["run", "a.toml", "--record-ot", "b"], "'--record-out'")]
    {
        let error = folder.refused(arguments);
        assert!(error.contains(word), "{error}");
    }
}
