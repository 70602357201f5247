//! The rows of a sweep that are done, in a file that outlives the program.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, BufRead as _, BufReader, BufWriter, Read as _, Seek as _, SeekFrom, Write};
use std::path::{Path, PathBuf};

use kalmanscope_cli::{harmless, output};
use kalmanscope_lab::{Ensemble, Slice};

use crate::input::InputError;
use crate::places::say;

use super::{bad, unwritten};

/// The beginning of every part file.
const FIRST: &str = "# sweep ";

/// A file of rows: a line that says which sweep it is, the names of the columns, and one line a cell.
pub(super) struct Part {
    path: PathBuf,
    file: BufWriter<File>,
}

impl Part {
    /// The part file beside the table. Returns the number of rows that it has already, if it is of the same sweep.
    pub(super) fn open(
        out: &Path,
        fingerprint: &str,
        ensemble: &Ensemble,
        most: usize,
    ) -> Result<(Self, usize), InputError> {
        let unwritten = |error| unwritten(out, &error);
        let path = beside(out, ".part");
        let header = format!("{FIRST}{fingerprint}\n{}\n", heading(ensemble));
        let columns = names(ensemble).len();
        let file = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path);
        let mut file = file.map_err(unwritten)?;
        // Two programs would write into each other's rows. A file system without locks is used without.
        if let Err(TryLockError::WouldBlock) = file.try_lock() {
            return Err(bad(out, &"another program is writing this table"));
        }
        let found = complete(&file, &header, columns, most).map_err(unwritten)?;
        if found.is_none() && file.metadata().map_err(unwritten)?.len() > 0 {
            if !begins_as_part(&mut file).map_err(unwritten)? {
                return Err(bad(
                    &path,
                    &"this file is no part of a sweep, and stays as it is; write the table elsewhere",
                ));
            }
            say(&format_args!("{}: it is of another sweep, and is begun anew", path.display()));
        }
        // The last row may be torn.
        file.set_len(found.map_or(0, |(bytes, _)| bytes)).map_err(unwritten)?;
        file.seek(SeekFrom::End(0)).map_err(unwritten)?;
        let mut file = BufWriter::new(file);
        if found.is_none() {
            file.write_all(header.as_bytes()).map_err(unwritten)?;
        }
        Ok((Self { path, file }, found.map_or(0, |(_, rows)| rows)))
    }

    /// Appends the rows of some cells.
    pub(super) fn append(&mut self, ensemble: &Ensemble, slice: &Slice) -> io::Result<()> {
        write_rows(&mut self.file, ensemble, slice)?;
        self.file.flush()
    }

    /// Turns the part into the table.
    pub(super) fn finish(self, out: &Path) -> io::Result<()> {
        let Self { path, mut file } = self;
        file.flush()?;
        drop(file);
        let mut lines = BufReader::new(File::open(&path)?);
        lines.skip_until(b'\n')?;
        output::write(out, |table| io::copy(&mut lines, table).map(|_| ()))?;
        fs::remove_file(&path)
    }
}

/// The line of the columns' names.
pub(super) fn heading(ensemble: &Ensemble) -> String {
    let names = names(ensemble);
    names.iter().map(|name| harmless(name)).collect::<Vec<_>>().join(",")
}

/// Writes the rows of some cells.
pub(super) fn write_rows(file: &mut dyn Write, ensemble: &Ensemble, slice: &Slice) -> io::Result<()> {
    let width = ensemble.width();
    for (at, &cell) in slice.cells.iter().enumerate() {
        let row = &slice.rows[at * width..(at + 1) * width];
        let (values, drawn) = (ensemble.values(cell), ensemble.member(cell));
        let numbers: Vec<String> = values.iter().chain(&drawn).chain(row).map(f64::to_string).collect();
        writeln!(file, "{}", numbers.join(","))?;
    }
    Ok(())
}

/// Whether a file begins as the part of some sweep does.
fn begins_as_part(file: &mut File) -> io::Result<bool> {
    let mut head = Vec::new();
    file.seek(SeekFrom::Start(0))?;
    file.take(FIRST.len() as u64).read_to_end(&mut head)?;
    Ok(head == FIRST.as_bytes())
}

/// The names of the table's columns: the axes' keys, those of drawn numbers, then those of the scores.
fn names(ensemble: &Ensemble) -> Vec<String> {
    let axes = ensemble.plan().axes.iter().map(|axis| axis.key.clone());
    let scenario = ensemble.scenario();
    let drawn = ensemble.drawn().iter().map(|address| scenario.address_by_name(&address.to_string()));
    axes.chain(drawn).chain(ensemble.columns()).map(|name| name.replace([',', '\n', '"'], "_")).collect()
}

fn beside(out: &Path, ending: &str) -> PathBuf {
    let mut name = out.as_os_str().to_owned();
    name.push(ending);
    name.into()
}

/// The length in bytes of the whole rows in a part file, and their number, if it is of the same sweep.
fn complete(file: &File, header: &str, columns: usize, most: usize) -> io::Result<Option<(u64, usize)>> {
    let mut lines = BufReader::new(file);
    let mut line = Vec::new();
    let mut head = Vec::new();
    for _ in header.lines() {
        lines.read_until(b'\n', &mut head)?;
    }
    if head != header.as_bytes() {
        return Ok(None);
    }
    let (mut bytes, mut rows) = (header.len() as u64, 0);
    while rows < most {
        line.clear();
        lines.read_until(b'\n', &mut line)?;
        let is_whole = line.ends_with(b"\n") && line.iter().filter(|&&byte| byte == b',').count() + 1 == columns;
        if !is_whole {
            break;
        }
        bytes += line.len() as u64;
        rows += 1;
    }
    Ok(Some((bytes, rows)))
}
