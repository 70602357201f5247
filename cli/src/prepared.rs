//! The run that a command's arguments ask for: its scenario, and its measured record if there is one.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use kalmanscope_core::document;
use kalmanscope_core::import::{
    self, ColumnGuess, Decimal, Delimiter, Dialect, Encoding, Imported, MappedColumn, Mapping, Table, build, hash,
};
use kalmanscope_core::{Quantity, Record, Run, RunError, Scenario, Source};
use kalmanscope_lessons::records;

use crate::args::{InputArgs, SourceArgs};
use crate::files::{InputError, NO_FILE, Places, check, places, read_record, read_short, say, to_text};
use crate::progress::ProgressDisplay;

/// More than five hours at 100 Hz, and less than a gigabyte for a filter without outputs of its history.
const MOST: usize = 2_000_000;

const CHUNK: usize = 10_000;

pub(crate) struct Prepared {
    pub(crate) file: PathBuf,
    pub(crate) scenario: Scenario,
    source: Source,
    pub(crate) is_measured: bool,
    pub(crate) held_out: Vec<(String, Record)>,
}

impl Prepared {
    /// Refuses outputs that are inputs. Remarks on a record are printed on standard error, unless the run is quiet.
    pub(crate) fn new(source: &SourceArgs, outputs: &Places<'_>, quiet: bool) -> Result<Self, InputError> {
        let SourceArgs { input, holdout, no_input, seed } = source;
        let file = &input.scenario;
        check(&source.inputs(), &Places::new())?;
        let mut scenario = read_scenario(file, quiet)?;
        check_with_record(&scenario, file, source.inputs(), outputs)?;
        if let Some(seed) = seed {
            scenario.seed = *seed;
        }
        let imported = measured(input, *no_input, &mut scenario)?;
        if imported.is_none() && scenario.samples() > MOST {
            let reason = format!("the simulation has more than {MOST} samples; shorten `duration` or enlarge `dt`");
            return Err(InputError::bad(file, &reason));
        }
        let is_measured = imported.is_some();
        let (record, remarks) =
            imported.map_or((None, Vec::new()), |Imported { record, remarks, .. }| (Some(record), remarks));
        remarks.iter().filter(|_| !quiet).for_each(|remark| say(remark));
        let held_out =
            // Reading writes a mapping into its scenario: a copy, as the run's is that of its own record.
            holdout.iter().map(|path| Ok((path.display().to_string(), read(path, &mut scenario.clone())?.record)));
        let held_out = held_out.collect::<Result<Vec<_>, InputError>>()?;
        let source = record.map_or(Source::Simulated, |record| Source::Measured(Arc::new(record)));
        Ok(Self { file: file.clone(), scenario, source, is_measured, held_out })
    }

    pub(crate) fn run(&self, quiet: bool) -> Result<Run, InputError> {
        let mut run = Run::from_source(&self.scenario, self.source.clone()).map_err(|error| self.bad_run(&error))?;
        let progress = ProgressDisplay::new(run.samples(), quiet);
        while run.advance_to(run.done() + CHUNK) > 0 {
            progress.show(run.done(), "filters");
        }
        Ok(run)
    }

    pub(crate) fn truth(&self) -> Result<Run, InputError> {
        let scenario = Scenario { filters: Vec::new(), ..self.scenario.clone() };
        // A run without filters would accept filters that are refused later, after the whole simulation.
        let run = self.scenario.validate().map_err(RunError::from);
        let run = run.and_then(|()| Run::from_source(&scenario, self.source.clone()));
        let mut run = run.map_err(|error| self.bad_run(&error))?;
        run.finish();
        Ok(run)
    }

    /// The records for free runs, each with its name: that of a run, if it was measured, and those of the arguments.
    pub(crate) fn for_free_runs<'a>(&'a self, run: &'a Run) -> Vec<(&'a str, &'a Record)> {
        let own = self.is_measured.then(|| ("its own record", run.record()));
        own.into_iter().chain(self.held_out.iter().map(|(name, record)| (name.as_str(), record))).collect()
    }

    pub(crate) fn bad_run(&self, error: &RunError) -> InputError {
        InputError::bad(&self.file, error)
    }
}

