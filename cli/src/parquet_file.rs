//! Records in Parquet files.

use bytes::Bytes;
use kalmanscope_core::import::{Column, Table};
use parquet::basic::{LogicalType, TimeUnit};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::schema::types::ColumnDescriptor;

/// The first bytes of a Parquet file.
pub(crate) const MARK: &[u8] = b"PAR1";

/// The columns of numbers in a Parquet file; empty cells are missing readings. Times of day and dates are counted from the first
/// one of the column.
///
/// # Errors
/// The reason why the file cannot be read, such as a compression that this program does not know.
pub(crate) fn read(bytes: Vec<u8>) -> Result<Table, String> {
    let told =
        |error: ParquetError| format!("this Parquet file cannot be read: {error}; uncompressed or with Snappy it can");
    let reader = SerializedFileReader::new(Bytes::from(bytes)).map_err(told)?;
    let described = reader.metadata().file_metadata().schema_descr().columns().to_vec();
    let mut columns: Vec<Option<Numbers>> = described.iter().map(|column| Numbers::of(column)).collect();
    for group in 0..reader.num_row_groups() {
        let group = reader.get_row_group(group).map_err(told)?;
        for (place, column) in columns.iter_mut().enumerate() {
            if let Some(column) = column {
                let rows = usize::try_from(group.metadata().num_rows()).unwrap_or(0);
                column.read(group.get_column_reader(place).map_err(told)?, rows).map_err(told)?;
            }
        }
    }
    let left: Vec<&str> = described
        .iter()
        .zip(&columns)
        .filter(|(_, column)| column.is_none())
        .map(|(column, _)| column.name())
        .collect();
    let remarks = if left.is_empty() { Vec::new() } else { vec![format!("no numbers are in {}", left.join(", "))] };
    let columns: Vec<Column> = columns.into_iter().flatten().map(Numbers::column).collect();
    if columns.iter().all(|column| column.values.iter().all(|value| value.is_nan())) {
        return Err("this Parquet file has no column of numbers".to_owned());
    }
    Ok(Table::of_columns("Parquet", columns, remarks))
}

/// A column of numbers, not yet written.
struct Numbers {
    name: String,
    unit: Option<&'static str>,
    /// The level of a cell that has a value.
    full: i16,
    values: Vec<f64>,
    /// The first whole number of a column of times, which are counted from it: they have more digits than a double.
    first: Option<i64>,
}

impl Numbers {
    /// `None` if the column does not hold single numbers.
    fn of(column: &ColumnDescriptor) -> Option<Self> {
        use parquet::basic::Type::{BOOLEAN, DOUBLE, FLOAT, INT32, INT64};
        let is_number = [BOOLEAN, DOUBLE, FLOAT, INT32, INT64].contains(&column.physical_type());
        let unit = match column.logical_type_ref() {
            Some(LogicalType::Timestamp(time) | LogicalType::Time(time)) => Some(match time.unit {
                TimeUnit::MILLIS => "ms",
                TimeUnit::MICROS => "us",
                TimeUnit::NANOS => "ns",
            }),
            Some(LogicalType::Decimal(_)) => return None,
            _ => None,
        };
        (is_number && column.max_rep_level() == 0).then(|| Self {
            name: column.path().string(),
            unit,
            full: column.max_def_level(),
            values: Vec::new(),
            first: None,
        })
    }

    fn read(&mut self, reader: ColumnReader, rows: usize) -> Result<(), ParquetError> {
        let is_time = self.unit.is_some();
        match reader {
            ColumnReader::BoolColumnReader(reader) => self.take(reader, rows, |_, value| f64::from(u8::from(value))),
            ColumnReader::Int32ColumnReader(reader) => self.take(reader, rows, |_, value| f64::from(value)),
            ColumnReader::Int64ColumnReader(reader) => self.take(reader, rows, |first, value: i64| {
                if is_time { value.saturating_sub(*first.get_or_insert(value)) as f64 } else { value as f64 }
            }),
            ColumnReader::FloatColumnReader(reader) => self.take(reader, rows, |_, value| f64::from(value)),
            ColumnReader::DoubleColumnReader(reader) => self.take(reader, rows, |_, value| value),
            _ => Ok(()),
        }
    }

