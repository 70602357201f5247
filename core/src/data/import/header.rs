//! The meaning that a column has by its header and its cells alone.

use super::{MappedColumn, Table};

impl MappedColumn {
    /// The column of a table with a name, in the unit of its header; a number that loggers write where a reading is missing, and
    /// that is far from all others, is missing.
    pub fn of(table: &Table, column: impl Into<String>) -> Self {
        let mut mapped = Self::new(column);
        if let Some(place) = table.place(&mapped.column) {
            mapped.unit = table.columns[place].unit.clone().unwrap_or_default();
            mapped.missing = table.sentinel(place).filter(|found| found.is_usual).map(|found| found.value);
        }
        mapped
    }
}
