//! Makes the generated records in `assets/records/` again, bit by bit.
//!
//! `cargo run -p kalmanscope-lessons --example make_records -- [FOLDER [SEED]]`: the folder (`assets/records`) and the seed of
//! the random numbers (1). Another seed gives records of the same kind, on which the claims of lessons are tried.

use std::path::PathBuf;
use std::process::ExitCode;

use kalmanscope_lessons::records::{RECORDS, SEED};

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().map_or_else(|| PathBuf::from("assets/records"), PathBuf::from);
    let Ok(seed) = arguments.next().map_or(Ok(SEED), |seed| seed.parse()) else {
        eprintln!("the seed is a number from 0 on");
        return ExitCode::from(2);
    };
    for (name, file) in RECORDS {
        let path = folder.join(name);
        if let Err(error) = std::fs::write(&path, file(seed)) {
            eprintln!("{}: {error}", path.display());
            return ExitCode::from(1);
        }
    }
    ExitCode::SUCCESS
}
