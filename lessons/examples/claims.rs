//! Tries every claim of the lessons over many seeds.
//!
//! `cargo run --release -p kalmanscope-lessons --example claims -- [SEEDS [FIRST [LESSON]]]`: the number of seeds (200),
//! the first of them (1000), and a part of the file names of the built-in lessons to try (all), or a file with a lesson. Each line has the share of the
//! seeds for which a claim holds, the share that it states, and quantiles of the measured number, which help to choose
//! a limit. Exits with 1 if a claim fails.

use std::process::ExitCode;

use kalmanscope_lessons::{Claim, LESSONS, Lesson, verify_all};

fn main() -> ExitCode {
    match run() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::from(2)
        }
    }
}

fn run() -> Result<bool, String> {
    let mut arguments = std::env::args().skip(1);
    let mut number = |otherwise: u64| match arguments.next() {
        Some(text) => text.parse().map_err(|_| format!("`{text}` is not a number of seeds")),
        None => Ok(otherwise),
    };
    let (count, first) = (number(200)?, number(1000)?);
    let part = arguments.next().unwrap_or_default();
    let read = |(name, text): (&str, &str)| Lesson::from_toml(text).map_err(|error| format!("{name}: {error}"));
    let lessons = if std::path::Path::new(&part).is_file() {
        let text = std::fs::read_to_string(&part).map_err(|error| format!("{part}: {error}"))?;
        vec![read((&part, &text))?]
    } else {
        LESSONS.iter().copied().filter(|(name, _)| name.contains(&part)).map(read).collect::<Result<_, _>>()?
    };
    let seeds: Vec<u64> = (first..first.saturating_add(count)).collect();
    let claims = verify_all(&lessons, &seeds).map_err(|error| error.to_string())?;
    let tried: Vec<&Claim> = claims.iter().filter(|claim| !claim.values.is_empty()).collect();
    for claim in &tried {
        println!("{}", claim.summary());
    }
    let failed = tried.iter().filter(|claim| !claim.holds()).count();
    println!("{} claims on {count} seeds from {first} on: {failed} fail", tried.len());
    Ok(failed == 0)
}
