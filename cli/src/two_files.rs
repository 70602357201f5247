//! Two files with their own clocks, written as one.

use std::path::{Path, PathBuf};

use kalmanscope_core::Task as _;
use kalmanscope_core::import::{self, OffsetSearch, Table, join};

use crate::args::{ImportArgs, Missing};
use crate::input::InputError;
use crate::meaning::mapping;
use crate::places::{say, write_bytes};

/// Writes the columns of two files into a third one, each with its times. Without an offset, it is the one with which both agree
/// best. Returns the columns of the third file, and its hash.
pub(crate) fn two_files(
    first: &Table,
    (other, second): (&Path, &Table),
    to: &Path,
    args: &ImportArgs,
) -> Result<(Table, String), InputError> {
    let bad = |error| InputError::Import { file: other.to_owned(), error };
    // A cubic through a number that is no reading would spoil its neighbours.
    let [first, second] = &[first, second].map(|table| match args.missing {
        Some(Missing(None)) => table.clone(),
        Some(Missing(number)) => table.with_gaps(number),
        None => table.with_gaps(None),
    });
    let offset = match args.offset {
        Some(offset) => offset,
        None => {
            let search = OffsetSearch::new([first, second], |table| mapping(table, args).0).map_err(bad)?;
            let agreement = search.run().map_err(bad)?;
            say(&agreement);
            agreement.offset.seconds
        }
    };
    let table = join(first, second, offset).map_err(bad)?;
    table.remarks.iter().for_each(|remark| say(remark));
    let bytes = table.csv().into_bytes();
    write_bytes(to, &bytes)?;
    let hash = import::hash(&bytes);
    let table = import::read(bytes, None).map_err(|error| InputError::Import { file: PathBuf::from(to), error })?;
    Ok((table, hash))
}
