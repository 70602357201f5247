//! The command `kalmanscope-cli`.
//!
//! Exit codes: 0 success; 1 a result could not be written, or a filter stopped; 2 invalid input.

mod args;
mod run;

use std::process::ExitCode;

use clap::Parser as _;

use args::{Command, CommandLine};

fn main() -> ExitCode {
    let CommandLine { command: Command::Run(args) } = CommandLine::parse();
    match run::run(&args) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            run::report_error(&error);
            ExitCode::from(2)
        }
    }
}
