//! Numbers and documents between Rust and Python. Arrays travel as bytes, so that no other crate and no unsafe code is needed.

use kalmanscope_core::document::{self, Document};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyTuple};

use crate::error;

/// The functions that are written in Python.
pub(crate) fn helpers(py: Python<'_>) -> PyResult<Bound<'_, PyModule>> {
    py.import("kalmanscope._columns")
}

/// A new NumPy array of a shape, read-only.
pub(crate) fn array<'py>(
    py: Python<'py>,
    shape: &[usize],
    numbers: impl IntoIterator<Item = f64>,
) -> PyResult<Bound<'py, PyAny>> {
    let bytes = PyBytes::new_with(py, 8 * shape.iter().product::<usize>(), |into| {
        into.chunks_exact_mut(8).zip(numbers).for_each(|(bytes, number)| bytes.copy_from_slice(&number.to_ne_bytes()));
        Ok(())
    })?;
    let array = py.import("numpy")?.call_method1("frombuffer", (bytes, "f8"))?;
    array.call_method1("reshape", (PyTuple::new(py, shape)?,))
}

/// A table's form, its columns by name, what of it is left out, and what the columns of arrays mean as JSON.
type Columns = (String, Vec<(String, Vec<f64>)>, Vec<String>, Option<String>);

/// The columns of a data frame, or of arrays of NumPy, pandas or polars or lists; NaN where a value is missing.
pub(crate) fn columns(
    source: &Bound<'_, PyAny>,
    u: Option<&Bound<'_, PyAny>>,
    sensors: Option<&Bound<'_, PyDict>>,
) -> PyResult<Columns> {
    let found = helpers(source.py())?.call_method1("table", (source, u, sensors))?;
    let (form, columns, remarks, mapping): (_, Vec<(String, Bound<'_, PyBytes>)>, _, _) = found.extract()?;
    let numbers = |bytes: &[u8]| bytes.as_chunks().0.iter().copied().map(f64::from_ne_bytes).collect();
    let columns = columns.into_iter().map(|(name, bytes)| (name, numbers(bytes.as_bytes()))).collect();
    Ok((form, columns, remarks, mapping))
}

/// Dicts, lists and numbers as a document.
pub(crate) fn to_document(of: &Bound<'_, PyAny>) -> PyResult<Document> {
    let text: String = helpers(of.py())?.call_method1("to_json", (of,))?.extract()?;
    document::from_json(&text).map_err(error)
}

/// JSON as dicts, lists and numbers.
pub(crate) fn from_json<'py>(py: Python<'py>, text: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("json")?.call_method1("loads", (text,))
}
