//! The command `kalmanscope-cli`.
//!
//! Exit codes: 0 success; 1 a result could not be written, or a filter stopped; 2 invalid input;
//! 3 a filter has a verdict that `--fail-on` names.

mod args;
mod files;
mod import;
mod population;
mod posterior;
mod prepared;
mod progress;
mod run;
mod stream;
mod sweep;
mod tune;

use std::process::ExitCode;

use clap::Parser as _;

use args::{Command, CommandLine};

fn main() -> ExitCode {
    let code = match CommandLine::parse().command {
        Command::Run(args) => run::run(&args),
        Command::Import(args) => import::import(&args).map(|()| 0),
        Command::Stream(args) => stream::stream(&args).map(|has_filter| u8::from(!has_filter)),
        Command::Sweep(args) => sweep::sweep(&args).map(|()| 0),
        Command::Population(args) => population::population(&args).map(|()| 0),
        Command::Posterior(args) => posterior::posterior(&args).map(|()| 0),
        Command::Tune(args) => tune::tune(&args).map(|()| 0),
    };
    ExitCode::from(code.unwrap_or_else(|error| {
        files::report_error(&error);
        error.code()
    }))
}
