//! A file of a record from its bytes: their hash, then the columns.

use super::{Hash, ImportError, Reader, Table};
use crate::data::task::Task;

/// The bytes that are hashed between two checks of the clock: about a millisecond.
const CHUNK: usize = 500_000;

/// The share of the time that the hash takes.
const HASHING: f64 = 0.1;

/// A file that has been read.
#[derive(Clone, Debug, PartialEq)]
pub struct Loaded {
    /// The [`struct@Hash`] of its bytes.
    pub hash: String,
    /// Its columns.
    pub table: Table,
}

/// Hashes a file's bytes and reads them, in the dialect that it finds.
///
/// ```
/// use kalmanscope_core::Task;
/// use kalmanscope_core::import::{Loading, hash};
/// # fn main() -> Result<(), kalmanscope_core::import::ImportError> {
/// let loaded = Loading::new(b"t;x\n0,0;1,5\n0,1;2\n".to_vec()).run()?;
/// assert_eq!(loaded.hash, hash(b"t;x\n0,0;1,5\n0,1;2\n"));
/// assert_eq!(loaded.table.columns[1].values, [1.5, 2.0]);
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Loading(Stage);

#[derive(Debug)]
enum Stage {
    /// The bytes are hashed, up to a place.
    Hashing(Vec<u8>, Hash, usize),
    Reading(Box<Reader>, Hash),
    Failed(ImportError),
}

impl Loading {
    /// A file's bytes, none of them read yet.
    pub fn new(bytes: Vec<u8>) -> Self {
        Self(Stage::Hashing(bytes, Hash::default(), 0))
    }
}

impl Task for Loading {
    /// [`ImportError`] as of [`Reader`].
    type Outcome = Result<Loaded, ImportError>;

    fn progress(&self) -> f64 {
        match &self.0 {
            Stage::Hashing(bytes, _, done) => HASHING * *done as f64 / bytes.len().max(1) as f64,
            Stage::Reading(reader, _) => HASHING + (1.0 - HASHING) * reader.progress(),
            Stage::Failed(_) => 1.0,
        }
    }

    fn advance(&mut self, while_time: &mut dyn FnMut() -> bool) -> bool {
        let Self(stage) = self;
        if let Stage::Hashing(bytes, hash, done) = stage {
            while *done < bytes.len() {
                let end = (*done + CHUNK).min(bytes.len());
                hash.add(&bytes[*done..end]);
                *done = end;
                if !while_time() {
                    return false;
                }
            }
            *stage = match Reader::new(std::mem::take(bytes), None) {
                Ok(reader) => Stage::Reading(Box::new(reader), *hash),
                Err(error) => Stage::Failed(error),
            };
        }
        if let Stage::Reading(reader, _) = stage {
            match reader.advance(while_time) {
                Ok(is_read) => return is_read,
                Err(error) => *stage = Stage::Failed(error),
            }
        }
        true
    }

    fn finish(mut self) -> Self::Outcome {
        while !self.advance(&mut || true) {}
        match self.0 {
            Stage::Reading(reader, hash) => Ok(Loaded { hash: hash.text(), table: reader.finish()? }),
            Stage::Failed(error) => Err(error),
            Stage::Hashing(..) => Err(ImportError::Empty),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::import::{hash, read};
    use crate::document;

    fn text() -> Vec<u8> {
        let row = |k: u32| format!("{},{:.6}\n{}", f64::from(k) * 0.01, f64::from(k).sin(), ["", "\n"][k as usize % 2]);
        let rows: String = (0..60_000).map(row).collect();
        format!("t [s],x [mm]\n{rows}600,oops,7\n").into_bytes()
    }

    #[test]
    fn a_file_in_slices_is_the_file_in_one_go() {
        let (mut loading, mut shares) = (Loading::new(text()), vec![0.0]);
        while !loading.advance(&mut || false) {
            shares.push(loading.progress());
        }
        assert!(shares.len() > 100 && shares.is_sorted() && shares[shares.len() - 1] < 1.0);
        let Loaded { hash: sum, table } = loading.finish().unwrap();
        assert_eq!(sum, hash(&text()));
        // One number is not equal to itself.
        assert_eq!(format!("{table:?}"), format!("{:?}", read(text(), None).unwrap()));
        assert_eq!(Loading::new(text()).finish().unwrap().hash, hash(&text()), "in one go");
    }

    #[test]
    fn what_is_no_table_fails() {
        for bytes in [&b""[..], b"PK\x03\x04....", b"a,b\nc,d\n"] {
            let mut loading = Loading::new(bytes.to_vec());
            while !loading.advance(&mut || false) {}
            assert_eq!(loading.finish().unwrap_err().to_string(), read(bytes, None).unwrap_err().to_string());
        }
    }

    #[test]
    fn a_table_can_be_sent_apart_from_its_numbers() {
        let table = read(text(), None).unwrap();
        let mut sent: Table = document::read_json(&document::to_json(&table).unwrap()).unwrap();
        assert_eq!((sent.columns.len(), sent.rows(), sent.line(50_000)), (2, 0, table.line(50_000)));
        for (sent, column) in sent.columns.iter_mut().zip(&table.columns) {
            sent.values.clone_from(&column.values);
        }
        assert_eq!(format!("{sent:?}"), format!("{table:?}"));
    }
}
