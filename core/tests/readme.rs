//! The README lists the filters and plants that exist.

use kalmanscope_core::{Channel, FilterKind, PlantKind};

const README: &str = include_str!("../../README.md");

/// The rows of the table under a heading line.
fn table(heading: &str) -> Vec<&'static str> {
    let lines = README.lines().skip_while(|line| *line != heading).skip(2);
    lines.take_while(|line| line.starts_with('|')).collect()
}

#[test]
fn every_filter_is_in_its_table() {
    let row = |kind: FilterKind| {
        format!("| `{}` | {} | {} | {} |", kind.key(), kind.name(), kind.description(), kind.reference())
    };
    assert_eq!(table("| kind | filter | what it does | reference |"), FilterKind::ALL.map(row));
}

#[test]
fn every_plant_is_in_its_table() {
    let row = |key: String, name: String, parameters: String, kind: PlantKind| {
        let equation = kind.equation().replace('|', "\\|");
        format!("| {key} | {name} | {equation} | {parameters} | {} |", kind.reference())
    };
    let single = |kind: &PlantKind| {
        let parameters: Vec<&str> = kind.parameters().map(Channel::symbol).collect();
        row(format!("`{}`", kind.key()), kind.name().to_owned(), parameters.join(", "), *kind)
    };
    // All chains share a row.
    let (chains, others): (Vec<PlantKind>, Vec<PlantKind>) = PlantKind::ALL.iter().partition(|kind| kind.masses() > 1);
    let (first, last) = (chains[0], chains[chains.len() - 1]);
    let key = format!("`{}` … `{}`", first.key(), last.key());
    let name = format!("{} … {}", first.name(), last.name());
    let rows: Vec<String> =
        others.iter().map(single).chain([row(key, name, "κ₁, κ₂, … c".to_owned(), first)]).collect();
    assert_eq!(table("| kind | plant | motion per mass | parameters | reference |"), rows);
}

#[test]
fn keys_are_those_of_scenario_files() {
    for kind in FilterKind::ALL {
        assert_eq!(toml::Value::try_from(kind), Ok(kind.key().into()));
    }
    for kind in PlantKind::ALL {
        assert_eq!(toml::Value::try_from(kind), Ok(kind.key().into()));
    }
    for channel in Channel::all() {
        assert_eq!(toml::Value::try_from(channel), Ok(channel.key().into()));
    }
}
