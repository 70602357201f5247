//! The rows of a sweep that are done, in a file that outlives the program.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, BufRead as _, BufReader, BufWriter, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};

use kalmanscope_lab::{Ensemble, Slice};

use super::table::{Format, write_parquet};

/// A file of rows: a line that says which sweep it is, the names of the columns, and one line a cell.
pub(super) struct Part {
    path: PathBuf,
    file: BufWriter<File>,
}

impl Part {
    /// The part file beside the table. Returns the number of rows that it has already, if it is of the same sweep.
    pub(super) fn open(out: &Path, fingerprint: &str, ensemble: &Ensemble, most: usize) -> io::Result<(Self, usize)> {
        let path = beside(out, ".part");
        let header = format!("# sweep {fingerprint}\n{}\n", names(ensemble).join(","));
        let columns = ensemble.plan().axes.len() + ensemble.width();
        let mut file = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path)?;
        // Two programs would write into each other's rows. A file system without locks is used without.
        if let Err(TryLockError::WouldBlock) = file.try_lock() {
            return Err(io::Error::other("another program is writing this table"));
        }
        let found = complete(&file, &header, columns, most)?;
        // The last row may be torn.
        file.set_len(found.map_or(0, |(bytes, _)| bytes))?;
        file.seek(SeekFrom::End(0))?;
        let mut file = BufWriter::new(file);
        if found.is_none() {
            file.write_all(header.as_bytes())?;
        }
        Ok((Self { path, file }, found.map_or(0, |(_, rows)| rows)))
    }

    /// Appends the rows of some cells.
    pub(super) fn append(&mut self, ensemble: &Ensemble, slice: &Slice) -> io::Result<()> {
        let width = ensemble.width();
        for (at, &cell) in slice.cells.iter().enumerate() {
            let row = &slice.rows[at * width..(at + 1) * width];
            let numbers: Vec<String> = ensemble.values(cell).iter().chain(row).map(f64::to_string).collect();
            writeln!(self.file, "{}", numbers.join(","))?;
        }
        self.file.flush()
    }

    /// Turns the part into the table.
    pub(super) fn finish(self, out: &Path, format: Format, ensemble: &Ensemble) -> io::Result<()> {
        let Self { path, mut file } = self;
        file.flush()?;
        drop(file);
        let mut lines = BufReader::new(File::open(&path)?);
        lines.skip_until(b'\n')?;
        let unfinished = beside(out, ".tmp");
        match format {
            Format::Csv => {
                let mut table = BufWriter::new(File::create(&unfinished)?);
                io::copy(&mut lines, &mut table)?;
                table.flush()?;
            }
            Format::Parquet => write_parquet(lines, &names(ensemble), File::create(&unfinished)?)?,
        }
        fs::rename(&unfinished, out)?;
        fs::remove_file(&path)
    }
}

/// The names of the table's columns: the axes' keys, then those of the scores.
fn names(ensemble: &Ensemble) -> Vec<String> {
    let axes = ensemble.plan().axes.iter().map(|axis| axis.key.clone());
    axes.chain(ensemble.columns()).map(|name| name.replace([',', '\n', '"'], "_")).collect()
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
