//! Words: results, names, messages and help.

use crate::Folder;
use kalmanscope_core::document::{self, Document};

/// The keys of a document and of all below it, but those of a scenario and of quantities and channels.
fn keys(document: &Document, all: &mut Vec<String>) {
    document.as_array().into_iter().flatten().for_each(|one| keys(one, all));
    for (key, value) in document.as_object().into_iter().flatten() {
        all.push(key.clone());
        if !["scenario", "measured", "truth", "mean", "std", "innovation", "innovation_std", "value"].contains(&&**key)
        {
            keys(value, all);
        }
    }
}

#[test]
fn json_has_one_shape_which_is_that_of_its_page() {
    let folder = Folder::new();
    folder.measured();
    let run = ["run", "sheet.toml", "--holdout", "sheet.csv", "--json"];
    let (printed, _) = folder.succeeds(&[&run[..], &["--out", "all.json"]].concat());
    let (alone, _) = folder.succeeds(&run);
    assert_eq!(printed, alone, "a history changes nothing");
    let mut all = document::from_json(&folder.read("all.json")).unwrap();
    let page = include_str!("../../docs/command-line.md").split_once("## JSON").unwrap().1;
    let page: Vec<&str> =
        page.split("```").nth(1).unwrap().split(|c: char| !(c.is_alphanumeric() || c == '_')).collect();
    let mut found = Vec::new();
    keys(&all, &mut found);
    assert!(found.iter().all(|key| page.contains(&key.as_str())), "{found:?}");
    let filters = all["filters"].as_array().unwrap().len();
    assert_eq!(all["free_runs"].as_array().unwrap().len(), 2 * filters);
    assert_eq!(
        all["filters"][1]["series"]["nis"].as_array().map(Vec::len),
        all["record"]["samples"].as_u64().map(|n| n as usize)
    );
    all["record"]["series"] = Document::Null;
    (0..filters).for_each(|place| all["filters"][place]["series"] = Document::Null);
    assert_eq!(document::from_json(&printed).unwrap(), all);
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
