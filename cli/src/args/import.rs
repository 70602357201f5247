//! The options of an import.

use std::path::PathBuf;

use clap::Args;
use kalmanscope_core::equation::EquationSettings;
use kalmanscope_core::import::{Dimension, unit};
use kalmanscope_core::{PlantKind, Quantity};

#[derive(Debug, Args)]
pub(crate) struct ImportArgs {
    /// The record, a file with columns of numbers; `-` for standard input
    pub(crate) file: PathBuf,
    /// The scenario to write; standard output if left out or `-`
    #[arg(long, value_name = "SCENARIO.toml")]
    pub(crate) out: Option<PathBuf>,
    /// Take the free decay from an accelerometer with three axes, as a phone writes it, write it to this file, and go on with it
    #[arg(long, value_name = "DECAY.csv", conflicts_with_all = ["rate", "time", "time_unit", "input", "sensor", "ground"])]
    pub(crate) decay: Option<PathBuf>,
    /// A second file of the same time with a clock of its own, such as that of another logger
    #[arg(long, value_name = "OTHER.csv", requires = "joined", conflicts_with_all = ["decay", "rate", "time", "time_unit"])]
    pub(crate) with: Option<PathBuf>,
    /// What is added to the times of the second file [s]; without it, what both files measured tells it
    #[arg(long, value_name = "SECONDS", requires = "with", allow_negative_numbers = true, value_parser = offset)]
    pub(crate) offset: Option<f64>,
    /// The file to write with the columns of both, each with its times
    #[arg(long, value_name = "BOTH.csv", requires = "with")]
    pub(crate) joined: Option<PathBuf>,
    /// Samples in a second, for a file without times
    #[arg(long, value_name = "HZ")]
    pub(crate) rate: Option<f64>,
    /// The column of the times
    #[arg(long, value_name = "COLUMN")]
    pub(crate) time: Option<String>,
    /// The unit of the times, such as ms, where the file does not tell it
    #[arg(long, value_name = "UNIT", value_parser = time_unit, conflicts_with = "rate")]
    pub(crate) time_unit: Option<String>,
    /// The samples are equally spaced: put them at even steps, whatever the times say
    #[arg(long, conflicts_with = "rate")]
    pub(crate) even: bool,
    /// The number that stands in cells without a reading, such as -9999; `none` if all numbers are readings
    #[arg(long, value_name = "NUMBER", value_parser = missing, allow_negative_numbers = true)]
    pub(crate) missing: Option<Missing>,
    /// The column of the input
    #[arg(long, value_name = "COLUMN")]
    pub(crate) input: Option<String>,
    /// There is no recorded input, as under wind or traffic, whatever the columns look like; `--input none` says the same
    #[arg(long, conflicts_with_all = ["input", "ground"])]
    pub(crate) no_input: bool,
    /// The input is the acceleration of the ground, not a force
    #[arg(long)]
    pub(crate) ground: bool,
    /// The column of a sensor, such as displacement=V2; may be given for several
    #[arg(long, value_name = "QUANTITY=COLUMN", value_parser = sensor)]
    pub(crate) sensor: Vec<(Quantity, String)>,
    /// Use the record from this time on [s]
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    pub(crate) from: Option<f64>,
    /// Use the record up to this time [s]
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    pub(crate) to: Option<f64>,
    /// Band-pass input and sensors, from and to [Hz], by Butterworth filters run forward and backward
    #[arg(long, value_names = ["LOW", "HIGH"], num_args = 2)]
    pub(crate) band: Option<Vec<f64>>,
    /// Keep one of so many samples, after a low-pass
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) every: usize,
    /// Put so many steps in place of one: a band-limited input, measurements missing in between
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) interpolate: usize,
    /// The kind of plant that the filters assume, or its equation, as "x'' + c x' + k x = f"
    #[arg(long, value_name = "KIND", default_value = "sdof", value_parser = plant)]
    pub(crate) plant: PlantKind,
}

fn sensor(text: &str) -> Result<(Quantity, String), String> {
    let (key, column) = text.split_once('=').ok_or("expected QUANTITY=COLUMN, such as displacement=V2")?;
    let quantity = Quantity::from_key(key.trim()).ok_or_else(|| format!("there is no quantity `{key}`"))?;
    Ok((quantity, column.trim().to_owned()))
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
    let all = || PlantKind::ALL.into_iter();
    let keys = || all().map(|kind| kind.info().key).collect::<Vec<_>>().join(", ");
    all().find(|kind| kind.info().key == key).ok_or_else(|| format!("expected an equation, or one of {}", keys()))
}
