//! The arguments of commands about one filter.

use std::path::PathBuf;

use clap::Args;
use kalmanscope_core::Quantity;
use kalmanscope_lab::tune::Goal;

use super::RecordArgs;

#[derive(Debug, Args)]
pub(crate) struct TuneArgs {
    /// The scenario, a TOML file; `-` for standard input
    pub(crate) scenario: PathBuf,
    /// A setting of the filter to turn, as lessons name it, and the range to stay in; without a range two decades each way or as
    /// far as the slider goes. May be given for several
    #[arg(long, value_name = "KEY[=FROM:TO[:log]]", required = true)]
    pub(crate) turn: Vec<String>,
    /// The filter; the first one if left out
    #[arg(long, value_name = "NAME")]
    pub(crate) filter: Option<String>,
    /// The number to make best: likelihood, consistency, or free_run with a sensor behind a dot, as in free_run.displacement
    #[arg(long, value_name = "GOAL", default_value = "likelihood", value_parser = goal)]
    pub(crate) goal: Goal,
    #[command(flatten)]
    pub(crate) record: RecordArgs,
    /// Write the scenario with the tuned filter
    #[arg(long, value_name = "SCENARIO.toml")]
    pub(crate) out: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct PosteriorArgs {
    /// The scenario, a TOML file; `-` for standard input
    pub(crate) scenario: PathBuf,
    /// The filter; the first one if left out
    #[arg(long, value_name = "NAME")]
    pub(crate) filter: Option<String>,
    #[command(flatten)]
    pub(crate) record: RecordArgs,
    /// Write the points, a row each
    #[arg(long, value_name = "POINTS.csv")]
    pub(crate) out: Option<PathBuf>,
}

fn goal(text: &str) -> Result<Goal, String> {
    match text.split_once('.') {
        None if text == "likelihood" => Ok(Goal::Likelihood),
        None if text == "consistency" => Ok(Goal::Consistency),
        Some(("free_run", sensor)) => {
            Quantity::from_key(sensor).map(Goal::FreeRun).ok_or_else(|| format!("there is no quantity `{sensor}`"))
        }
        _ => Err("expected likelihood, consistency or free_run.SENSOR".to_owned()),
    }
}