pub(crate) fn scenario_and_record(
    input: &InputArgs,
    outputs: &Places<'_>,
) -> Result<(Scenario, Option<Imported>), InputError> {
    check(&input.inputs(), &Places::new())?;
    let mut scenario = read_scenario(&input.scenario, false)?;
    check_with_record(&scenario, &input.scenario, input.inputs(), outputs)?;
    let imported = measured(input, false, &mut scenario)?;
    Ok((scenario, imported))
}

pub(crate) fn read_scenario(file: &Path, quiet: bool) -> Result<Scenario, InputError> {
    let bytes = read_short(file)?;
    let is_toml = std::str::from_utf8(&bytes).is_ok_and(|text| document::from_toml(text).is_ok());
    // A record in the wrong place would otherwise be reported as a syntax error in its first line.
    if !is_toml && import::read(bytes.as_slice(), None).is_ok() {
        let reason =
            "this is a record, not a scenario: `kalmanscope-cli import RECORD --out SCENARIO.toml` writes one for it";
        return Err(InputError::bad(file, &reason));
    }
    let text = to_text(file, bytes)?;
    let read = Scenario::from_toml_with_remarks(&text);
    let (scenario, remarks) = read.map_err(|error| InputError::bad(file, &error))?;
    remarks.iter().filter(|_| !quiet).for_each(|remark| say(remark));
    Ok(scenario)
}

/// Refuses outputs that are inputs, the record among them that the scenario names.
fn check_with_record(
    scenario: &Scenario,
    file: &Path,
    inputs: Places<'_>,
    outputs: &Places<'_>,
) -> Result<(), InputError> {
    let named_in_it = scenario.record.as_ref().filter(|mapping| !mapping.file.is_empty());
    let file = named_in_it.map(|mapping| named(file, mapping));
    check(&[inputs, places("the record of the scenario", &file)].concat(), outputs)
}

const OVERRIDDEN: &str = "the scenario's dt, duration, force and true values have no effect on a measured record";

/// The first line of a measured record that was written as the filters read it: it needs no mapping any more.
pub(crate) const READY: &str = "# a measured record as the filters read it: SI units, no mapping\n";

/// The measured record of a run, if it has one, with sentences about its making. The scenario gets the mapping.
fn measured(input: &InputArgs, no_input: bool, scenario: &mut Scenario) -> Result<Option<Imported>, InputError> {
    let InputArgs { scenario: file, record } = input;
    if no_input && (record.is_some() || scenario.record.is_some()) {
        let mapping = scenario.record.get_or_insert_default();
        (mapping.no_input, mapping.input) = (true, None);
    }
    let path = match (record, &scenario.record) {
        (Some(path), _) => path.clone(),
        (None, Some(mapping)) if !mapping.file.is_empty() => named(file, mapping),
        (None, Some(_)) => {
            say(&"[record] of the scenario names no file, so a record is simulated; --record takes a measured one");
            return Ok(None);
        }
        (None, None) => return Ok(None),
    };
    // A file beside the scenario comes before a built-in record.
    if record.is_none()
        && !path.exists()
        && let Some(mapping) = &scenario.record
        && let Some(bytes) = records::record(mapping)
    {
        let table = columns(&path, bytes, mapping.dialect)?;
        return of_table(&path, &table, scenario).map(Some);
    }
    // A scenario may come from an untrusted source: it must not open a device or a pipe.
    if record.is_none() && path.exists() && !path.is_file() {
        return Err(InputError::bad(&path, &NO_FILE));
    }
    if record.is_none()
        && let Some(mapping) = scenario.record.as_ref().filter(|mapping| !mapping.hash.is_empty())
        && hash(&read_record(&path)?) != mapping.hash
    {
        say(&format!("{} has changed since it was imported", path.display()));
    }
    read(&path, scenario).map(Some)
}

/// The scenario says what the columns mean, except where the program has written the record.
fn read(path: &Path, scenario: &mut Scenario) -> Result<Imported, InputError> {
    let bytes = read_record(path)?;
    let mapping = scenario.record.clone().unwrap_or_default();
    let is_ready = bytes.starts_with(READY.as_bytes());
    let table = columns(path, bytes, mapping.dialect.filter(|_| !is_ready))?;
    if !is_ready {
        return of_table(path, &table, scenario);
    }
    scenario.record = mapping.no_input.then(|| Mapping { no_input: true, ..Mapping::default() });
    let imported = of_table(path, &table, scenario);
    // Lengths and angles keep their names.
    scenario.record = Some(mapping).filter(|mapping| !mapping.sensors.is_empty());
    imported
}

