//! The command `kalmanscope-cli`.
//!
//! Exit codes: 0 done; 1 something could not be written, or a filter stopped by itself; 2 bad input.

mod args;
mod command;

use std::process::ExitCode;

use clap::Parser as _;

use args::{Command, CommandLine};

fn main() -> ExitCode {
    let CommandLine { command: Command::Run(args) } = CommandLine::parse();
    match command::run(&args) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            command::tell(&error);
            ExitCode::from(2)
        }
    }
}
