//! The run that a command's arguments ask for.

use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use kalmanscope_cli::run_scenario;
use kalmanscope_core::import::Imported;
use kalmanscope_core::{Record, Run, RunError, Scenario};

use crate::args::SourceArgs;
use crate::input::{InputError, read_text};
use crate::record::{measured, read};

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
    /// Reads scenario and records and runs the filters. Remarks on a record are printed on standard error.
    pub(crate) fn new(source: &SourceArgs) -> Result<Self, InputError> {
        let SourceArgs { scenario: file, record: _, map: _, holdout, then, seed } = source;
        let mut scenario = read_scenario(file)?;
        if let Some(seed) = seed {
            scenario.seed = *seed;
        }
        let imported = measured(source, &mut scenario)?;
        if imported.is_none() && scenario.samples() > MOST {
            return Err(InputError::TooLong { file: file.clone(), most: MOST });
        }
        let is_measured = imported.is_some() || !then.is_empty();
        let (record, remarks) =
            imported.map_or((None, Vec::new()), |Imported { record, remarks }| (Some(record), remarks));
        remarks.iter().for_each(|remark| {
            let _ = writeln!(io::stderr(), "{remark}");
        });
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
) -> Result<(Scenario, Option<Imported>), InputError> {
    let mut scenario = read_scenario(file)?;
    let source = SourceArgs {
        scenario: file.to_owned(),
        record: record.cloned(),
        map: map.cloned(),
        holdout: Vec::new(),
        then: Vec::new(),
        seed: None,
    };
    let imported = measured(&source, &mut scenario)?;
    Ok((scenario, imported))
}

fn read_scenario(file: &Path) -> Result<Scenario, InputError> {
    Scenario::from_toml(&read_text(file)?).map_err(|error| InputError::Scenario { file: file.to_owned(), error })
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
