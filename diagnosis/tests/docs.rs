//! The tables of the documents are those of the program: filters, plants, and every key of a scenario.

use kalmanscope_core::scenario::option::{EXCLUSIONS, FilterOption};
use kalmanscope_core::scenario::{Fault, Law, LawInfo, Scale};
use kalmanscope_core::{Aspect, Channel, FilterKind, PlantKind, Robust, Scenario};
use kalmanscope_diagnosis::{CAUSES, Cause, MeasureKind};

const FILTERS: &str = include_str!("../../docs/filters.md");
const PLANTS: &str = include_str!("../../docs/plants.md");
const LABORATORY: &str = include_str!("../../docs/laboratory.md");
const VERDICTS: &str = include_str!("../../docs/verdicts.md");
const FORMAT: &str = include_str!("../../docs/scenario-format.md");

fn table(page: &'static str, heading: &str) -> Vec<&'static str> {
    let lines = page.lines().skip_while(|line| *line != heading).skip(2);
    lines.take_while(|line| line.starts_with('|')).collect()
}

#[test]
fn every_row_of_a_table_is_that_of_the_program() {
    let filter = |kind: FilterKind| {
        format!("| `{}` | {} | {} | {} |", kind.key(), kind.name(), kind.description(), kind.reference())
    };
    let rule = |rule: Robust| {
        let info = rule.info();
        format!("| `{}` | {} | {} | {} |", info.key, info.name, info.description, info.reference)
    };
    let fault = |fault: Fault| {
        let info = fault.info();
        let unit = |scale: Scale| match scale {
            Scale::Pure => "",
            Scale::Sigma => " [σ]",
            Scale::Unit => " [unit]",
            Scale::Seconds => " [s]",
        };
        let numbers: Vec<String> =
            info.numbers.iter().map(|number| format!("`{}`{}", number.key, unit(number.scale))).collect();
        format!("| `{}` | {} | {} | {} |", info.key, info.name, info.description, numbers.join(", "))
    };
    let cause = |(place, cause): (usize, &&Cause)| format!("| {place} | `{}` | {} |", cause.key, cause.name);
    let score = |kind: MeasureKind| {
        let of = match (kind.needs_channel(), kind.needs_sensor()) {
            (true, _) => ".CHANNEL",
            (_, true) => ".SENSOR",
            _ => "",
        };
        let info = kind.info();
        let is_of_lessons = info.needs_others || !info.is_number();
        let marks =
            [(info.needs_truth, "the truth"), (info.needs_history(), "all estimates"), (is_of_lessons, "a lesson")];
        let needs: Vec<&str> = marks.iter().filter(|(is, _)| *is).map(|(_, mark)| *mark).collect();
        format!("| `{kind}{of}` | {} | {} |", info.name.replace('@', "…"), needs.join(", "))
    };
    let law = |law: Law| {
        let LawInfo { key, name, numbers } = law.info();
        format!("| `{key}` | {name} | {} |", numbers.join(", "))
    };
    let unit = |unit: &'static str| if unit.is_empty() { "-" } else { unit };
    let channel = |channel: &Channel| {
        format!("| `{}` | {} | {} | {} |", channel.key(), channel.name(), channel.symbol(), unit(channel.unit()))
    };
    let aspect = |aspect: Aspect| {
        let info = aspect.info();
        format!("| `{}` | {} | {} |", info.keys[0], info.symbols[0], unit(info.unit))
    };
    let exclusion = |(first, others, reason): &(&FilterOption, &[&FilterOption], &str)| {
        let keys: Vec<String> = others.iter().map(|other| format!("`{}`", other.key)).collect();
        format!("| {} | {} | {reason} |", first.words, keys.join(", "))
    };
    let bare = Channel::all().iter().filter(|channel| channel.mass() == 0);
    for (page, heading, rows) in [
        (FORMAT, "| channel | name | symbol | unit |", bare.map(channel).collect()),
        (FORMAT, "| quantity | symbol | unit |", Aspect::ALL.map(aspect).to_vec()),
        (FORMAT, "| a filter that | cannot have | since |", EXCLUSIONS.iter().map(exclusion).collect()),
        (FILTERS, "| kind | filter | what it does | reference |", FilterKind::ALL.map(filter).to_vec()),
        (FILTERS, "| robust | rule | what it does | reference |", Robust::ALL.map(rule).to_vec()),
        (FORMAT, "| fault | name | what it does | numbers |", Fault::ALL.map(fault).to_vec()),
        (VERDICTS, "| place | cause | name |", CAUSES.iter().enumerate().map(cause).collect()),
        (LABORATORY, "| score | what it is | needs |", MeasureKind::all().map(score).collect()),
        (FORMAT, "| law | name | its two numbers |", Law::about(6.0, 0.2).map(law).to_vec()),
    ] {
        assert_eq!(table(page, heading), rows, "{}", rows.join("\n"));
    }
}

#[test]
fn every_plant_is_in_its_table() {
    let row = |key: String, name: String, parameters: String, kind: &PlantKind| {
        let equation = kind.equation().replace('|', "\\|");
        format!("| {key} | {name} | {equation} | {parameters} | {} |", kind.info().reference)
    };
    let single = |kind: &PlantKind| {
        let parameters: Vec<&str> = kind.parameters().map(Channel::symbol).collect();
        row(format!("`{}`", kind.key()), kind.name().to_owned(), parameters.join(", "), kind)
    };
    // All chains share a row.
    let (chains, others): (Vec<PlantKind>, Vec<PlantKind>) =
        PlantKind::ALL.into_iter().partition(|kind| kind.masses() > 1);
    let (first, last) = (&chains[0], &chains[chains.len() - 1]);
    let key = format!("`{}` … `{}`", first.key(), last.key());
    let name = format!("{} … {}", first.name(), last.name());
    let rows: Vec<String> =
        others.iter().map(single).chain([row(key, name, "κ₁, κ₂, … c".to_owned(), first)]).collect();
    assert_eq!(table(PLANTS, "| kind | plant | motion per mass | parameters | reference |"), rows);
}

fn rows(heading: &str) -> Vec<Vec<&'static str>> {
    let behind =
        FORMAT.lines().skip_while(|line| line.trim_start_matches('#').trim() != heading || !line.starts_with('#'));
    let lines = behind.skip_while(|line| !line.starts_with('|')).take_while(|line| line.starts_with('|'));
    lines.skip(2).map(|line| line.trim_matches('|').split(" | ").map(str::trim).collect()).collect()
}

