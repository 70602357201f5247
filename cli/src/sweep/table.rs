//! Tables of numbers as files.

use std::io::{self, BufRead, Write};
use std::path::Path;
use std::sync::Arc;

use parquet::basic::{Repetition, Type as PhysicalType};
use parquet::data_type::DoubleType;
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

/// The form of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    /// Text, with the columns' names in the first line.
    Csv,
    /// Apache Parquet, one column of double numbers a name.
    Parquet,
}

/// Limits the rows of a group, which are in memory at once.
const GROUP: usize = 1 << 18;

impl Format {
    /// The form that a file's name asks for.
    pub(super) fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()? {
            "csv" => Some(Self::Csv),
            "parquet" => Some(Self::Parquet),
            _ => None,
        }
    }
}

/// Writes lines of numbers, after a line of names, as a Parquet file.
pub(super) fn write_parquet(lines: impl BufRead, names: &[String], file: impl Write + Send) -> io::Result<()> {
    let mut lines = lines.lines().skip(1);
    let column = |name: &String| {
        let column = Type::primitive_type_builder(name, PhysicalType::DOUBLE).with_repetition(Repetition::REQUIRED);
        column.build().map(Arc::new)
    };
    let columns = names.iter().map(column).collect::<Result<Vec<_>, _>>().map_err(other)?;
    let schema = Type::group_type_builder("sweep").with_fields(columns).build().map_err(other)?;
    let properties = Arc::new(WriterProperties::builder().build());
    let mut writer = SerializedFileWriter::new(file, Arc::new(schema), properties).map_err(other)?;
    loop {
        let mut columns = vec![Vec::new(); names.len()];
        for line in lines.by_ref().take(GROUP) {
            for (column, cell) in columns.iter_mut().zip(line?.split(',')) {
                column.push(cell.parse::<f64>().map_err(io::Error::other)?);
            }
        }
        let is_last = columns.first().is_none_or(|column| column.len() < GROUP);
        let mut group = writer.next_row_group().map_err(other)?;
        let mut values = columns.iter();
        while let (Some(mut column), Some(values)) = (group.next_column().map_err(other)?, values.next()) {
            column.typed::<DoubleType>().write_batch(values, None, None).map_err(other)?;
            column.close().map_err(other)?;
        }
        group.close().map_err(other)?;
        if is_last {
            break;
        }
    }
    writer.close().map_err(other)?;
    Ok(())
}

fn other(error: ParquetError) -> io::Error {
    io::Error::other(error)
}
