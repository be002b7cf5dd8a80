//! Lists of numbers from Python, and rows of numbers as arrays.

use crate::errors::argument;
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::prelude::*;

/// A list or an array of numbers; so many where that is known.
///
/// # Errors
/// `ArgumentError`.
pub fn numbers(given: &Bound<'_, PyAny>, name: &str, expected: Option<usize>) -> PyResult<Vec<f64>> {
    let array = given.cast::<PyArray1<f64>>().ok().and_then(|array| array.to_vec().ok());
    let found = match array {
        Some(found) => Some(found),
        // Truth values are none, though they convert.
        None => given.try_iter().ok().and_then(|entries| entries.map(number).collect()),
    };
    let found = found.ok_or_else(|| {
        let kind = given.get_type().name().map_or_else(|_| "?".into(), |name| name.to_string());
        let form = expected.map_or("numbers".into(), |count| format!("{count} numbers"));
        argument(given.py(), name, format!("{name} is a {kind}; give an array or a sequence of {form}"))
    })?;
    match expected {
        Some(count) if count != found.len() => {
            let message = format!("{name} has {} entries, not {count}", found.len());
            Err(argument(given.py(), name, message))
        }
        _ => Ok(found),
    }
}

/// An entry that is a number.
fn number(entry: PyResult<Bound<'_, PyAny>>) -> Option<f64> {
    let entry = entry.ok()?;
    let kind = entry.get_type().name().map_or_else(|_| String::new(), |name| name.to_string());
    if matches!(kind.as_str(), "bool" | "bool_") { None } else { entry.extract().ok() }
}

/// Rows of so many numbers as an array.
pub fn matrix<'py>(
    py: Python<'py>,
    rows: &[Vec<f64>],
    columns: usize,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let flat = PyArray1::from_iter(py, rows.iter().flatten().copied());
    flat.reshape([rows.len(), columns])
}

/// Matrices one after the other as an array.
pub fn matrices<'py>(
    py: Python<'py>,
    all: Vec<f64>,
    [rows, columns]: [usize; 2],
) -> PyResult<Bound<'py, PyArray3<f64>>> {
    let count = all.len() / (rows * columns).max(1);
    PyArray1::from_vec(py, all).reshape([count, rows, columns])
}
