//! The command line.

use std::path::PathBuf;
use std::str::FromStr;

use clap::{Args, Parser, Subcommand};
use kalmanscope_core::equation::EquationSettings;
use kalmanscope_core::import::{Dimension, unit};
use kalmanscope_core::{Axis, ForcedMass, PlantKind, Quantity};
use kalmanscope_diagnosis::{MeasureKind, VerdictKind};
use kalmanscope_lab::tune::Goal;

use crate::files::{Places, places};

/// System identification with Kalman filters on the command line
#[derive(Debug, Parser)]
#[command(name = "kalmanscope-cli", version)]
pub(crate) struct CommandLine {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Run a scenario: each filter's verdict, likely cause and estimates, on screen and in files
    #[command(
        after_help = "Examples:\n  kalmanscope-cli run scenario.toml --out estimates.csv --out plots.svg\n  kalmanscope-cli run record.toml --holdout other.csv --out report.html\n  kalmanscope-cli run record.toml --fix 1 --out fixed.toml"
    )]
    Run(RunArgs),
    /// Read a measured record and write a scenario for it, with start values found from its data
    #[command(
        after_help = "Examples:\n  kalmanscope-cli import record.csv --out record.toml\n  kalmanscope-cli import raw.txt --rate 200 --input V1 --sensor displacement=V2 --out record.toml\n  kalmanscope-cli import phyphox.csv --decay decay.csv --out decay.toml\n  zcat record.csv.gz | kalmanscope-cli import - > record.toml"
    )]
    Import(Box<ImportArgs>),
    /// Run every combination of some settings and write a row of scores for each
    #[command(
        after_help = "Example:\n  kalmanscope-cli sweep scenario.toml --vary filters.EKF.fading=1:1.02:5 --seeds 100 --out table.csv"
    )]
    Sweep(SweepArgs),
    /// Run many oscillators drawn at random and print how often each filter is right, and why it is not
    #[command(
        after_help = "Example:\n  kalmanscope-cli population scenario.toml --members 100 --causes\nThe table [draw] of the scenario gives laws for some of its numbers. Over a measured record, only numbers of filters\ncan be drawn:\n  [draw]\n  \"plant.natural_frequency\" = { lognormal = [6.0, 0.2] }\n  \"filters.1.initial_mean.natural_frequency\" = { normal = [8.0, 2.0] }"
    )]
    Population(PopulationArgs),
    /// Filter readings as they arrive: a line in, the newest estimates out
    #[command(
        after_help = "Examples:\n  kalmanscope-cli run scenario.toml --quiet --record-out - | kalmanscope-cli stream scenario.toml\n  mosquitto_sub -t shaker | kalmanscope-cli stream scenario.toml --json\n  kalmanscope-cli stream scenario.toml udp://127.0.0.1:9870 --late 0.5"
    )]
    Stream(StreamArgs),
    /// Find the settings with which a filter does best on a record
    #[command(
        after_help = "Example:\n  kalmanscope-cli tune record.toml --turn filters.EKF.fading=1:1.02 --out tuned.toml"
    )]
    Tune(TuneArgs),
    /// Find the posterior of a filter's parameters, whatever its shape, and compare the filter's ±2σ with it
    #[command(after_help = "Example:\n  kalmanscope-cli posterior record.toml --filter UKF --out points.csv")]
    Posterior(PosteriorArgs),
}

#[derive(Debug, Args)]
pub(crate) struct StreamArgs {
    /// The scenario, a TOML file; its force and its truth are not used
    pub(crate) scenario: PathBuf,
    /// Where lines come from: a file, `tcp://HOST:PORT` to connect to, `udp://HOST:PORT` to listen at,
    /// `serial:/dev/ttyUSB0?baud=115200`, or `-` for standard input.
    /// A line is a row of numbers under a header such as `t,force,displacement`, or a JSON object such as
    /// {"t": 0.01, "displacement": 0.002}. Cells may be empty, so each sensor may have its own clock
    #[arg(default_value = "-")]
    pub(crate) source: PathBuf,
    /// Use readings that arrive late by up to this time, each at its own time
    #[arg(long, value_name = "SECONDS", default_value_t = 1.0, value_parser = seconds)]
    pub(crate) late: f64,
    /// Write a JSON object per line instead of a table
    #[arg(long)]
    pub(crate) json: bool,
}

fn seconds(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok().filter(|seconds: &f64| (0.0..=3600.0).contains(seconds));
    seconds.ok_or_else(|| "expected a number from 0 to 3600".to_owned())
}

