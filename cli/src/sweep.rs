//! The command `kalmanscope-cli sweep`: always in double precision, by the processor, so that a table has the same bytes
//! everywhere. Only the explorer's maps use a graphics processor.

mod part;

use std::collections::BTreeMap;
use std::io;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use kalmanscope_core::import::{Hash, hash};
use kalmanscope_core::{Axis, Measure, Record, Scenario, Source, Spacing};
use kalmanscope_lab::{Ensemble, Plan, Priority, Runner, Slice, Threads, channels};

use crate::args::{Shard, SweepArgs};
use crate::input::InputError;
use crate::places::{is_standard_output, places, write};
use crate::prepared::scenario_and_record;

use part::Part;

/// Limits the threads.
pub(crate) const MOST_THREADS: usize = 256;

/// Runs all cells of a shard and writes their table: as a file, which continues that of an interrupted call of the same
/// sweep, or row by row on standard output.
pub(crate) fn sweep(args: &SweepArgs) -> Result<(), InputError> {
    let SweepArgs { scenario: file, out, shard, .. } = args;
    let is_stream = is_standard_output(out);
    if !is_stream && out.extension().is_none_or(|end| end != "csv") {
        let reason = "the table must be a .csv file, beside which finished rows are kept to continue from there, or -";
        return Err(bad(file, &format!("--out {}: {reason}", out.display())));
    }
    let (runner, record) = runner(args)?;
    let ensemble = runner.ensemble();
    let cells = cells(ensemble.cells(), *shard);
    let fingerprint = fingerprint(args, ensemble, &record);
    let runner = Arc::new(runner);
    if is_stream {
        return stream(args, &runner, cells);
    }
    let ensemble = runner.ensemble();
    let (mut part, done) = Part::open(out, &fingerprint, ensemble, cells.len())?;
    run_cells(args, &runner, cells, done, &mut |slice| part.append(ensemble, slice))?;
    part.finish(out).map_err(|error| unwritten(out, &error))
}

/// Writes the table on standard output, row by row.
fn stream(args: &SweepArgs, runner: &Arc<Runner>, cells: Range<usize>) -> Result<(), InputError> {
    let ensemble = runner.ensemble();
    let mut run = Ok(());
    let written: io::Result<()> = write(&args.out, |table| {
        writeln!(table, "{}", part::heading(ensemble))?;
        run = run_cells(args, runner, cells, 0, &mut |slice| {
            part::write_rows(table, ensemble, slice)?;
            table.flush()
        });
        Ok(())
    });
    run.and(written.map_err(|error| unwritten(&args.out, &error)))
}

/// Runs the cells that are not done, and appends their rows in the order of the cells.
fn run_cells(
    args: &SweepArgs,
    runner: &Arc<Runner>,
    cells: Range<usize>,
    done: usize,
    append: &mut dyn FnMut(&Slice) -> io::Result<()>,
) -> Result<(), InputError> {
    let SweepArgs { scenario: file, out, threads, .. } = args;
    let threads = (*threads).min(MOST_THREADS).min(cells.len().max(1));
    let team = Threads::new(threads, 0).map_err(|error| bad(file, &error))?;
    let bar = bar(cells.len(), done);
    let order: Vec<usize> = (cells.start + done..cells.end).collect();
    let work = team.rows(Priority::Map, runner, order, |_| {});
    // Rows come in any order, and are written in the order of the cells.
    let mut waiting = BTreeMap::new();
    let mut next = cells.start + done;
    while let Some(slice) = work.wait() {
        bar.inc(slice.cells.len() as u64);
        waiting.insert(slice.cells[0], slice);
        while let Some(slice) = waiting.remove(&next) {
            next += slice.cells.len();
            append(&slice).map_err(|error| unwritten(out, &error))?;
        }
    }
    if next != cells.end {
        return Err(bad(file, &"a thread ended before its work was done"));
    }
    bar.finish_and_clear();
    Ok(())
}

/// The error for a table that cannot be written.
fn unwritten(file: &Path, error: &io::Error) -> InputError {
    InputError::Output { file: file.to_owned(), reason: error.to_string() }
}

fn bad(file: &Path, reason: &dyn ToString) -> InputError {
    InputError::Laboratory { file: file.to_owned(), reason: reason.to_string() }
}

/// The runner of the cells, and a hash of the measured record.
fn runner(args: &SweepArgs) -> Result<(Runner, String), InputError> {
    let SweepArgs { scenario: file, vary, seeds, score, filter, record, .. } = args;
    let (scenario, imported) = scenario_and_record(file, record, &places("--out", [&args.out]))?;
    let hash = imported.as_ref().map_or_else(String::new, |imported| hash_of(&imported.record));
    let source = imported.map_or(Source::Simulated, |imported| Source::Measured(Arc::new(imported.record)));
    let filters = filters(&scenario, filter).map_err(|reason| bad(file, &reason))?;
    let measures = if score.is_empty() {
        let is_known = |measure: &Measure| !measure.info().needs_truth || matches!(source, Source::Simulated);
        Measure::of_sums(&channels(&scenario, &filters)).into_iter().filter(is_known).collect()
    } else {
        score.clone()
    };
    let seeds = seeds.map(|seeds| Axis {
        key: "seed".to_owned(),
        from: 1.0,
        to: f64::from(seeds),
        count: seeds as usize,
        spacing: Spacing::Linear,
    });
    let axes = vary.iter().cloned().chain(seeds).collect();
    let ensemble = Ensemble::new(scenario, Plan { filters, measures, axes, ..Plan::default() });
    let runner = ensemble.and_then(|ensemble| Runner::new(ensemble, source)).map_err(|error| bad(file, &error))?;
    Ok((runner, hash))
}

/// A hash of a record's numbers. Its file may be a pipe, which cannot be read again.
fn hash_of(record: &Record) -> String {
    let mut hash = Hash::default();
    let columns = record.sensors().iter().filter_map(|&sensor| record.measured_quantity(sensor));
    for number in [record.time(0), record.dt()].iter().chain(record.input()).chain(columns.flatten()) {
        hash.add(&number.to_bits().to_le_bytes());
    }
    hash.text()
}

/// The places of the filters with these names; of all if there is no name.
pub(crate) fn filters(scenario: &Scenario, names: &[String]) -> Result<Vec<usize>, String> {
    if names.is_empty() {
        return Ok((0..scenario.filters.len()).collect());
    }
    let place = |name: &String| {
        let place = scenario.filters.iter().position(|filter| filter.name == *name);
        place.ok_or_else(|| format!("the scenario has no filter `{name}`{}", scenario.filters_in_words()))
    };
    names.iter().map(place).collect()
}

/// The cells of a shard, contiguous.
fn cells(all: usize, Shard { number, of }: Shard) -> Range<usize> {
    let cut = |shard: usize| (all as u128 * shard as u128 / of as u128) as usize;
    cut(number - 1)..cut(number)
}

/// A hash of everything that the rows follow from.
fn fingerprint(args: &SweepArgs, ensemble: &Ensemble, record: &str) -> String {
    let Shard { number, of } = args.shard;
    let version = env!("CARGO_PKG_VERSION");
    let all = [version, &ensemble.to_json(), record, &format!("{number}/{of}")].join("\n");
    hash(all.as_bytes())
}

/// The bar on standard error; hidden if that is no terminal.
fn bar(cells: usize, done: usize) -> ProgressBar {
    let bar = ProgressBar::new(cells as u64).with_position(done as u64);
    let template = "{bar:40} {percent} %  {human_pos} of {human_len} runs, {per_sec}, {eta} left";
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar.reset_eta();
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}
