//! The command `kalmanscope-cli run`.

use std::fs::File;
use std::io::{self, BufReader, BufWriter, Write as _};
use std::path::{Path, PathBuf};

use kalmanscope_cli::{PlotError, causes, plot_svg, run_scenario, step_times, table, write_estimates};
use kalmanscope_core::{Analysis, Record, RecordError, Scenario, Wanted};
use thiserror::Error;

use crate::args::RunArgs;
use crate::input::{InputError, read_text};
use crate::report_error;

/// Limits the samples of a run, because all are kept: at 100 Hz more than five hours, about a gigabyte of estimates per
/// filter.
const MOST: usize = 2_000_000;

/// The reason why a result could not be written.
#[derive(Debug, Error)]
enum OutputError {
    #[error(transparent)]
    Io(#[from] io::Error),
    #[error(transparent)]
    Csv(#[from] csv::Error),
    #[error(transparent)]
    Record(#[from] RecordError),
    #[error(transparent)]
    Plot(#[from] PlotError),
}

/// The outcome of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ending {
    /// All was written, and no filter stopped.
    Well,
    /// Something could not be written, or a filter stopped.
    Stopped,
    /// A filter has a verdict that was not to be.
    Verdict,
}

/// Runs the scenario, writes what was asked for and prints the table. What could not be written is told on standard error.
pub(crate) fn run(args: &RunArgs) -> Result<Ending, InputError> {
    let RunArgs { scenario: file, record, seed, out, record_out, svg, fail_on } = args;
    let mut scenario = read_scenario(file)?;
    if let Some(seed) = seed {
        scenario.seed = *seed;
    }
    if record.is_none() && scenario.samples() > MOST {
        return Err(InputError::TooLong { file: file.clone(), most: MOST });
    }
    let measured = record.as_deref().map(|path| read_record(path, &scenario)).transpose()?;
    let bad_run = |error| InputError::Run { file: file.clone(), error };
    let run = run_scenario(&scenario, measured).map_err(bad_run)?;

    let mut well = true;
    let mut write = |path: &Option<PathBuf>, writer: &dyn Fn(&Path) -> Result<(), OutputError>| {
        if let Some(path) = path
            && let Err(error) = writer(path)
        {
            well = false;
            report_error(&format_args!("{}: {error}", path.display()));
        }
    };
    write(out, &|path| Ok(write_estimates(&run, create(path)?)?));
    write(record_out, &|path| Ok(run.record().write_csv(create(path)?)?));
    write(svg, &|path| Ok(plot_svg(&run, path)?));

    let times = step_times(&scenario, &run).map_err(bad_run)?;
    let analysis = Analysis::new(&run, Wanted { bounds: true, ..Wanted::default() });
    // A closed pipe needs no message; the exit code reports the rest.
    if let Err(error) = io::stdout().write_all(table(&run, &analysis, &causes(&run, &analysis), &times).as_bytes())
        && error.kind() != io::ErrorKind::BrokenPipe
    {
        well = false;
        report_error(&format_args!("standard output: {error}"));
    }
    let verdict = |place: usize| Some(analysis.diagnosis(place)?.verdict.as_ref()?.kind);
    let refused = |place: usize| verdict(place).is_some_and(|kind| fail_on.contains(&kind));
    Ok(match (0..run.estimates().len()).any(refused) {
        true => Ending::Verdict,
        false if well && run.estimates().iter().all(|e| e.stop().is_none()) => Ending::Well,
        false => Ending::Stopped,
    })
}

fn create(path: &Path) -> io::Result<BufWriter<File>> {
    Ok(BufWriter::new(File::create(path)?))
}

fn read_scenario(file: &Path) -> Result<Scenario, InputError> {
    Scenario::from_toml(&read_text(file)?).map_err(|error| InputError::Scenario { file: file.to_owned(), error })
}

fn read_record(path: &Path, scenario: &Scenario) -> Result<Record, InputError> {
    let file = File::open(path).map_err(|error| InputError::Read { file: path.to_owned(), error })?;
    let sensors: Vec<_> = scenario.sensors.iter().map(|s| s.measures).collect();
    Record::read_csv(BufReader::new(file), &sensors)
        .map_err(|error| InputError::Record { file: path.to_owned(), error })
}
