//! The command `kalmanscope-cli`.
//!
//! Exit codes: 0 success; 1 a result could not be written, or a filter stopped; 2 invalid input; 3 a filter has a
//! verdict that `--fail-on` names.

mod args;
mod run;

use std::process::ExitCode;

use clap::Parser as _;

use args::{Command, CommandLine};
use run::Ending;

fn main() -> ExitCode {
    let CommandLine { command: Command::Run(args) } = CommandLine::parse();
    match run::run(&args) {
        Ok(Ending::Well) => ExitCode::SUCCESS,
        Ok(Ending::Stopped) => ExitCode::FAILURE,
        Ok(Ending::Verdict) => ExitCode::from(3),
        Err(error) => {
            run::report_error(&error);
            ExitCode::from(2)
        }
    }
}
