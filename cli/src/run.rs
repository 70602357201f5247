//! The command `kalmanscope-cli run`.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use kalmanscope_cli::{ReportParts, Results, causes, pages, report, svg, write_estimates};
use kalmanscope_core::document::DocumentError;
use kalmanscope_core::setting::Edit;
use kalmanscope_core::{RecordError, Run, ScenarioError};
use kalmanscope_diagnosis::Remedy;
use kalmanscope_diagnosis::{Analysis, VerdictKind, Wanted};
use thiserror::Error;

use crate::args::{InputArgs, RunArgs, SourceArgs};
use crate::files::{InputError, Places, places, print_beside, report_error, say, write, write_text};
use crate::import::path_from;
use crate::prepared::{Prepared, READY, named};
use crate::progress::ProgressDisplay;

#[derive(Debug, Error)]
enum OutputError {
    #[error(transparent)]
    Io(#[from] io::Error),
    #[error(transparent)]
    Csv(#[from] csv::Error),
    #[error(transparent)]
    Record(#[from] RecordError),
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    #[error(transparent)]
    Document(#[from] DocumentError),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum OutputForm {
    Estimates,
    Plots,
    Report,
    Json,
    /// The scenario with a remedy.
    Scenario,
}

impl OutputForm {
    /// The form that the ending of a file names. A file without one, such as a pipe, gets estimates.
    fn of(path: &Path, fix: Option<u8>) -> Result<Self, String> {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        let form = match ending.as_deref() {
            None | Some("csv") => Self::Estimates,
            Some("svg") => Self::Plots,
            Some("html") => Self::Report,
            Some("json") => Self::Json,
            Some("toml") if fix.is_some() => Self::Scenario,
            Some("toml") => return Err("a scenario is written with --fix N only".to_owned()),
            Some(_) => return Err("the ending must be .csv, .svg, .html, .json or .toml".to_owned()),
        };
        Ok(form)
    }
}

/// Files that cannot be written are reported on standard error. Returns the exit code.
pub(crate) fn run(args: &RunArgs) -> Result<u8, InputError> {
    let RunArgs { source, fix, out, record_out, fail_on, json: as_json, quiet, verbose } = args;
    let bad = |reason: &dyn ToString| InputError::bad(&source.input.scenario, reason);
    let forms = out.iter().map(|path| match OutputForm::of(path, *fix) {
        Ok(form) => Ok((path, form)),
        Err(reason) => Err(bad(&format!("--out {}: {reason}", path.display()))),
    });
    let forms = forms.collect::<Result<Vec<_>, _>>()?;
    let fixed = fix.map(|number| {
        let path = forms.iter().find(|(_, form)| *form == OutputForm::Scenario).map(|(path, _)| *path);
        path.map(|path| (number, path)).ok_or_else(|| bad(&"--fix: --out must name the .toml file to write"))
    });
    let fixed = fixed.transpose()?;
    let outputs: Places<'_> = [places("--out", out), places("--record-out", record_out)].concat();
    let prepared = Prepared::new(source, &outputs, *quiet)?;
    // Only files need the whole history of every filter.
    let with_history = forms.iter().any(|(_, form)| *form != OutputForm::Scenario);
    let run = if with_history { prepared.run(*quiet)? } else { prepared.truth()? };
    let records = prepared.for_free_runs(&run);
    let progress = ProgressDisplay::wait(*quiet, "diagnostics, causes and bounds");
    let results = if with_history {
        let analysis = Analysis::new(&run, Wanted { bounds: true, ..Wanted::default() });
        Results::of_run(&run, &analysis, causes(&run, &analysis)).with_free_runs(&run, &records)
    } else {
        let results = Results::in_turn(&prepared.scenario, &run, &records);
        results.map_err(|error| prepared.bad_run(&error))?
    };
    drop(progress);
    let results = results.by(command(source));

    let mut well = true;
    let mut save = |path: &Path, writer: &dyn Fn(&mut dyn Write) -> Result<(), OutputError>| {
        if let Err(error) = write(path, writer) {
            well = false;
            report_error(&format_args!("{}: {error}", path.display()));
        }
    };
    for (path, form) in forms {
        match form {
            OutputForm::Estimates => save(path, &|file| Ok(write_estimates(&run, file)?)),
            OutputForm::Plots => save(path, &|file| Ok(file.write_all(svg(&run).as_bytes())?)),
            OutputForm::Report => save(path, &|file| Ok(file.write_all(page(&prepared, &run, &results)?.as_bytes())?)),
            OutputForm::Json => save(path, &|file| Ok(file.write_all(results.json(run.estimates())?.as_bytes())?)),
            OutputForm::Scenario => {}
        }
    }
    record_out.iter().for_each(|path| save(path, &|file| write_record(&run, prepared.is_measured, file)));
    if let Some((number, path)) = fixed {
        write_fixed(&prepared, results.causes(), usize::from(number), path)?;
    }
    if !quiet {
        let json = || results.json(&[]).map(|json| json + "\n").map_err(|error| bad(&error));
        let text = if *as_json { json()? } else { results.table(*verbose) };
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
        false => 3,
        true if well && !results.any_stopped() => 0,
        true => 1,
    })
}

/// The command of a run, without its outputs.
fn command(source: &SourceArgs) -> String {
    let SourceArgs { input: InputArgs { scenario, record }, holdout: _, no_input, seed } = source;
    let path = |path: &PathBuf| {
        let path = path.display().to_string();
        if path.contains(char::is_whitespace) { format!("'{path}'") } else { path }
    };
    let mut words = vec!["kalmanscope-cli run".to_owned(), path(scenario)];
    words.extend(record.iter().map(|record| format!("--record {}", path(record))));
    words.extend(no_input.then(|| "--no-input".to_owned()));
    words.extend(seed.map(|seed| format!("--seed {seed}")));
    words.join(" ")
}

fn write_record(run: &Run, is_measured: bool, file: &mut dyn Write) -> Result<(), OutputError> {
    if is_measured {
        file.write_all(READY.as_bytes())?;
    }
    Ok(run.record().write_csv(file)?)
}

fn page(prepared: &Prepared, run: &Run, results: &Results<'_>) -> Result<String, ScenarioError> {
    let title = prepared.file.file_stem().map_or_else(|| "Kalmanscope".into(), |stem| stem.to_string_lossy());
    report(results, &ReportParts { title: &title, reasons: &[], figures: &pages(run) })
}

/// Writes the scenario with remedy `number` of each filter with a bad verdict, and names these filters.
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
        let after = remedy.after.as_ref().map_or("no better", |verdict| verdict.kind.name());
        let names: Vec<&str> = remedy.causes().map(|likely| likely.cause.name).collect();
        said.push(format!("{name}: wrote the remedy for {}; then {after}", names.join(" and ")));
    }
    if said.is_empty() {
        let reason = "there is nothing to fix: no cause was found for any filter";
        return Err(bad(&reason));
    }
    if let Some(mapping) = fixed.record.as_mut().filter(|mapping| !mapping.file.is_empty()) {
        // The new file may be in another folder, from which the record's path is another one.
        mapping.file = path_from(Some(out), &named(&prepared.file, mapping));
    }
    write_text(out, &fixed.to_toml().map_err(|error| bad(&error))?)?;
    said.iter().for_each(|line| say(line));
    Ok(())
}