    fn take<T: DataType>(
        &mut self,
        mut reader: ColumnReaderImpl<T>,
        rows: usize,
        number: impl Fn(&mut Option<i64>, T::T) -> f64,
    ) -> Result<(), ParquetError> {
        let (mut levels, mut values) = (Vec::new(), Vec::new());
        let mut read = 0;
        while read < rows {
            let (records, ..) = reader.read_records(rows - read, Some(&mut levels), None, &mut values)?;
            if records == 0 {
                break;
            }
            read += records;
        }
        let mut there = values.into_iter();
        for k in 0..rows {
            let is_full = self.full == 0 || levels.get(k).is_some_and(|level| *level == self.full);
            let value = if is_full { there.next() } else { None };
            self.values.push(value.map_or(f64::NAN, |value| number(&mut self.first, value)));
        }
        Ok(())
    }

    fn column(self) -> Column {
        let Self { name, unit, values, .. } = self;
        Column::of_header(&name, unit, values)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, FloatType, Int64Type};
    use parquet::file::properties::WriterProperties;
    use parquet::file::writer::SerializedFileWriter;
    use parquet::schema::parser::parse_message_type;

    use super::*;

    /// A file with a time stamp, a column with an empty cell, and a text, in two groups of rows.
    fn file(compression: parquet::basic::Compression) -> Result<Vec<u8>, ParquetError> {
        let schema = "message record { required int64 when (TIMESTAMP(MICROS,true)); optional double x_mm; required float force; \
                      required binary note (UTF8); }";
        let properties = WriterProperties::builder().set_compression(compression).build();
        let mut writer =
            SerializedFileWriter::new(Vec::new(), Arc::new(parse_message_type(schema)?), Arc::new(properties))?;
        for start in [0, 3] {
            let mut group = writer.next_row_group()?;
            let mut column = group.next_column()?.ok_or(ParquetError::EOF(String::new()))?;
            let times: Vec<i64> = (start..start + 3).map(|k| 1_714_560_000_000_000 + 10_000 * k).collect();
            column.typed::<Int64Type>().write_batch(&times, None, None)?;
            column.close()?;
            let mut column = group.next_column()?.ok_or(ParquetError::EOF(String::new()))?;
            column.typed::<DoubleType>().write_batch(&[1.5, 2.5], Some(&[1, 0, 1]), None)?;
            column.close()?;
            let mut column = group.next_column()?.ok_or(ParquetError::EOF(String::new()))?;
            column.typed::<FloatType>().write_batch(&[0.25, 0.5, 0.75], None, None)?;
            column.close()?;
            let mut column = group.next_column()?.ok_or(ParquetError::EOF(String::new()))?;
            column.typed::<ByteArrayType>().write_batch(&vec![ByteArray::from("ok"); 3], None, None)?;
            column.close()?;
            group.close()?;
        }
        writer.into_inner()
    }

    #[test]
    fn columns_of_numbers_are_read_with_their_gaps_and_times() {
        for compression in [parquet::basic::Compression::UNCOMPRESSED, parquet::basic::Compression::SNAPPY] {
            let table = read(file(compression).unwrap()).unwrap();
            let names: Vec<&str> = table.columns.iter().map(|column| column.name.as_str()).collect();
            assert_eq!(names, ["when", "x", "force"]);
            assert_eq!(table.columns[0].values, [0.0, 1e4, 2e4, 3e4, 4e4, 5e4]);
            assert_eq!((table.columns[0].unit.as_deref(), table.columns[1].unit.as_deref()), (Some("us"), Some("mm")));
            assert_eq!(format!("{:?}", table.columns[1].values), "[1.5, NaN, 2.5, 1.5, NaN, 2.5]");
            assert_eq!((table.columns[2].values[2], table.line(5)), (0.75, 6));
            assert_eq!(table.remarks, ["no numbers are in note"]);
        }
    }

    #[test]
    fn files_that_are_cut_are_refused() {
        let whole = file(parquet::basic::Compression::SNAPPY).unwrap();
        for length in [4, 100, whole.len() - 1] {
            assert!(read(whole[..length].to_vec()).unwrap_err().contains("cannot be read"), "{length}");
        }
    }
}