fn of_table(path: &Path, table: &Table, scenario: &mut Scenario) -> Result<Imported, InputError> {
    let mapping = scenario.record.clone().unwrap_or_default();
    let mut left_out = None;
    let mapping = if mapping.sensors.is_empty() {
        let sensors: Vec<Quantity> = scenario.sensors.iter().map(|sensor| sensor.measures).collect();
        let (mut guess, kind, reasons) = Mapping::guess_for(table, &sensors);
        let named = |input: &MappedColumn| reasons.iter().any(|one| one.column == input.column && !one.is_a_guess());
        if guess.input.as_ref().is_some_and(named) {
            scenario.input = kind;
        }
        // The scenario names the measured quantities: a column that looks like another sensor is left out.
        if sensors.iter().any(|quantity| guess.sensors.contains_key(quantity)) {
            guess.sensors.retain(|quantity, _| sensors.contains(quantity));
        }
        if mapping.no_input {
            guess.take_no_input(&reasons);
        }
        let time = if mapping.time == Default::default() { guess.time } else { mapping.time };
        let mapping = Mapping { time, input: guess.input, forces: guess.forces, sensors: guess.sensors, ..mapping };
        left_out = columns_without_meaning(&mapping, &reasons);
        mapping
    } else {
        mapping
    };
    let remarks: Vec<String> = if is_own_form(table, &mapping) {
        left_out.into_iter().collect()
    } else {
        let said = [Some(table.form.clone()), Some(mapping.in_words()), left_out, Some(OVERRIDDEN.to_owned())];
        said.into_iter().flatten().collect()
    };
    let imported = build(table, &mapping, scenario.input, scenario.hold, scenario.plant.kind.channels());
    let mut imported = imported.map_err(|error| InputError::bad(path, &error))?;
    scenario.record = Some(mapping);
    imported.remarks.splice(0..0, remarks);
    if let Some(missing) = scenario.sensors.iter().find(|s| !imported.record.sensors().contains(&s.measures)) {
        return Err(InputError::bad(path, &RunError::MissingSensor(missing.measures)));
    }
    Ok(imported)
}

pub(crate) fn table(path: &Path) -> Result<(Table, String), InputError> {
    let bytes = read_record(path)?;
    let hash = hash(&bytes);
    Ok((columns(path, bytes, None)?, hash))
}

fn columns(path: &Path, bytes: Vec<u8>, dialect: Option<Dialect>) -> Result<Table, InputError> {
    import::read(bytes, dialect).map_err(|error| InputError::bad(path, &error))
}

fn columns_without_meaning(mapping: &Mapping, columns: &[ColumnGuess]) -> Option<String> {
    let sensors = mapping.sensors.values().chain(&mapping.input).map(|mapped| &mapped.column);
    let used: Vec<&String> = sensors.chain(&mapping.time.column).collect();
    let is_left_out = |name: &&String| !used.contains(name) && !name.starts_with("true_");
    let names = columns.iter().filter(|guess| !guess.is_own_clock()).map(|guess| &guess.column).filter(is_left_out);
    let names: Vec<String> = names.map(|name| format!("`{name}`")).collect();
    (!names.is_empty()).then(|| format!("left out: {}", names.join(", ")))
}

/// Whether the command line wrote a file: then remarks on its form are not needed.
fn is_own_form(table: &Table, mapping: &Mapping) -> bool {
    let Dialect { encoding, delimiter, decimal, names, .. } = table.dialect;
    let is_plain = (encoding, delimiter, decimal, names) == (Encoding::Utf8, Delimiter::Comma, Decimal::Point, 1);
    let input = mapping.input.as_ref().map(|input| input.column.as_str());
    let sensors = mapping.sensors.iter().all(|(quantity, column)| quantity.key() == column.column);
    is_plain
        && mapping.time.column.as_deref() == Some("t")
        && input.is_none_or(|input| ["force", "ground_acceleration"].contains(&input))
        && sensors
}

/// The file that a scenario names. Its path is relative to the scenario's folder.
pub(crate) fn named(scenario: &Path, mapping: &Mapping) -> PathBuf {
    scenario.parent().unwrap_or(Path::new("")).join(&mapping.file)
}
