//! The command `kalmanscope-cli run`.

use std::fs::File;
use std::io::{self, BufWriter, Write as _};
use std::path::{Path, PathBuf};

use kalmanscope_cli::{PlotError, causes, free_runs, plot_svg, step_times, table, write_estimates};
use kalmanscope_core::{Analysis, RecordError, Wanted};
use thiserror::Error;

use crate::args::RunArgs;
use crate::input::InputError;
use crate::prepared::Prepared;
use crate::report_error;

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
    let RunArgs { source, out, record_out, svg, fail_on } = args;
    let prepared = Prepared::new(source)?;
    let Prepared { scenario, run, is_measured, held_out, .. } = &prepared;

    let mut well = true;
    let mut write = |path: &Option<PathBuf>, writer: &dyn Fn(&Path) -> Result<(), OutputError>| {
        if let Some(path) = path
            && let Err(error) = writer(path)
        {
            well = false;
            report_error(&format_args!("{}: {error}", path.display()));
        }
    };
    write(out, &|path| Ok(write_estimates(run, create(path)?)?));
    write(record_out, &|path| Ok(run.record().write_csv(create(path)?)?));
    write(svg, &|path| Ok(plot_svg(run, path)?));

    let times = step_times(scenario, run).map_err(|error| prepared.bad_run(error))?;
    let analysis = Analysis::new(run, Wanted { bounds: true, ..Wanted::default() });
    let mut text = table(run, &analysis, &causes(run, &analysis), &times);
    if *is_measured {
        text.push_str(&free_runs(run, run.record(), "its own record"));
    }
    for (path, record) in held_out {
        text.push_str(&free_runs(run, record, &path.display().to_string()));
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

fn create(path: &Path) -> io::Result<BufWriter<File>> {
    Ok(BufWriter::new(File::create(path)?))
}
