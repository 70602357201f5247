//! The command `kalmanscope-cli`.
//!
//! Exit codes: 0 done; 1 something could not be written, or a filter stopped by itself; 2 bad input; 3 a filter has a verdict
//! that `--fail-on` names.

mod args;
mod command;

use std::process::ExitCode;

use clap::Parser as _;

use args::{Command, CommandLine};
use command::Ending;

fn main() -> ExitCode {
    let CommandLine { command: Command::Run(args) } = CommandLine::parse();
    match command::run(&args) {
        Ok(Ending::Well) => ExitCode::SUCCESS,
        Ok(Ending::Stopped) => ExitCode::FAILURE,
        Ok(Ending::Verdict) => ExitCode::from(3),
        Err(error) => {
            command::tell(&error);
            ExitCode::from(2)
        }
    }
}
