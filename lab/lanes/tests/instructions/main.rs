//! Counts the instructions of filter steps by callgrind, and compares them with `table.toml`: code that falls out of its
//! instruction set has the right numbers and several times the instructions.
//!
//! ```text
//! cargo test --release -p kalmanscope-lanes --test instructions                  all cases beside the table
//! cargo test --release -p kalmanscope-lanes --test instructions -- Duffing UKF   those whose names have these words
//! cargo test --release -p kalmanscope-lanes --test instructions -- --update      writes the table
//! ```
//!
//! Needs valgrind: its counts are the same on a busy machine. A release keeps its names with
//! `CARGO_PROFILE_RELEASE_STRIP=false`. With fewer
//! optimisations, moves of memory hide what AVX2 saves. Counts depend on the compiler too; the table names it.

mod cases;

use std::fmt::Write as _;
use std::hint::black_box;
use std::path::Path;
use std::process::{Command, ExitCode, Stdio};

use kalmanscope_lanes::InstructionSet;

use cases::Case;

const WORK: &str = "--work";

fn main() -> ExitCode {
    let mut words: Vec<String> = std::env::args().skip(1).collect();
    let mut take = |option: &str| {
        let before = words.len();
        words.retain(|word| word != option);
        words.len() < before
    };
    let (is_work, is_update) = (take(WORK), take("--update"));
    let chosen = cases::chosen(&words);
    if is_work {
        work(&chosen);
        return ExitCode::SUCCESS;
    }
    let done = match (is_update, words.is_empty()) {
        _ if cfg!(debug_assertions) => Err("the table is of a release: count with `--release`".to_owned()),
        _ if chosen.is_empty() => Err(format!("no case has the words {}", words.join(" "))),
        (true, false) => Err("the table is written as a whole: leave out the names".to_owned()),
        (true, true) => write(&chosen),
        (false, is_whole) => compare(&chosen, &words, is_whole),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => {
            eprintln!("{reason}");
            ExitCode::FAILURE
        }
    }
}

const TOLERANCE: f64 = 0.03;

const UPDATE: &str = "CARGO_PROFILE_RELEASE_STRIP=false cargo test --locked --release -p kalmanscope-lanes --test instructions -- --update";

fn path() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/instructions/table.toml")
}

fn compiler() -> Result<String, String> {
    let output = Command::new("rustc").arg("-vV").output().map_err(|error| format!("rustc: {error}"))?;
    let text = String::from_utf8_lossy(&output.stdout);
    let host = text.lines().find_map(|line| line.strip_prefix("host: ")).unwrap_or_default();
    Ok(format!("{} for {host}", text.lines().next().unwrap_or_default()))
}

fn write(cases: &[Case]) -> Result<(), String> {
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

fn read() -> Result<(String, toml::Table), String> {
    let said = |error: &dyn std::fmt::Display| format!("{}: {error}", path().display());
    let text = std::fs::read_to_string(path()).map_err(|error| said(&error))?;
    let mut table: toml::Table = text.parse().map_err(|error: toml::de::Error| said(&error))?;
    match (table.remove("compiler"), table.remove("instructions")) {
        (Some(toml::Value::String(compiler)), Some(toml::Value::Table(counts))) => Ok((compiler, counts)),
        _ => Err(said(&"it has no compiler or no instructions")),
    }
}

fn compare(cases: &[Case], words: &[String], is_whole: bool) -> Result<(), String> {
    let (meant, table) = read()?;
    let counts = count(words)?;
    println!("{:>8}{:>10}{:>10}  instructions of a step", "table", "now", "per cent");
    let mut off = Vec::new();
    for (name, now) in &counts {
        let known = table.get(name).and_then(toml::Value::as_integer);
        let off_by = known.map(|known| *now as f64 / known as f64 - 1.0);
        let line = match (known, off_by) {
            (Some(known), Some(by)) => format!("{known:>8}{now:>10}{:>+10.1}  {name}", 100.0 * by),
            _ => format!("{:>8}{now:>10}{:>10}  {name}", "none", ""),
        };
        println!("{line}");
        if off_by.is_none_or(|by| by.abs() > TOLERANCE) {
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

/// Two lengths of a record: their difference leaves out the start.
const STEPS: [usize; 2] = [200, 600];

const MARKS: usize = STEPS.len() + 1;

fn work(cases: &[Case]) {
    for case in cases.iter().filter(|case| case.level.is_none_or(|one| InstructionSet::available().contains(&one))) {
        println!("{}", case.name);
        let records = STEPS.map(|steps| case.record(steps));
        mark();
        for record in &records {
            case.run(record);
            mark();
        }
    }
}

/// Callgrind writes its counts to a file when this function begins, and starts again from zero.
#[inline(never)]
fn mark() {
    black_box(());
}

/// Cases, and the instructions of a step: of eight runs in lanes.
fn count(words: &[String]) -> Result<Vec<(String, u64)>, String> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("instructions");
    let said = |error: std::io::Error| error.to_string();
    if folder.exists() {
        std::fs::remove_dir_all(&folder).map_err(said)?;
    }
    std::fs::create_dir_all(&folder).map_err(said)?;
    let program = std::env::current_exe().map_err(said)?;
    let mut file = std::ffi::OsString::from("--callgrind-out-file=");
    file.push(folder.join("counts"));
    let output = Command::new("valgrind")
        .args(["--quiet", "--tool=callgrind", "--dump-before=instructions::mark*"])
        .arg(file)
        .arg(program)
        .arg(WORK)
        .args(words)
        .stderr(Stdio::inherit())
        .output()
        .map_err(|error| format!("valgrind cannot be started ({error}): please install it"))?;
    if !output.status.success() {
        return Err(format!("the program that is counted ended with {}", output.status));
    }
    let names = String::from_utf8_lossy(&output.stdout);
    let names = names.lines().enumerate();
    names.map(|(nth, name)| Ok((name.to_owned(), of_case(&folder, nth)?))).collect()
}

fn of_case(folder: &Path, nth: usize) -> Result<u64, String> {
    // Callgrind numbers its files from 1; the first one of a case ends where the case begins.
    let [few, many] = [2, 3].map(|place| total(&folder.join(format!("counts.{}", MARKS * nth + place))));
    Ok((many? - few?) / (STEPS[1] - STEPS[0]) as u64)
}

fn total(path: &Path) -> Result<u64, String> {
    let text = std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
    let total = text.lines().find_map(|line| line.strip_prefix("totals: ")?.trim().parse().ok());
    total.ok_or_else(|| format!("{} has no total", path.display()))
}
