//! The command `kalmanscope-cli report`.

use kalmanscope_cli::{causes, report};
use kalmanscope_core::{Analysis, Record, Wanted};

use crate::args::ReportArgs;
use crate::input::InputError;
use crate::places::{places, write_text};
use crate::prepared::Prepared;

/// Runs the scenario and writes its report.
pub(crate) fn write_report(args: &ReportArgs) -> Result<(), InputError> {
    let ReportArgs { source, out } = args;
    let Prepared { file, run, is_measured, held_out, .. } = Prepared::new(source, &places("--out", [out]), false)?;
    let analysis = Analysis::new(&run, Wanted { bounds: true, ..Wanted::default() });
    let own = is_measured.then(|| ("its own record".to_owned(), run.record()));
    let others = held_out.iter().map(|(path, record)| (path.display().to_string(), record));
    let records: Vec<(String, &Record)> = own.into_iter().chain(others).collect();
    let records: Vec<(&str, &Record)> = records.iter().map(|(name, record)| (name.as_str(), *record)).collect();
    let title = file.file_stem().map_or_else(|| "Kalmanscope".to_owned(), |stem| stem.to_string_lossy().into_owned());
    let page = report(&title, &run, &analysis, &causes(&run, &analysis), &records);
    let page = page.map_err(|error| InputError::Output { file: out.clone(), reason: error.to_string() })?;
    write_text(out, &page)
}
