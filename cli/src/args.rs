//! The command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use kalmanscope_core::VerdictKind;

/// System identification with Kalman filters on the command line
#[derive(Debug, Parser)]
#[command(name = "kalmanscope-cli", version)]
pub(crate) struct CommandLine {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Run a scenario to its end and print the results of each filter
    Run(RunArgs),
    /// Read a lesson and try each of its claims on several records
    Lesson(LessonArgs),
}

#[derive(Debug, Args)]
pub(crate) struct LessonArgs {
    /// The lesson, a TOML file; `-` for standard input
    pub(crate) lesson: PathBuf,
    /// Number of records to try, with the seeds 1, 2, ...
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u64).range(1..=100_000))]
    pub(crate) seeds: u64,
}

#[derive(Debug, Args)]
pub(crate) struct RunArgs {
    /// The scenario, a TOML file; `-` for standard input
    pub(crate) scenario: PathBuf,
    /// Filter this record instead of simulating one: a CSV file with the columns t, force and one for each sensor
    #[arg(long, value_name = "RECORD.csv")]
    pub(crate) record: Option<PathBuf>,
    /// Seed of the random numbers, instead of the scenario's; has no effect with --record
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(..=i64::MAX as u64))]
    pub(crate) seed: Option<u64>,
    /// Write every estimate of every filter
    #[arg(long, value_name = "ESTIMATES.csv")]
    pub(crate) out: Option<PathBuf>,
    /// Write force, measurements and truth, as --record reads them
    #[arg(long, value_name = "RECORD.csv")]
    pub(crate) record_out: Option<PathBuf>,
    /// Draw truth, measurements and estimates over time
    #[arg(long, value_name = "PLOTS.svg")]
    pub(crate) svg: Option<PathBuf>,
    /// Exit with code 3 where the verdict on a filter is one of these: consistent, consistent-but-for-a-time,
    /// not-identifiable, underconfident, overconfident, wound-up, collapsed, lost, diverged
    #[arg(long, value_name = "VERDICTS", value_delimiter = ',', value_parser = verdict)]
    pub(crate) fail_on: Vec<VerdictKind>,
}

fn verdict(word: &str) -> Result<VerdictKind, String> {
    let keys = || VerdictKind::ALL.map(VerdictKind::key).join(", ");
    let found = VerdictKind::ALL.into_iter().find(|kind| kind.key() == word.trim());
    found.ok_or_else(|| format!("expected one or several of {}", keys()))
}
