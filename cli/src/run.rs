//! The commands `kalmanscope-cli run` and `kalmanscope-cli report`.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use kalmanscope_cli::{FilterProgress, Parts, Results, causes, day, pages, report, svg, write_estimates};
use kalmanscope_core::diagnosis::Remedy;
use kalmanscope_core::document::DocumentError;
use kalmanscope_core::setting::Edit;
use kalmanscope_core::{Analysis, RecordError, Run, VerdictKind, Wanted};
use thiserror::Error;

use crate::args::{ReportArgs, RunArgs};
use crate::files::{InputError, Places, places, print_beside, report_error, say, write, write_text};
use crate::import::path_from;
use crate::prepared::{Prepared, READY, named};
use crate::progress::Progress;

/// The reason why a result could not be written.
#[derive(Debug, Error)]
enum OutputError {
    #[error(transparent)]
    Io(#[from] io::Error),
    #[error(transparent)]
    Csv(#[from] csv::Error),
    #[error(transparent)]
    Record(#[from] RecordError),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ending {
    Well,
    /// Something could not be written, or a filter stopped.
    Stopped,
    /// A filter has a verdict that was not to be.
    Verdict,
}

/// Runs the scenario, writes the wanted files and prints the table. Reports files that cannot be written on standard
/// error.
pub(crate) fn run(args: &RunArgs) -> Result<Ending, InputError> {
    let RunArgs { source, fix, out, record_out, svg: picture, fail_on, json: as_json, quiet, verbose } = args;
    let outputs: Places<'_> = [("--out", out), ("--record-out", record_out), ("--svg", picture)]
        .map(|(word, file)| places(word, file))
        .concat();
    let prepared = Prepared::new(source, &outputs, *quiet)?;
    // Only files need the whole history of every filter.
    let with_history = (out.is_some() && fix.is_none()) || picture.is_some();
    let run = if with_history { prepared.run(*quiet)? } else { prepared.truth()? };

    let mut well = true;
    let mut save = |path: &Option<PathBuf>, writer: &dyn Fn(&mut dyn Write) -> Result<(), OutputError>| {
        if let Some(path) = path
            && let Err(error) = write(path, writer)
        {
            well = false;
            report_error(&format_args!("{}: {error}", path.display()));
        }
    };
    save(&out.clone().filter(|_| fix.is_none()), &|file| Ok(write_estimates(&run, file)?));
    save(record_out, &|file| write_record(&run, prepared.is_measured, file));
    save(picture, &|file| Ok(file.write_all(svg(&run).as_bytes())?));

    let results = if with_history {
        let (analysis, causes) = judged(&run, *quiet);
        Results::of_run(&run, &analysis, causes).with_free_runs(&run, &prepared.for_free_runs(&run))
    } else {
        in_turn(&prepared, &run, *quiet)?
    };
    if let (Some(number), Some(out)) = (fix, out) {
        write_fixed(&prepared, results.causes(), usize::from(*number), out)?;
    }
    let results = if *as_json || *quiet {
        results
    } else {
        results.timed(&prepared.scenario).map_err(|error| prepared.bad_run(error))?
    };
    if !quiet {
        let text = if *as_json { json(&prepared, &results)? } else { results.table(*verbose) + &results.free_runs() };
        if let Err(error) = print_beside(&outputs, &text) {
            well = false;
            report_error(&error);
        }
    }
    let is_refused = |kind: VerdictKind| fail_on.contains(&kind);
    let refused = results.verdicts().filter_map(|(name, kind)| Some((name, kind.filter(|&kind| is_refused(kind))?)));
    let refused: Vec<_> = refused.collect();
    for (name, kind) in &refused {
        say(&format_args!("--fail-on: the verdict on {name} is {}", kind.name()));
    }
    Ok(match refused.is_empty() {
        false => Ending::Verdict,
        true if well && !results.any_stopped() => Ending::Well,
        true => Ending::Stopped,
    })
}

fn judged(run: &Run, quiet: bool) -> (Analysis, Vec<Vec<Remedy>>) {
    let progress = Progress::wait(quiet, "diagnostics and Cramér-Rao bounds");
    let analysis = Analysis::new(run, Wanted { bounds: true, ..Wanted::default() });
    drop(progress);
    let mut progress = Progress::of_results(run.estimates().len(), quiet);
    let causes = causes(run, &analysis, &mut |told| progress.tell_results(told));
    (analysis, causes)
}

/// The results without a history, over the record of a run without filters.
fn in_turn<'a>(prepared: &Prepared, run: &'a Run, quiet: bool) -> Result<Results<'a>, InputError> {
    let Prepared { scenario, .. } = prepared;
    let mut progress = Progress::of_results(scenario.filters.len(), quiet);
    let mut tell = |told: FilterProgress<'_>| progress.tell_results(told);
    let results = Results::in_turn(scenario, run, &prepared.for_free_runs(run), &mut tell);
    results.map_err(|error| prepared.bad_run(error))
}

/// The results as JSON, without times, which differ from run to run.
fn json(prepared: &Prepared, results: &Results<'_>) -> Result<String, InputError> {
    let Prepared { file, .. } = prepared;
    let bad = |error: DocumentError| InputError::bad(file, &error);
    Ok(results.json().map_err(bad)? + "\n")
}

fn write_record(run: &Run, is_measured: bool, file: &mut dyn Write) -> Result<(), OutputError> {
    if is_measured {
        file.write_all(READY.as_bytes())?;
    }
    Ok(run.record().write_csv(file)?)
}

pub(crate) fn write_report(args: &ReportArgs) -> Result<(), InputError> {
    let ReportArgs { source, out } = args;
    let prepared = Prepared::new(source, &places("--out", [out]), false)?;
    let run = prepared.run(false)?;
    let (analysis, causes) = judged(&run, false);
    let records = prepared.for_free_runs(&run);
    let file = &prepared.file;
    let title = file.file_stem().map_or_else(|| "Kalmanscope".to_owned(), |stem| stem.to_string_lossy().into_owned());
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    let parts = Parts {
        title: &title,
        day: &day(now.as_secs_f64()),
        causes: &causes,
        figures: &pages(&run),
        free_runs: &records,
        ..Parts::default()
    };
    let page = report(&run, &analysis, &parts).map_err(|error| InputError::unwritten(out, &error))?;
    write_text(out, &page)
}

/// Writes the scenario of a run with remedy `number` of each filter with a bad verdict, and names these filters.
/// `causes` are those of the run.
fn write_fixed<'a>(
    prepared: &Prepared,
    causes: impl Iterator<Item = &'a [Remedy]>,
    number: usize,
    out: &Path,
) -> Result<(), InputError> {
    let bad = |reason: &dyn ToString| InputError::bad(&prepared.file, reason);
    let mut fixed = prepared.scenario.clone();
    let mut said = Vec::new();
    for (place, causes) in causes.enumerate().filter(|(_, causes)| !causes.is_empty()) {
        let name = &prepared.scenario.filters[place].name;
        let Some(remedy) = causes.get(number - 1) else {
            let count = causes.len();
            return Err(bad(&format!("--fix {number}: {name} has remedies 1 to {count}")));
        };
        if remedy.edits.is_empty() {
            let hint = remedy.first.cause.hint;
            return Err(bad(&format!("--fix {number}: no setting of {name} takes this cause away. {hint}")));
        }
        let refused = |error| bad(&format!("--fix {number}: {name}: {error}"));
        fixed = Edit::apply_all(&remedy.edits, &fixed).map_err(refused)?;
        let ends = remedy.after.as_ref().map_or("no better", |verdict| verdict.kind.name());
        let names: Vec<&str> = remedy.causes().map(|likely| likely.cause.name).collect();
        said.push(format!("{name}: the remedy against {} is written, then {ends}", names.join(" and then ")));
    }
    if said.is_empty() {
        let reason = "there is nothing to fix: no filter has a verdict with a cause that was found";
        return Err(bad(&reason));
    }
    if let Some(mapping) = fixed.record.as_mut().filter(|mapping| !mapping.file.is_empty()) {
        mapping.file = path_from(Some(out), &named(&prepared.file, mapping));
    }
    write_text(out, &fixed.to_toml().map_err(|error| bad(&error))?)?;
    said.iter().for_each(|line| say(line));
    Ok(())
}