#[derive(Debug, Args)]
pub(crate) struct SweepArgs {
    #[command(flatten)]
    pub(crate) input: InputArgs,
    /// A setting to vary between two values in equal steps, or with `:log` in equal ratios.
    /// May be given several times; the last one changes fastest. A table of standard deviations, such as
    /// filters.EKF.process_std, is varied by a factor on all of them
    #[arg(long, value_name = "KEY=FROM:TO:COUNT[:log]", value_parser = Axis::parse, allow_hyphen_values = true)]
    pub(crate) vary: Vec<Axis>,
    /// Run each combination with the seeds 1 to N; the seed changes fastest
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) seeds: Option<u32>,
    #[arg(long, value_name = "SCORES", value_delimiter = ',', help = score_help())]
    pub(crate) score: Vec<String>,
    /// Score this filter only; may be given several times
    #[arg(long, value_name = "NAME")]
    pub(crate) filter: Vec<String>,
    /// The table to write, a .csv file. Finished rows are kept in TABLE.part, so that the same command continues after
    /// an interruption. `-` writes rows to standard output and always begins with the first
    #[arg(long, value_name = "TABLE")]
    pub(crate) out: PathBuf,
    /// Compute only part I of N, such as 3/8; the parts in order make the whole table
    #[arg(long, value_name = "I/N", default_value = "1/1")]
    pub(crate) shard: Shard,
    /// Number of threads, at most 256; 0 uses every processor
    #[arg(long, value_name = "K", default_value_t = 0)]
    pub(crate) threads: usize,
}

#[derive(Debug, Args)]
pub(crate) struct PopulationArgs {
    #[command(flatten)]
    pub(crate) input: InputArgs,
    /// Number of members; they have the seeds 1 to N
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(crate) members: u32,
    /// Run this filter only; may be given several times
    #[arg(long, value_name = "NAME")]
    pub(crate) filter: Vec<String>,
    /// Search for the causes of each bad verdict, which takes up to seconds per member
    #[arg(long)]
    pub(crate) causes: bool,
    /// Print JSON instead of text
    #[arg(long)]
    pub(crate) json: bool,
    /// Number of threads, at most 256; 0 uses every processor
    #[arg(long, value_name = "K", default_value_t = 0)]
    pub(crate) threads: usize,
    /// Show no progress
    #[arg(long)]
    pub(crate) quiet: bool,
}

/// A scenario, and a measured record in place of a simulated one.
#[derive(Debug, Args)]
pub(crate) struct InputArgs {
    /// The scenario, a TOML file; `-` for standard input
    pub(crate) scenario: PathBuf,
    /// Filter this record instead of a simulated one; `-` for standard input. What its columns mean is taken from `[record]`
    /// in the scenario, or else guessed from their names
    #[arg(long, value_name = "RECORD.csv")]
    pub(crate) record: Option<PathBuf>,
}

impl InputArgs {
    pub(crate) fn inputs(&self) -> Places<'_> {
        let Self { scenario, record } = self;
        [places("the scenario", [scenario]), places("--record", record)].concat()
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shard {
    /// Its number, from 1 on.
    pub(crate) number: usize,
    pub(crate) of: usize,
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text.split_once('/').and_then(|(number, of)| Some((number.parse().ok()?, of.parse().ok()?)));
        let shard = numbers.filter(|(number, of)| (1..=*of).contains(number));
        let (number, of) = shard.ok_or("expected I/N with I from 1 to N, such as 3/8")?;
        Ok(Self { number, of })
    }
}

/// The source of a run's samples.
#[derive(Debug, Args)]
pub(crate) struct SourceArgs {
    #[command(flatten)]
    pub(crate) input: InputArgs,
    /// Predict this record, which the filters do not see, with the identified models; its columns mean the same
    #[arg(long, value_name = "RECORD.csv")]
    pub(crate) holdout: Vec<PathBuf>,
    /// No input was recorded, as under wind or traffic; no column is taken for it
    #[arg(long)]
    pub(crate) no_input: bool,
    /// Seed of the random numbers instead of the scenario's; has no effect on a measured record
    // A report writes its scenario as TOML, whose integers end there.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(..=i64::MAX as u64))]
    pub(crate) seed: Option<u64>,
}

impl SourceArgs {
    pub(crate) fn inputs(&self) -> Places<'_> {
        [self.input.inputs(), places("--holdout", &self.holdout)].concat()
    }
}

