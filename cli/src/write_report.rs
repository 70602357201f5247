//! The command `kalmanscope-cli report`.

use kalmanscope_cli::report;

use crate::args::ReportArgs;
use crate::input::InputError;
use crate::places::{places, write_text};
use crate::prepared::Prepared;
use crate::run::judged;

/// Runs the scenario and writes its report.
pub(crate) fn write_report(args: &ReportArgs) -> Result<(), InputError> {
    let ReportArgs { source, out } = args;
    let prepared = Prepared::new(source, &places("--out", [out]), false)?;
    let run = prepared.run(false)?;
    let (analysis, causes) = judged(&run, false);
    let records = prepared.for_free_runs(&run);
    let file = &prepared.file;
    let title = file.file_stem().map_or_else(|| "Kalmanscope".to_owned(), |stem| stem.to_string_lossy().into_owned());
    let page = report(&title, &run, &analysis, &causes, &records);
    let page = page.map_err(|error| InputError::Output { file: out.clone(), reason: error.to_string() })?;
    write_text(out, &page)
}
