//! The run that a command's arguments ask for.

use std::path::{Path, PathBuf};

use kalmanscope_cli::run_scenario;
use kalmanscope_core::import::{self, Imported};
use kalmanscope_core::{Document, Record, Run, RunError, Scenario};

use crate::args::SourceArgs;
use crate::input::{InputError, read_short, to_text};
use crate::places::{Places, check, places, say};
use crate::record::{measured, named, read};

/// Limits the samples of a run, because all are kept: at 100 Hz more than five hours, about a gigabyte of estimates per
/// filter.
const MOST: usize = 2_000_000;

/// A finished run with its origin.
pub(crate) struct Prepared {
    /// The file of the scenario.
    pub(crate) file: PathBuf,
    pub(crate) scenario: Scenario,
    pub(crate) run: Run,
    /// Whether the record was measured, not simulated.
    pub(crate) is_measured: bool,
    /// The records for free runs, each with its file.
    pub(crate) held_out: Vec<(PathBuf, Record)>,
}

impl Prepared {
    /// Reads scenario and records and runs the filters. Remarks on a record are printed on standard error. Refuses outputs that are
    /// inputs. A quiet run prints no remarks.
    pub(crate) fn new(source: &SourceArgs, outputs: &Places<'_>, quiet: bool) -> Result<Self, InputError> {
        let SourceArgs { scenario: file, record: _, map: _, holdout, no_input: _, then, seed } = source;
        check(&source.inputs(), &Places::new())?;
        let mut scenario = read_scenario(file)?;
        check_with_record(&scenario, source, outputs)?;
        if let Some(seed) = seed {
            scenario.seed = *seed;
        }
        let imported = measured(source, &mut scenario)?;
        if imported.is_none() && scenario.samples() > MOST {
            return Err(InputError::TooLong { file: file.clone(), most: MOST });
        }
        let is_measured = imported.is_some() || !then.is_empty();
        let (record, remarks) =
            imported.map_or((None, Vec::new()), |Imported { record, remarks, .. }| (Some(record), remarks));
        remarks.iter().filter(|_| !quiet).for_each(|remark| say(remark));
        let held_out = holdout.iter().map(|path| Ok((path.clone(), read(path, &mut scenario.clone())?.record)));
        let held_out = held_out.collect::<Result<Vec<_>, InputError>>()?;
        let bad_run = |error| InputError::Run { file: file.clone(), error };
        let mut run = run_scenario(&scenario, record).map_err(bad_run)?;
        for path in then {
            continue_from(&run, &mut scenario);
            let next = read(path, &mut scenario)?.record;
            run = run_scenario(&scenario, Some(next)).map_err(bad_run)?;
        }
        Ok(Self { file: file.clone(), scenario, run, is_measured, held_out })
    }

    /// The reason why the scenario cannot be run.
    pub(crate) fn bad_run(&self, error: RunError) -> InputError {
        InputError::Run { file: self.file.clone(), error }
    }
}

/// A scenario, and the measured record that it or the arguments name.
pub(crate) fn scenario_and_record(
    file: &Path,
    record: Option<&PathBuf>,
    map: Option<&PathBuf>,
    outputs: &Places<'_>,
) -> Result<(Scenario, Option<Imported>), InputError> {
    let source = SourceArgs {
        scenario: file.to_owned(),
        record: record.cloned(),
        map: map.cloned(),
        holdout: Vec::new(),
        then: Vec::new(),
        no_input: false,
        seed: None,
    };
    check(&source.inputs(), &Places::new())?;
    let mut scenario = read_scenario(file)?;
    check_with_record(&scenario, &source, outputs)?;
    let imported = measured(&source, &mut scenario)?;
    Ok((scenario, imported))
}

fn read_scenario(file: &Path) -> Result<Scenario, InputError> {
    let bytes = read_short(file)?;
    let is_toml = std::str::from_utf8(&bytes).is_ok_and(|text| Document::from_toml(text).is_ok());
    if !is_toml && import::read(bytes.as_slice(), None).is_ok() {
        let reason =
            "this is a record, not a scenario: `kalmanscope-cli import RECORD --out SCENARIO.toml` writes one for it";
        return Err(InputError::Laboratory { file: file.to_owned(), reason: reason.to_owned() });
    }
    let text = to_text(file, bytes)?;
    Scenario::from_toml(&text).map_err(|error| InputError::Scenario { file: file.to_owned(), error })
}

/// Refuses outputs that are inputs, the record among them that the scenario names.
fn check_with_record(scenario: &Scenario, source: &SourceArgs, outputs: &Places<'_>) -> Result<(), InputError> {
    let file = scenario.record.as_ref().filter(|mapping| !mapping.file.is_empty());
    let file = file.map(|mapping| named(&source.scenario, mapping));
    let mut inputs = source.inputs();
    inputs.extend(places("the record of the scenario", &file));
    check(&inputs, outputs)
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
