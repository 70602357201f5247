//! Measured records from files: dialect, columns, meaning, conditioning.
//!
//! ```text
//! bytes ──dialect──▶ Table ──mapping──▶ Record
//! ```
//!
//! Each step reports what it found, and the caller can change it: [`Dialect`] comes from the first lines,
//! [`Mapping::guess`] from names, units and shapes.
//!
//! ```
//! use kalmanscope_core::import::{Builder, Mapping, read};
//! use kalmanscope_core::{Hold, Quantity};
//! # fn main() -> Result<(), kalmanscope_core::import::ImportError> {
//! let text = "Zeit [ms];Kraft;Weg [mm]\n0;1,5;2\n10;1;2,5\n20;0;3\n";
//! let table = read(text.as_bytes(), None)?;
//! let (mapping, kind) = Mapping::guess(&table);
//! let imported = Builder::new(&table, &mapping, kind, Hold::First)?.finish()?;
//! assert_eq!(imported.record.dt(), 0.01);
//! assert_eq!(imported.record.measured_quantity(Quantity::DISPLACEMENT), Some(&[0.002, 0.0025, 0.003][..]));
//! # Ok(())
//! # }
//! ```

mod builder;
mod cell;
mod conditioning;
mod dialect;
mod error;
mod formats;
mod guess;
mod header;
mod mapping;
mod mend;
mod missing;
mod own_times;
mod reader;
mod shape;
mod sound;
mod table;
mod three_axes;
mod times;
mod unit;

pub use crate::data::hash::Hash;
pub use builder::{Builder, Imported};
pub use cell::{Cells, Decimal, Delimiter};
pub use dialect::{Dialect, Encoding};
pub use error::{ImportError, MOST};
pub use guess::ColumnGuess;
pub use mapping::{MappedColumn, Mapping, MeanWord, Offset, Time};
pub use mend::turn;
pub use missing::Sentinel;
pub use own_times::join;
pub use reader::{Loaded, Loading};
pub use sound::wav;
pub use table::{Column, Table, TextCell};
pub use three_axes::ThreeAxes;
pub use unit::{Dimension, STANDARD_GRAVITY, unit};

/// The columns of a file, read in one go.
///
/// # Errors
/// [`ImportError`] where the file is empty, not text, or without numbers.
pub fn read(bytes: impl Into<Vec<u8>>, dialect: Option<Dialect>) -> Result<Table, ImportError> {
    reader::Reader::read(bytes.into(), dialect).map(mend::mend)
}

/// The [`struct@Hash`] of a file's bytes, in one go.
pub fn hash(bytes: &[u8]) -> String {
    let mut hash = Hash::default();
    hash.add(bytes);
    hash.text()
}