#[derive(Debug, Args)]
pub(crate) struct RunArgs {
    #[command(flatten)]
    pub(crate) source: SourceArgs,
    /// Write the results to this file, in the form that its ending names: .csv all estimates, .svg plots over time, .html a
    /// report to read or print, .json everything, .toml the scenario with --fix. May be given several times. `-` writes
    /// estimates to standard output, and the table then goes to standard error
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Vec<PathBuf>,
    /// Write the scenario with remedy N of each filter that should not be trusted to the .toml file of --out; the table numbers
    /// the remedies
    #[arg(long, value_name = "N", requires = "out", value_parser = clap::value_parser!(u8).range(1..))]
    pub(crate) fix: Option<u8>,
    /// Write force, measurements and truth, as --record reads them
    #[arg(long, value_name = "RECORD.csv")]
    pub(crate) record_out: Option<PathBuf>,
    /// Exit with code 3 if the verdict on a filter is one of these: consistent, recovered,
    /// not-identifiable, underconfident, pattern-left, overconfident, wound-up, collapsed, lost, diverged
    #[arg(long, value_name = "VERDICTS", value_delimiter = ',', value_parser = verdict)]
    pub(crate) fail_on: Vec<VerdictKind>,
    /// Print JSON instead of the table: as --out FILE.json, but without the numbers of each sample
    #[arg(long)]
    pub(crate) json: bool,
    /// Print errors only, no table and no remarks
    #[arg(long, conflicts_with = "json")]
    pub(crate) quiet: bool,
    /// Print everything: the evidence, all causes and channels, errors, bounds, NIS, NEES and likelihoods
    #[arg(long, short, conflicts_with_all = ["json", "quiet"])]
    pub(crate) verbose: bool,
}

fn score_help() -> String {
    let words = |of: fn(MeasureKind) -> bool| {
        let kinds = MeasureKind::all().filter(|kind| kind.info().is_number() && !kind.info().needs_others && of(*kind));
        kinds.map(String::from).collect::<Vec<_>>().join(", ")
    };
    format!(
        "The scores to write: {}; for a channel, as in rmse.natural_frequency: {}; for a sensor, as in free_run.displacement: {} \
        [default: all that need no history]",
        words(|kind| !kind.needs_channel() && !kind.needs_sensor()),
        words(MeasureKind::needs_channel),
        words(MeasureKind::needs_sensor),
    )
}

fn verdict(word: &str) -> Result<VerdictKind, String> {
    let keys = || VerdictKind::ALL.map(VerdictKind::key).join(", ");
    let found = VerdictKind::ALL.into_iter().find(|kind| kind.key() == word.trim());
    found.ok_or_else(|| format!("expected one or several of {}", keys()))
}

