//! The command `kalmanscope-cli sweep`: always in double precision, by the processor, so that a table has the same bytes
//! everywhere. Only the explorer's maps use a graphics processor.

use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, BufRead as _, BufReader, BufWriter, Read as _, Seek as _, SeekFrom, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use kalmanscope_cli::{harmless, output};
use kalmanscope_core::import::{Hash, hash};
use kalmanscope_core::{Axis, Record, Scenario, Source, Spacing};
use kalmanscope_diagnosis::{Measure, UnknownMeasure};
use kalmanscope_lab::{Ensemble, Plan, Priority, Runner, Slice, Threads, channels};
use thiserror::Error;

use crate::args::{InputArgs, Shard, SweepArgs};
use crate::files::{InputError, is_standard_output, places, say, write};
use crate::prepared::scenario_and_record;
use crate::progress::ProgressDisplay;

const MOST_THREADS: usize = 256;

/// A file continues that of an interrupted call of the same sweep; standard output begins with the first row.
pub(crate) fn sweep(args: &SweepArgs) -> Result<(), InputError> {
    let SweepArgs { input: InputArgs { scenario: file, .. }, out, shard, .. } = args;
    let is_stream = is_standard_output(out);
    if !is_stream && out.extension().is_none_or(|end| end != "csv") {
        let reason = "the table must be a .csv file, so that finished rows can be kept beside it, or -";
        return Err(InputError::bad(file, &format!("--out {}: {reason}", out.display())));
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
    let (mut part, done) = SweepFile::open(out, &fingerprint, ensemble, cells.len())?;
    run_cells(args, &runner, cells.start + done..cells.end, &mut |slice| part.append(ensemble, slice))?;
    part.finish(out).map_err(|error| InputError::unwritten(out, &error))
}

fn stream(args: &SweepArgs, runner: &Arc<Runner>, cells: Range<usize>) -> Result<(), InputError> {
    let ensemble = runner.ensemble();
    let mut run = Ok(());
    let written: io::Result<()> = write(&args.out, |table| {
        writeln!(table, "{}", heading(ensemble))?;
        run = run_cells(args, runner, cells, &mut |slice| {
            write_rows(table, ensemble, slice)?;
            table.flush()
        });
        Ok(())
    });
    run.and(written.map_err(|error| InputError::unwritten(&args.out, &error)))
}

fn run_cells(
    args: &SweepArgs,
    runner: &Arc<Runner>,
    cells: Range<usize>,
    append: &mut dyn FnMut(&Slice) -> io::Result<()>,
) -> Result<(), InputError> {
    run_in_order(runner, cells, args.threads, (false, "runs"), append).map_err(|error| match error {
        SweepError::Append(error) => InputError::unwritten(&args.out, &error),
        error => InputError::bad(&args.input.scenario, &error),
    })
}

#[derive(Debug, Error)]
pub(crate) enum SweepError {
    #[error(transparent)]
    Append(#[from] io::Error),
    #[error(transparent)]
    Threads(io::Error),
    #[error("a thread ended before its work was done")]
    Lost,
}

/// Runs some cells on threads, and takes their rows in the order of the cells: rows come in any order.
pub(crate) fn run_in_order(
    runner: &Arc<Runner>,
    cells: Range<usize>,
    threads: usize,
    (quiet, what): (bool, &str),
    append: &mut dyn FnMut(&Slice) -> io::Result<()>,
) -> Result<(), SweepError> {
    let threads = threads.min(MOST_THREADS).min(cells.len().max(1));
    let team = Threads::new(threads, 0).map_err(SweepError::Threads)?;
    let progress = ProgressDisplay::new(cells.len(), quiet);
    let work = team.rows(Priority::Map, runner, cells.clone().collect(), |_| {});
    let (mut waiting, mut next, mut finished) = (BTreeMap::new(), cells.start, 0);
    while let Some(slice) = work.wait() {
        finished += slice.cells.len();
        progress.show(finished, what);
        waiting.insert(slice.cells[0], slice);
        while let Some(slice) = waiting.remove(&next) {
            next += slice.cells.len();
            append(&slice)?;
        }
    }
    if next == cells.end { Ok(()) } else { Err(SweepError::Lost) }
}

fn runner(args: &SweepArgs) -> Result<(Runner, String), InputError> {
    let SweepArgs { input, vary, seeds, score, filter, .. } = args;
    let file = &input.scenario;
    let (scenario, imported) = scenario_and_record(input, &places("--out", [&args.out]))?;
    let hash = imported.as_ref().map_or_else(String::new, |imported| hash_of(&imported.record));
    let source = imported.map_or(Source::Simulated, |imported| Source::Measured(Arc::new(imported.record)));
    let filters = filters(&scenario, filter).map_err(|reason| InputError::bad(file, &reason))?;
    let measures = if score.is_empty() {
        // A measured record has no truth: such a column would be NaN in every row.
        let is_known = |measure: &Measure| !measure.info().needs_truth || matches!(source, Source::Simulated);
        Measure::of_sums(&channels(&scenario, &filters)).into_iter().filter(is_known).collect()
    } else {
        let read = || score.iter().map(|text| text.parse()).collect::<Result<_, UnknownMeasure>>();
        scenario.knowing(read).map_err(|reason| InputError::bad(file, &reason))?
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
    let runner =
        ensemble.and_then(|ensemble| Runner::new(ensemble, source)).map_err(|error| InputError::bad(file, &error))?;
    Ok((runner, hash))
}

/// A hash of a record's numbers. Its file may be a pipe, which cannot be read again.
fn hash_of(record: &Record) -> String {
    let mut hash = Hash::default();
    let columns = record.sensors().iter().filter_map(|&sensor| record.measured_quantity(sensor));
    let inputs = record.input().iter().chain(record.forces().flat_map(|(_, values)| values));
    for number in [record.time(0), record.dt()].iter().chain(inputs).chain(columns.flatten()) {
        hash.add(&number.to_bits().to_le_bytes());
    }
    hash.text()
}

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

fn cells(all: usize, Shard { number, of }: Shard) -> Range<usize> {
    // The product of two counts may exceed 64 bits.
    let cut = |shard: usize| (all as u128 * shard as u128 / of as u128) as usize;
    cut(number - 1)..cut(number)
}

fn fingerprint(args: &SweepArgs, ensemble: &Ensemble, record: &str) -> String {
    let Shard { number, of } = args.shard;
    let version = env!("CARGO_PKG_VERSION");
    // Another version may compute other bits, and a table must not mix the rows of two.
    let all = [version, &ensemble.to_json(), record, &format!("{number}/{of}")].join("\n");
    hash(all.as_bytes())
}

const FIRST: &str = "# sweep ";

/// A file of rows: a line that says which sweep it is, the names of the columns, and one line a cell.
struct SweepFile {
    path: PathBuf,
    file: BufWriter<File>,
}

impl SweepFile {
    /// The part file beside the table. Returns the number of rows that it has already, if it is of the same sweep.
    fn open(out: &Path, fingerprint: &str, ensemble: &Ensemble, most: usize) -> Result<(Self, usize), InputError> {
        let unwritten = |error| InputError::unwritten(out, &error);
        let mut path = out.as_os_str().to_owned();
        path.push(".part");
        let path = PathBuf::from(path);
        let header = format!("{FIRST}{fingerprint}\n{}\n", heading(ensemble));
        let columns = names(ensemble).len();
        let file = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path);
        let mut file = file.map_err(unwritten)?;
        // Two programs would write into each other's rows. A file system without locks is used without.
        if let Err(TryLockError::WouldBlock) = file.try_lock() {
            return Err(InputError::bad(out, &"another program is writing this table"));
        }
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(unwritten)?;
        let kept = bytes.strip_prefix(header.as_bytes()).map(|rows| {
            let is_whole =
                |row: &&[u8]| row.ends_with(b"\n") && row.iter().filter(|&&byte| byte == b',').count() + 1 == columns;
            let rows = rows.split_inclusive(|&byte| byte == b'\n').take(most).take_while(is_whole);
            rows.fold((header.len(), 0), |(bytes, count), row| (bytes + row.len(), count + 1))
        });
        if kept.is_none() && !bytes.is_empty() {
            if !bytes.starts_with(FIRST.as_bytes()) {
                return Err(InputError::bad(
                    &path,
                    &"this file is not part of a sweep and stays as it is; write the table elsewhere",
                ));
            }
            say(&format_args!("{}: it belongs to another sweep, so the table begins again", path.display()));
        }
        // The last row may be torn.
        file.set_len(kept.map_or(0, |(bytes, _)| bytes as u64)).map_err(unwritten)?;
        file.seek(SeekFrom::End(0)).map_err(unwritten)?;
        let mut file = BufWriter::new(file);
        if kept.is_none() {
            file.write_all(header.as_bytes()).map_err(unwritten)?;
        }
        Ok((Self { path, file }, kept.map_or(0, |(_, rows)| rows)))
    }

    fn append(&mut self, ensemble: &Ensemble, slice: &Slice) -> io::Result<()> {
        // Flushed with each slice: an interruption loses only the cells that are running.
        write_rows(&mut self.file, ensemble, slice)?;
        self.file.flush()
    }

    fn finish(self, out: &Path) -> io::Result<()> {
        let Self { path, mut file } = self;
        file.flush()?;
        // Windows refuses to read or to remove a file that another handle has locked.
        drop(file);
        let mut lines = BufReader::new(File::open(&path)?);
        lines.skip_until(b'\n')?;
        // A copy and no rename: the table must not begin with the line that says which sweep it is.
        output::write(out, |table| io::copy(&mut lines, table).map(|_| ()))?;
        fs::remove_file(&path)
    }
}

fn heading(ensemble: &Ensemble) -> String {
    let names = names(ensemble);
    names.iter().map(|name| harmless(name)).collect::<Vec<_>>().join(",")
}

fn write_rows(file: &mut dyn Write, ensemble: &Ensemble, slice: &Slice) -> io::Result<()> {
    let width = ensemble.width();
    for (at, &cell) in slice.cells.iter().enumerate() {
        let row = &slice.rows[at * width..(at + 1) * width];
        let (values, drawn) = (ensemble.values(cell), ensemble.member(cell));
        // The shortest text of a number reads back as the same bits.
        let numbers: Vec<String> = values.iter().chain(&drawn).chain(row).map(f64::to_string).collect();
        writeln!(file, "{}", numbers.join(","))?;
    }
    Ok(())
}

fn names(ensemble: &Ensemble) -> Vec<String> {
    let axes = ensemble.plan().axes.iter().map(|axis| axis.key.clone());
    let scenario = ensemble.scenario();
    let drawn = ensemble.drawn().iter().map(|address| scenario.address_by_name(&address.to_string()));
    // A continued file counts the commas of its rows, so no name may have one.
    axes.chain(drawn).chain(ensemble.columns()).map(|name| name.replace([',', '\n', '"'], "_")).collect()
}
