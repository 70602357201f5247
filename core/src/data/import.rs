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

mod band;
mod builder;
mod butterworth;
mod cell;
mod clock;
mod conditioning;
mod decay;
mod dialect;
mod encoding;
mod error;
mod files;
mod formats;
mod guess;
mod header;
mod length;
mod limits;
mod loading;
mod mapping;
mod number;
mod own_clocks;
mod own_times;
mod reader;
mod remarks;
mod resample;
mod ring;
mod role;
mod rows_reader;
mod samples;
mod sentinel;
mod series;
mod sniff;
mod sound;
mod steps;
mod table;
mod three_axes;
mod times;
mod timing;
mod unit;

pub use crate::data::hash::Hash;
pub use builder::{Builder, Imported};
pub use cell::{Cells, Delimiter};
pub use decay::{Decay, NoDecay};
pub use dialect::Dialect;
pub use encoding::Encoding;
pub use error::ImportError;
pub use files::join;
pub use guess::ColumnGuess;
pub use length::Length;
pub use limits::MOST;
pub use loading::{Loaded, Loading};
pub use mapping::{MappedColumn, Mapping, MeanWord, Offset, Time};
pub use number::Decimal;
pub use reader::Reader;
pub(crate) use resample::finer;
pub use ring::Ring;
pub use sentinel::Sentinel;
pub use sound::wav;
pub use table::{Column, Table, TextCell};
pub use three_axes::ThreeAxes;
pub use unit::{Dimension, STANDARD_GRAVITY, unit};

/// The columns of a file, read in one go.
///
/// # Errors
/// As [`Reader::new`] and [`Reader::advance`].
pub fn read(bytes: impl Into<Vec<u8>>, dialect: Option<Dialect>) -> Result<Table, ImportError> {
    let mut reader = Reader::new(bytes.into(), dialect)?;
    while !reader.advance(&mut || true)? {}
    reader.finish()
}

/// The [`struct@Hash`] of a file's bytes, in one go.
pub fn hash(bytes: &[u8]) -> String {
    let mut hash = Hash::default();
    hash.add(bytes);
    hash.text()
}
