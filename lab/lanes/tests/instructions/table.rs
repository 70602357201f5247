//! The table of the counts that are meant.

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use crate::cases::Case;
use crate::counting::count;

/// Limits the difference from the table, as a share.
const TOLERANCE: f64 = 0.03;

const UPDATE: &str = "CARGO_PROFILE_RELEASE_STRIP=false cargo test --locked --release -p kalmanscope-lanes --test instructions -- --update";

fn path() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/instructions/table.toml")
}

/// The compiler and the system that it compiles for.
fn compiler() -> Result<String, String> {
    let output = Command::new("rustc").arg("-vV").output().map_err(|error| format!("rustc: {error}"))?;
    let text = String::from_utf8_lossy(&output.stdout);
    let host = text.lines().find_map(|line| line.strip_prefix("host: ")).unwrap_or_default();
    Ok(format!("{} for {host}", text.lines().next().unwrap_or_default()))
}

/// Counts all cases and writes them down.
///
/// # Errors
/// Why they could not be counted or written.
pub(crate) fn write(cases: &[Case]) -> Result<(), String> {
    let counts = count(&[])?;
    if counts.len() < cases.len() {
        return Err("this processor has no AVX2, so the table would not be whole".to_owned());
    }
    let mut text = format!("# Instructions of a filter step, in lanes of eight runs. Written by:\n# {UPDATE}\n\n");
    let _ = writeln!(text, "compiler = {:?}\n\n[instructions]", compiler()?);
    for (name, count) in &counts {
        println!("{count:>8}  {name}");
        let _ = writeln!(text, "{name:?} = {count}");
    }
    std::fs::write(path(), text).map_err(|error| error.to_string())
}

/// The counts of the table, and the compiler that it is of.
fn read() -> Result<(String, toml::Table), String> {
    let said = |error: &dyn std::fmt::Display| format!("{}: {error}", path().display());
    let text = std::fs::read_to_string(path()).map_err(|error| said(&error))?;
    let mut table: toml::Table = text.parse().map_err(|error: toml::de::Error| said(&error))?;
    match (table.remove("compiler"), table.remove("instructions")) {
        (Some(toml::Value::String(compiler)), Some(toml::Value::Table(counts))) => Ok((compiler, counts)),
        _ => Err(said(&"it has no compiler or no instructions")),
    }
}

/// Counts cases, prints them beside the table, and compares them.
///
/// # Errors
/// The differences, and the remedy.
pub(crate) fn compare(cases: &[Case], words: &[String], is_whole: bool) -> Result<(), String> {
    let (meant, table) = read()?;
    let counts = count(words)?;
    println!("{:>8}{:>10}{:>10}  instructions of a step", "table", "now", "per cent");
    let mut off = Vec::new();
    for (name, now) in &counts {
        let known = table.get(name).and_then(toml::Value::as_integer);
        let line = line(name, known, *now);
        println!("{line}");
        if known.is_none_or(|known| share(known, *now).abs() > TOLERANCE) {
            off.push(line);
        }
    }
    let is_counted = |name: &str| counts.iter().any(|(other, _)| other == name);
    let left_out: Vec<&str> = cases.iter().map(|case| case.name.as_str()).filter(|name| !is_counted(name)).collect();
    if !left_out.is_empty() {
        println!("This processor has no AVX2, so these cases are not counted: {}.", left_out.join("; "));
    }
    let now = compiler()?;
    if now != meant {
        println!("The table is of {meant} and this is {now}: the counts cannot be compared.");
        return Ok(());
    }
    let is_case = |name: &str| cases.iter().any(|case| case.name == name);
    off.extend(table.keys().filter(|name| is_whole && !is_case(name)).map(|name| format!("no case is named {name}")));
    verdict(&off)
}

fn share(known: i64, now: u64) -> f64 {
    now as f64 / known as f64 - 1.0
}

fn line(name: &str, known: Option<i64>, now: u64) -> String {
    match known {
        Some(known) => format!("{known:>8}{now:>10}{:>+10.1}  {name}", 100.0 * share(known, now)),
        None => format!("{:>8}{now:>10}{:>10}  {name}", "none", ""),
    }
}

fn verdict(off: &[String]) -> Result<(), String> {
    if off.is_empty() {
        return Ok(());
    }
    Err(format!(
        "\nThese differ from {} by more than {:.0} per cent:\n{}\nMore instructions in lanes mean, as a rule, that a function or a closure \
         is not inlined any more and has lost its instruction set. If the change is meant, write the table anew:\n{UPDATE}",
        path().display(),
        100.0 * TOLERANCE,
        off.join("\n")
    ))
}