fn quoted(text: &str) -> Vec<&str> {
    text.split('`').skip(1).step_by(2).collect()
}

#[track_caller]
fn expected(text: &str) -> Vec<String> {
    let message = Scenario::from_toml(text).expect_err(text).to_string();
    let (_, keys) = message.split_once("expected ").unwrap_or_else(|| panic!("{message}"));
    quoted(keys).into_iter().map(str::to_owned).collect()
}

/// Each table of keys, a text whose message lists them, and their table in the document.
const TABLES: [(&str, &str, &str); 9] = [
    ("A scenario", "unknown = 1", ""),
    ("Sensors", "[[sensors]]\nunknown = 1", ""),
    ("Filters", "[[filters]]\nunknown = 1", "[[filters]]"),
    ("Learning noise", "[[filters]]\nadaptation.unknown = 1", "[[filters]]\n[filters.adaptation]"),
    ("Parameters of an equation", "[plant]\nequation = \"x'' = f\"\nparameters.a.unknown = 1", ""),
    ("A measured record", "[record]\nunknown = 1", "[record]\nfile = \"a\""),
    ("Times", "[record]\ntime.unknown = 1", "[record]\nfile = \"a\"\n[record.time]\nrate = 1.0"),
    ("A column", "[record]\ninput.unknown = 1", "[record]\nfile = \"a\"\n[record.input]\ncolumn = \"b\""),
    ("The form of a file", "[record]\ndialect.unknown = 1", ""),
];

#[test]
fn every_key_is_in_its_table() {
    for (heading, text, _) in TABLES {
        let keys: Vec<String> = rows(heading).iter().map(|row| row[0].trim_matches('`').to_owned()).collect();
        assert_eq!(keys, expected(text), "{heading}");
    }
    let keys: Vec<&str> = rows("The truth").iter().map(|row| row[0].trim_matches('`')).collect();
    assert_eq!(keys, expected("[plant]\nunknown = 1")[..keys.len()]);
    assert!(expected("[plant]\nunknown = 1")[keys.len()..].iter().all(|key| Channel::from_key(key).is_some()));
}

#[test]
fn defaults_are_those_of_the_tables() {
    let parsed = |text: &str| Scenario::from_toml(text).unwrap_or_else(|error| panic!("{text}\n{error}"));
    let mut tried = 0;
    for (heading, _, table) in TABLES.into_iter().chain([("The truth", "", "[plant]")]) {
        // Tables that are empty here need another scenario to stand in.
        if ["Sensors", "Parameters of an equation", "The form of a file"].contains(&heading) {
            continue;
        }
        for row in rows(heading) {
            let [key, value] = [row[0].trim_matches('`'), row[1]];
            if let Some(value) = value.strip_prefix('`') {
                let text = format!("{table}\n{key} = {}", value.trim_end_matches('`'));
                assert_eq!(parsed(&text), parsed(table), "{text}");
                tried += 1;
            }
        }
    }
    assert!(tried > 30, "{tried}");
}

#[test]
fn shapes_of_signals_and_forces_have_their_keys() {
    for (heading, table) in [("Signals", "plant.natural_frequency"), ("The input", "force")] {
        let rows = rows(heading);
        let shapes: Vec<&str> = rows.iter().map(|row| row[0].trim_matches('`')).collect();
        assert_eq!(shapes, expected(&format!("{table}.unknown = 1")), "{heading}");
        for (row, shape) in rows.iter().zip(shapes).filter(|(_, shape)| *shape != "none") {
            assert_eq!(quoted(row[1]), expected(&format!("{table}.{shape}.unknown = 1")), "{heading}: {shape}");
        }
    }
}

#[test]
fn examples_can_be_read() {
    let pages = [FORMAT, FILTERS, PLANTS, include_str!("../../docs/equations.md")];
    let mut read = 0;
    for example in pages.iter().flat_map(|page| page.split("```toml\n").skip(1)) {
        let (text, _) = example.split_once("```").expect("an example ends");
        assert_eq!(Scenario::from_toml(text).err(), None, "{text}");
        read += 1;
    }
    assert!(read >= 3, "{read}");
}
