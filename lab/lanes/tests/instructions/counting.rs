//! Counting by callgrind, in its own process.

use std::hint::black_box;
use std::path::Path;
use std::process::{Command, Stdio};

use kalmanscope_lanes::Level;

use crate::WORK;
use crate::cases::Case;

/// Two lengths of a record: what their difference leaves out is the start.
const STEPS: [usize; 2] = [200, 600];

/// The counts of each case: before it, and after each of its lengths.
const MARKS: usize = STEPS.len() + 1;

/// A case, and the instructions of a step: of eight runs in lanes.
pub(crate) type Count = (String, u64);

/// Runs all cases, with marks between them, and prints their names.
pub(crate) fn work(cases: &[Case]) {
    for case in cases.iter().filter(|case| case.level.is_none_or(|level| Level::available().contains(&level))) {
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

/// Counts the cases with these words in their names. Leaves out a case if the processor lacks its instructions.
///
/// # Errors
/// Why nothing could be counted.
pub(crate) fn count(words: &[String]) -> Result<Vec<Count>, String> {
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
        .args(["--quiet", "--tool=callgrind", "--dump-before=instructions::counting::mark*"])
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

/// The instructions of a step of the nth case.
fn of_case(folder: &Path, nth: usize) -> Result<u64, String> {
    // Callgrind numbers its files from 1; the first one of a case ends where the case begins.
    let [few, many] = [2, 3].map(|place| total(&folder.join(format!("counts.{}", MARKS * nth + place))));
    Ok((many? - few?) / (STEPS[1] - STEPS[0]) as u64)
}

/// The total of a file of callgrind.
fn total(path: &Path) -> Result<u64, String> {
    let text = std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
    let total = text.lines().find_map(|line| line.strip_prefix("totals: ")?.trim().parse().ok());
    total.ok_or_else(|| format!("{} has no total", path.display()))
}
