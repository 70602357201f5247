//! Makes the generated records in `assets/records/` again, bit by bit.
//!
//! `cargo run -p kalmanscope-lessons --example make_records -- [FOLDER [SEED]]`: the folder (`assets/records`) and the seed of
//! the random numbers (1). Another seed gives records of the same kind, on which the claims of lessons are tried.

mod circuit;
mod earthquake;
mod oscillator;
mod random;
mod staircase;

use std::path::PathBuf;
use std::process::ExitCode;

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().map_or_else(|| PathBuf::from("assets/records"), PathBuf::from);
    let Ok(seed) = arguments.next().unwrap_or_else(|| "1".to_owned()).parse() else {
        eprintln!("the seed is a number from 0 on");
        return ExitCode::from(2);
    };
    for (name, text) in [
        ("circuit.csv", circuit::file(seed)),
        ("earthquake.csv", earthquake::file(seed)),
        ("staircase.csv", staircase::file(seed)),
    ] {
        let path = folder.join(name);
        if let Err(error) = std::fs::write(&path, text) {
            eprintln!("{}: {error}", path.display());
            return ExitCode::from(1);
        }
    }
    ExitCode::SUCCESS
}
