//! The command `kalmanscope-cli report`.

use kalmanscope_cli::{Parts, day, pages, report};

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
    let failed = |error: &dyn std::fmt::Display| InputError::Output { file: out.clone(), reason: error.to_string() };
    let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap_or_default();
    let parts = Parts {
        title: &title,
        day: &day(now.as_secs_f64()),
        causes: &causes,
        figures: &pages(&run),
        free_runs: &records,
        ..Parts::default()
    };
    let page = report(&run, &analysis, &parts).map_err(|error| failed(&error))?;
    write_text(out, &page)
}