#[derive(Debug, Args)]
pub(crate) struct TuneArgs {
    #[command(flatten)]
    pub(crate) input: InputArgs,
    /// A setting of the filter to tune, and its range; by default two decades each way, or the range of its slider. May be
    /// given several times
    #[arg(long, value_name = "KEY[=FROM:TO[:log]]", required = true)]
    pub(crate) turn: Vec<String>,
    /// The filter [default: the first one]
    #[arg(long, value_name = "NAME")]
    pub(crate) filter: Option<String>,
    /// What to optimise: likelihood, consistency, or free_run.SENSOR, as in free_run.displacement
    #[arg(long, value_name = "GOAL", default_value = "likelihood", value_parser = goal)]
    pub(crate) goal: Goal,
    /// Write the scenario with the tuned filter
    #[arg(long, value_name = "SCENARIO.toml")]
    pub(crate) out: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct PosteriorArgs {
    #[command(flatten)]
    pub(crate) input: InputArgs,
    /// The filter [default: the first one]
    #[arg(long, value_name = "NAME")]
    pub(crate) filter: Option<String>,
    /// Write the points of the posterior, one per row
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

#[derive(Debug, Args)]
pub(crate) struct ImportArgs {
    /// The record, a file with columns of numbers, or `-` for standard input
    pub(crate) file: PathBuf,
    /// The scenario to write [default: standard output]
    #[arg(long, value_name = "SCENARIO.toml")]
    pub(crate) out: Option<PathBuf>,
    /// Find the free decay in a record of three accelerations, such as a phone's; write it to this file and use it as the record
    // The decay's own file has other columns than the one that a user would name here.
    #[arg(long, value_name = "DECAY.csv", conflicts_with_all = ["time", "time_unit", "input", "sensor", "ground"])]
    pub(crate) decay: Option<PathBuf>,
    /// A second file from the same time with another clock, such as that of another logger
    #[arg(long, value_name = "OTHER.csv", requires_all = ["joined", "offset"], conflicts_with_all = ["decay", "rate", "time", "time_unit"])]
    pub(crate) with: Option<PathBuf>,
    /// What to add to the times of the second file [s]
    #[arg(long, value_name = "SECONDS", requires = "with", allow_negative_numbers = true, value_parser = offset)]
    pub(crate) offset: Option<f64>,
    /// Write the columns of both files to this one, each with its times
    #[arg(long, value_name = "BOTH.csv", requires = "with")]
    pub(crate) joined: Option<PathBuf>,
    /// Samples per second, for a file without times
    #[arg(long, value_name = "HZ")]
    pub(crate) rate: Option<f64>,
    /// The column of the times
    #[arg(long, value_name = "COLUMN")]
    pub(crate) time: Option<String>,
    /// The unit of the times, such as ms, if the file does not say it
    #[arg(long, value_name = "UNIT", value_parser = time_unit, conflicts_with = "rate")]
    pub(crate) time_unit: Option<String>,
    /// Take the samples as equally spaced, whatever their times say
    #[arg(long, conflicts_with = "rate")]
    pub(crate) even: bool,
    /// The number that marks a missing reading, such as -9999, or `none` if all numbers are readings
    #[arg(long, value_name = "NUMBER", value_parser = missing, allow_negative_numbers = true)]
    pub(crate) missing: Option<Missing>,
    /// The column of the input
    #[arg(long, value_name = "COLUMN")]
    pub(crate) input: Option<String>,
    /// No input was recorded, as under wind or traffic, whatever the columns look like
    #[arg(long, conflicts_with_all = ["input", "ground"])]
    pub(crate) no_input: bool,
    /// The input is the acceleration of the ground, not a force
    #[arg(long)]
    pub(crate) ground: bool,
    /// The column of a force on one mass, besides the input, such as 3=F3; may be given several times
    #[arg(long, value_name = "MASS=COLUMN", value_parser = force_on)]
    pub(crate) force_on: Vec<(ForcedMass, String)>,
    /// The column of a sensor, such as displacement=V2; may be given several times
    #[arg(long, value_name = "QUANTITY=COLUMN", value_parser = sensor)]
    pub(crate) sensor: Vec<(Quantity, String)>,
    /// Use the record from this time on [s]
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    pub(crate) from: Option<f64>,
    /// Use the record up to this time [s]
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    pub(crate) to: Option<f64>,
    /// Keep this band of input and sensors [Hz], by Butterworth filters run forward and backward
    #[arg(long, value_names = ["LOW", "HIGH"], num_args = 2)]
    pub(crate) band: Option<Vec<f64>>,
    /// Keep every N-th sample, after a low-pass filter
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) every: usize,
    /// Divide each step into N: the input is interpolated within its band, and measurements are missing in between
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) interpolate: usize,
    /// The kind of plant that the filters assume, or an equation such as "x'' + c x' + k x = f"
    #[arg(long, value_name = "KIND", default_value = "sdof", value_parser = plant)]
    pub(crate) plant: PlantKind,
}

fn sensor(text: &str) -> Result<(Quantity, String), String> {
    let (key, column) = text.split_once('=').ok_or("expected QUANTITY=COLUMN, such as displacement=V2")?;
    let quantity = Quantity::from_key(key.trim()).ok_or_else(|| format!("there is no quantity `{key}`"))?;
    Ok((quantity, column.trim().to_owned()))
}

fn force_on(text: &str) -> Result<(ForcedMass, String), String> {
    let (number, column) = text.split_once('=').ok_or("expected MASS=COLUMN, such as 3=F3")?;
    let mass = ForcedMass::from_key(&format!("force_on_{}", number.trim()));
    Ok((
        mass.ok_or_else(|| format!("there is no mass `{number}`: they are numbered from 1"))?,
        column.trim().to_owned(),
    ))
}

fn offset(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok().filter(|seconds: &f64| seconds.is_finite());
    seconds.ok_or_else(|| "expected a number of seconds".to_owned())
}

fn time_unit(text: &str) -> Result<String, String> {
    match unit(text) {
        Some((Dimension::Time, _)) => Ok(text.to_owned()),
        _ => Err("expected a unit of time, such as s, ms, us, min".to_owned()),
    }
}

/// The number that stands in cells without a reading, if there is one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Missing(pub(crate) Option<f64>);

fn missing(text: &str) -> Result<Missing, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite());
    match number {
        None if text != "none" => Err("expected a number, or `none`".to_owned()),
        number => Ok(Missing(number)),
    }
}

fn plant(key: &str) -> Result<PlantKind, String> {
    if key.contains('=') {
        return PlantKind::of_equation(&EquationSettings::new(key)).map_err(|error| error.to_string());
    }
    let keys = || PlantKind::ALL.map(|kind| kind.key().to_owned()).join(", ");
    PlantKind::from_key(key).ok_or_else(|| format!("expected an equation, or one of {}", keys()))
}
