//! The command `kalmanscope-cli run`.

use std::io::{self, Write};
use std::path::PathBuf;

use kalmanscope_cli::{PlotError, causes, free_runs, json, step_times, svg, table, write_estimates};
use kalmanscope_core::diagnosis::Finding;
use kalmanscope_core::{Analysis, Record, RecordError, Run, VerdictKind, Wanted};
use thiserror::Error;

use crate::args::RunArgs;
use crate::fix::write_fixed;
use crate::input::InputError;
use crate::places::{Places, is_standard_output, places, print, say, write};
use crate::prepared::Prepared;
use crate::record::READY;
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

/// The name of the record that the filters follow.
const OWN: &str = "its own record";

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
    let RunArgs { source, fix, out, record_out, svg: picture, fail_on, json: as_json, quiet } = args;
    let outputs: Places<'_> = [("--out", out), ("--record-out", record_out), ("--svg", picture)]
        .map(|(word, file)| places(word, file))
        .concat();
    let prepared = Prepared::new(source, &outputs, *quiet)?;
    let Prepared { run, is_measured, .. } = &prepared;

    let mut well = true;
    let mut save = |path: &Option<PathBuf>, writer: &dyn Fn(&mut dyn Write) -> Result<(), OutputError>| {
        if let Some(path) = path
            && let Err(error) = write(path, writer)
        {
            well = false;
            report_error(&format_args!("{}: {error}", path.display()));
        }
    };
    save(&out.clone().filter(|_| fix.is_none()), &|file| Ok(write_estimates(run, file)?));
    save(record_out, &|file| write_record(run, *is_measured, file));
    save(picture, &|file| Ok(file.write_all(svg(run)?.as_bytes())?));

    let analysis = Analysis::new(run, Wanted { bounds: true, ..Wanted::default() });
    let causes = if *quiet && fix.is_none() { Vec::new() } else { causes(run, &analysis) };
    if let (Some(number), Some(out)) = (fix, out) {
        write_fixed(&prepared, &causes, usize::from(*number), out)?;
    }
    if !quiet {
        let text =
            if *as_json { results(&prepared, &analysis, &causes)? } else { words(&prepared, &analysis, &causes)? };
        // Standard output is the file's that asks for it.
        if outputs.iter().any(|(_, file)| is_standard_output(file)) {
            say(&text.trim_end());
        } else if let Err(error) = print(&text) {
            well = false;
            report_error(&error);
        }
    }
    let refused = refused(run, &analysis, fail_on);
    for (name, kind) in &refused {
        say(&format_args!("--fail-on: the verdict on {name} is {}", kind.name()));
    }
    Ok(match refused.is_empty() {
        false => Ending::Verdict,
        true if well && run.estimates().iter().all(|e| e.stop().is_none()) => Ending::Well,
        true => Ending::Stopped,
    })
}

/// The table and the free runs.
fn words(prepared: &Prepared, analysis: &Analysis, causes: &[Vec<Finding>]) -> Result<String, InputError> {
    let Prepared { scenario, run, is_measured, held_out, .. } = prepared;
    let times = step_times(scenario, run).map_err(|error| prepared.bad_run(error))?;
    let mut text = table(run, analysis, causes, &times);
    if *is_measured {
        text.push_str(&free_runs(run, run.record(), OWN));
    }
    for (path, record) in held_out {
        text.push_str(&free_runs(run, record, &path.display().to_string()));
    }
    Ok(text)
}

/// The same as JSON, but for times, which differ from run to run.
fn results(prepared: &Prepared, analysis: &Analysis, causes: &[Vec<Finding>]) -> Result<String, InputError> {
    let Prepared { file, run, is_measured, held_out, .. } = prepared;
    let others: Vec<String> = held_out.iter().map(|(path, _)| path.display().to_string()).collect();
    let own = is_measured.then(|| (OWN, run.record()));
    let others = others.iter().map(String::as_str).zip(held_out.iter().map(|(_, record)| record));
    let records: Vec<(&str, &Record)> = own.into_iter().chain(others).collect();
    let text = json(run, analysis, causes, &records);
    let text = text.map_err(|error| InputError::Laboratory { file: file.clone(), reason: error.to_string() })?;
    Ok(text + "\n")
}

/// The filters, by name, that have one of some verdicts.
fn refused<'a>(run: &'a Run, analysis: &Analysis, verdicts: &[VerdictKind]) -> Vec<(&'a str, VerdictKind)> {
    let of = |place: usize| Some(analysis.diagnosis(place)?.verdict.as_ref()?.kind);
    let named = run.estimates().iter().enumerate();
    let named = named.filter_map(|(place, estimates)| Some((estimates.name(), of(place)?)));
    named.filter(|(_, kind)| verdicts.contains(kind)).collect()
}

/// Writes the record of a run, so that `--record` reads it, whatever mapping the scenario has.
fn write_record(run: &Run, is_measured: bool, file: &mut dyn Write) -> Result<(), OutputError> {
    if is_measured {
        file.write_all(READY.as_bytes())?;
    }
    Ok(run.record().write_csv(file)?)
}
