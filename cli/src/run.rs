//! The command `kalmanscope-cli run`.

use std::fs::File;
use std::io::{self, BufWriter, Write as _};
use std::path::{Path, PathBuf};

use kalmanscope_cli::{PlotError, causes, free_runs, plot_svg, run_scenario, step_times, table, write_estimates};
use kalmanscope_core::import::Imported;
use kalmanscope_core::{Analysis, RecordError, Run, Scenario, Wanted};
use thiserror::Error;

use crate::args::RunArgs;
use crate::input::{InputError, read_text};
use crate::record::{measured, read};
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
    let RunArgs { scenario: file, record: _, map: _, holdout, then, seed, out, record_out, svg, fail_on } = args;
    let mut scenario = read_scenario(file)?;
    if let Some(seed) = seed {
        scenario.seed = *seed;
    }
    let imported = measured(args, &mut scenario)?;
    if imported.is_none() && scenario.samples() > MOST {
        return Err(InputError::TooLong { file: file.clone(), most: MOST });
    }
    let is_measured = imported.is_some() || !then.is_empty();
    let (record, remarks) = imported.map_or((None, Vec::new()), |Imported { record, remarks }| (Some(record), remarks));
    remarks.iter().for_each(|remark| {
        let _ = writeln!(io::stderr(), "{remark}");
    });
    let held_out = holdout.iter().map(|path| Ok((path, read(path, &mut scenario.clone())?.record)));
    let held_out = held_out.collect::<Result<Vec<_>, InputError>>()?;
    let bad_run = |error| InputError::Run { file: file.clone(), error };
    let mut run = run_scenario(&scenario, record).map_err(bad_run)?;
    for path in then {
        continue_from(&run, &mut scenario);
        let next = read(path, &mut scenario)?.record;
        run = run_scenario(&scenario, Some(next)).map_err(bad_run)?;
    }

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
    let mut text = table(&run, &analysis, &causes(&run, &analysis), &times);
    if is_measured {
        text.push_str(&free_runs(&run, run.record(), "its own record"));
    }
    for (path, record) in &held_out {
        text.push_str(&free_runs(&run, record, &path.display().to_string()));
    }
    // A closed pipe needs no message; the exit code reports the rest.
    if let Err(error) = io::stdout().write_all(text.as_bytes())
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

/// Lets each filter begin with the parameters that it has found: their means and standard deviations, without the correlations
/// between them. The motion begins anew.
fn continue_from(run: &Run, scenario: &mut Scenario) {
    for (filter, estimates) in scenario.filters.iter_mut().zip(run.estimates()) {
        let Some(last) = estimates.len().checked_sub(1) else { continue };
        for (place, &channel) in estimates.channels().iter().enumerate() {
            if channel.is_parameter() || channel.is_augmentation() {
                filter.initial_mean[channel] = estimates.canonical_mean(last, place);
                filter.initial_std[channel] = estimates.std(last, place);
            }
        }
    }
}

fn create(path: &Path) -> io::Result<BufWriter<File>> {
    Ok(BufWriter::new(File::create(path)?))
}

fn read_scenario(file: &Path) -> Result<Scenario, InputError> {
    Scenario::from_toml(&read_text(file)?).map_err(|error| InputError::Scenario { file: file.to_owned(), error })
}
