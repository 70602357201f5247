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
mod table;

use std::process::ExitCode;

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
        table::work(&chosen);
        return ExitCode::SUCCESS;
    }
    let done = match (is_update, words.is_empty()) {
        _ if cfg!(debug_assertions) => Err("the table is of a release: count with `--release`".to_owned()),
        _ if chosen.is_empty() => Err(format!("no case has the words {}", words.join(" "))),
        (true, false) => Err("the table is written as a whole: leave out the names".to_owned()),
        (true, true) => table::write(&chosen),
        (false, is_whole) => table::compare(&chosen, &words, is_whole),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => {
            eprintln!("{reason}");
            ExitCode::FAILURE
        }
    }
}
