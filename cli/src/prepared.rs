//! The run that a command's arguments ask for.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use kalmanscope_core::import::{self, Imported};
use kalmanscope_core::{Document, Record, Run, RunError, Scenario, Source};

use crate::args::{RecordArgs, SourceArgs};
use crate::input::{InputError, read_short, to_text};
use crate::places::{Places, check, places, say};
use crate::progress::Progress;
use crate::record::{measured, named, read};

/// Limits the samples of a run: at 100 Hz more than five hours, and less than a gigabyte for a filter without outputs of its
/// history.
const MOST: usize = 2_000_000;

/// The samples between two updates of the progress.
const CHUNK: usize = 10_000;

/// A run that is about to begin, with its origin.
pub(crate) struct Prepared {
    /// The file of the scenario.
    pub(crate) file: PathBuf,
    pub(crate) scenario: Scenario,
    source: Source,
    /// Whether the record was measured, not simulated.
    pub(crate) is_measured: bool,
    /// The records for free runs, each with its file.
    pub(crate) held_out: Vec<(String, Record)>,
}

impl Prepared {
    /// Reads scenario and records. Remarks on a record are printed on standard error. Refuses outputs that are inputs. A quiet run
    /// prints no remarks.
    pub(crate) fn new(source: &SourceArgs, outputs: &Places<'_>, quiet: bool) -> Result<Self, InputError> {
        let SourceArgs { scenario: file, record: _, map: _, holdout, no_input: _, seed } = source;
        check(&source.inputs(), &Places::new())?;
        let mut scenario = read_scenario(file, quiet)?;
        check_with_record(&scenario, source, outputs)?;
        if let Some(seed) = seed {
            scenario.seed = *seed;
        }
        let imported = measured(source, &mut scenario)?;
        if imported.is_none() && scenario.samples() > MOST {
            return Err(InputError::TooLong { file: file.clone(), most: MOST });
        }
        let is_measured = imported.is_some();
        let (record, remarks) =
            imported.map_or((None, Vec::new()), |Imported { record, remarks, .. }| (Some(record), remarks));
        remarks.iter().filter(|_| !quiet).for_each(|remark| say(remark));
        let held_out =
            holdout.iter().map(|path| Ok((path.display().to_string(), read(path, &mut scenario.clone())?.record)));
        let held_out = held_out.collect::<Result<Vec<_>, InputError>>()?;
        let source = record.map_or(Source::Simulated, |record| Source::Measured(Arc::new(record)));
        Ok(Self { file: file.clone(), scenario, source, is_measured, held_out })
    }

    /// The finished run of all filters, with their histories.
    pub(crate) fn run(&self, quiet: bool) -> Result<Run, InputError> {
        let mut run = Run::from_source(&self.scenario, self.source.clone()).map_err(|error| self.bad_run(error))?;
        let mut progress = Progress::new(run.samples(), quiet);
        while run.advance_to(run.done() + CHUNK) > 0 {
            progress.tell(run.done(), "filters");
        }
        Ok(run)
    }

    /// The finished run without filters: the record alone.
    pub(crate) fn truth(&self) -> Result<Run, InputError> {
        let scenario = Scenario { filters: Vec::new(), ..self.scenario.clone() };
        let run = self.scenario.validate().map_err(RunError::from);
        let run = run.and_then(|()| Run::from_source(&scenario, self.source.clone()));
        let mut run = run.map_err(|error| self.bad_run(error))?;
        run.finish();
        Ok(run)
    }

    /// The records over which the final models run freely, each with its name: that of a run, if it was measured, and those of the
    /// arguments.
    pub(crate) fn for_free_runs<'a>(&'a self, run: &'a Run) -> Vec<(&'a str, &'a Record)> {
        let own = self.is_measured.then(|| ("its own record", run.record()));
        own.into_iter().chain(self.held_out.iter().map(|(name, record)| (name.as_str(), record))).collect()
    }

    /// The reason why the scenario cannot be run.
    pub(crate) fn bad_run(&self, error: RunError) -> InputError {
        InputError::Run { file: self.file.clone(), error }
    }
}

/// A scenario, and the measured record that it or the arguments name.
pub(crate) fn scenario_and_record(
    file: &Path,
    RecordArgs { record, map }: &RecordArgs,
    outputs: &Places<'_>,
) -> Result<(Scenario, Option<Imported>), InputError> {
    let source = SourceArgs {
        scenario: file.to_owned(),
        record: record.clone(),
        map: map.clone(),
        holdout: Vec::new(),
        no_input: false,
        seed: None,
    };
    check(&source.inputs(), &Places::new())?;
    let mut scenario = read_scenario(file, false)?;
    check_with_record(&scenario, &source, outputs)?;
    let imported = measured(&source, &mut scenario)?;
    Ok((scenario, imported))
}

pub(crate) fn read_scenario(file: &Path, quiet: bool) -> Result<Scenario, InputError> {
    let bytes = read_short(file)?;
    let is_toml = std::str::from_utf8(&bytes).is_ok_and(|text| Document::from_toml(text).is_ok());
    if !is_toml && import::read(bytes.as_slice(), None).is_ok() {
        let reason =
            "this is a record, not a scenario: `kalmanscope-cli import RECORD --out SCENARIO.toml` writes one for it";
        return Err(InputError::Laboratory { file: file.to_owned(), reason: reason.to_owned() });
    }
    let text = to_text(file, bytes)?;
    let read = Scenario::from_toml_with_remarks(&text);
    let (scenario, remarks) = read.map_err(|error| InputError::Scenario { file: file.to_owned(), error })?;
    remarks.iter().filter(|_| !quiet).for_each(|remark| say(remark));
    Ok(scenario)
}

/// Refuses outputs that are inputs, the record among them that the scenario names.
fn check_with_record(scenario: &Scenario, source: &SourceArgs, outputs: &Places<'_>) -> Result<(), InputError> {
    let file = scenario.record.as_ref().filter(|mapping| !mapping.file.is_empty());
    let file = file.map(|mapping| named(&source.scenario, mapping));
    let mut inputs = source.inputs();
    inputs.extend(places("the record of the scenario", &file));
    check(&inputs, outputs)
}
