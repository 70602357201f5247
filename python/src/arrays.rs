//! Numbers and documents between Rust and Python. Arrays travel as bytes, so that no other crate and no unsafe code is needed.

use kalmanscope_core::document::{self, Document};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyTuple};

use crate::error;

/// The functions that are written in Python.
fn helpers(py: Python<'_>) -> PyResult<Bound<'_, PyModule>> {
    py.import("kalmanscope._columns")
}

/// A NumPy array of a shape, read-only.
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

/// A column of NumPy, pandas or polars, or a list, as numbers; NaN where a value is missing.
pub(crate) fn column(values: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    let bytes = helpers(values.py())?.call_method1("column", (values,))?;
    let (numbers, _) = bytes.cast::<PyBytes>()?.as_bytes().as_chunks();
    Ok(numbers.iter().copied().map(f64::from_ne_bytes).collect())
}

/// The names and columns of a data frame.
pub(crate) fn frame(of: &Bound<'_, PyAny>) -> PyResult<Vec<(String, Vec<f64>)>> {
    let columns = helpers(of.py())?.call_method1("frame", (of,))?;
    let columns = columns.try_iter()?.map(|pair| {
        let (name, values): (String, Bound<'_, PyAny>) = pair?.extract()?;
        Ok((name, column(&values)?))
    });
    columns.collect()
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
