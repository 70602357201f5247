//! The tests of the records: one program. `cargo test -p kalmanscope-records --test all NAME::` runs those of one file.
#![expect(clippy::unwrap_used, reason = "a helper that fails is a test that fails")]

mod building;
mod cells;
mod packed;
mod reading;
mod record;
mod resample;

use kalmanscope_filters::Hold;
use kalmanscope_records::import::{ImportError, Imported, Mapping, Table, build};

fn read(bytes: impl AsRef<[u8]>) -> Result<Table, ImportError> {
    kalmanscope_records::import::read(bytes, None)
}

fn import(text: &str, change: impl Fn(&mut Mapping)) -> Result<Imported, ImportError> {
    let table = read(text)?;
    let (mut mapping, kind) = Mapping::guess(&table);
    change(&mut mapping);
    build(&table, &mapping, kind, Hold::First, &[])
}

fn names(table: &Table) -> Vec<&str> {
    table.columns.iter().map(|column| column.name.as_str()).collect()
}
