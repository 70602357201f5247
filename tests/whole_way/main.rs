//! Tries hostile scenarios the whole way: scenario, record, run, diagnosis with causes, free run, report, picture, and the
//! explorer with every view, without a window; then the simulated record as a measured file with faults. Whatever the
//! numbers, nothing may panic or take longer than a second, and what is refused is refused with a sentence.
//!
//! ```text
//! cargo test --test whole_way                                    a fixed number of cases
//! cargo test --test whole_way -- --seconds 3600 --first 100000   as many as fit into an hour, others than usual
//! cargo test --test whole_way -- --case 17                       one case, with its file
//! ```
//! Each case follows from its number alone. The files of cases that fail are kept in `target/tmp/whole-way`.

mod cases;
#[path = "../../benches/frame/clock.rs"]
#[expect(dead_code, reason = "the benchmark uses the rest")]
mod clock;
mod dice;
mod findings;
mod records;
mod scenarios;
mod screen;
mod way;

use std::process::ExitCode;

fn main() -> ExitCode {
    match cases::Plan::of(std::env::args().skip(1)) {
        Ok(plan) => plan.carry_out(),
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}
