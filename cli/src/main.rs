//! The command `kalmanscope-cli`.
//!
//! Exit codes: 0 success; 1 a result could not be written, or a filter stopped; 2 invalid input;
//! 3 a filter has a verdict that `--fail-on` names.

mod args;
mod files;
mod import;
mod of_filter;
mod population;
mod prepared;
mod progress;
mod run;
mod stream;
mod sweep;

use std::process::ExitCode;

use clap::Parser as _;

use args::{Command, CommandLine};
use run::Ending;

fn main() -> ExitCode {
    let done = match CommandLine::parse().command {
        Command::Run(args) => run::run(&args).map(|ending| match ending {
            Ending::Well => ExitCode::SUCCESS,
            Ending::Stopped => ExitCode::FAILURE,
            Ending::Verdict => ExitCode::from(3),
        }),
        Command::Import(args) => import::import(&args).map(|()| ExitCode::SUCCESS),
        Command::Stream(args) => {
            stream::stream(&args).map(|has_filter| if has_filter { ExitCode::SUCCESS } else { ExitCode::FAILURE })
        }
        Command::Sweep(args) => sweep::sweep(&args).map(|()| ExitCode::SUCCESS),
        Command::Population(args) => population::population(&args).map(|()| ExitCode::SUCCESS),
        Command::Posterior(args) => of_filter::posterior(&args).map(|()| ExitCode::SUCCESS),
        Command::Tune(args) => of_filter::tune(&args).map(|()| ExitCode::SUCCESS),
    };
    done.unwrap_or_else(|error| {
        files::report_error(&error);
        ExitCode::from(error.code())
    })
}
