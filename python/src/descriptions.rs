//! Numbers and names as arguments describe them. What does not fit is a `TypeError`, to which PyO3 adds the
//! name of the argument.

use crate::errors::argument;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyString;

/// Relative difference of entries of an inertia that should be equal.
const ASYMMETRY: f64 = 1e-9;

/// Three numbers.
///
/// # Errors
/// `TypeError`.
pub fn triple(given: &Bound<'_, PyAny>) -> PyResult<[f64; 3]> {
    given.extract().map_err(|_| PyTypeError::new_err(format!("give three numbers, not {}", shown(given))))
}

/// The entries of an inertia, of six, three, or a 3 x 3 matrix; no inertia.
///
/// # Errors
/// `TypeError` for what is neither, and a matrix that is not symmetric.
pub fn inertia_entries(given: &Bound<'_, PyAny>) -> PyResult<Option<Vec<f64>>> {
    if given.is_none() {
        return Ok(None);
    }
    if let Ok(entries) = given.extract::<Vec<f64>>() {
        return Ok(Some(entries));
    }
    let rows: Option<Vec<[f64; 3]>> = given.extract().ok();
    let Some(Ok([x, y, z])) = rows.map(<[[f64; 3]; 3]>::try_from) else {
        let message = format!("give xx, yy, zz, xy, xz, yz or a 3 x 3 matrix, not {}", shown(given));
        return Err(PyTypeError::new_err(message));
    };
    let largest = [x, y, z].as_flattened().iter().fold(0.0_f64, |most, entry| most.max(entry.abs()));
    for (name, a, b) in [("xy", x[1], y[0]), ("xz", x[2], z[0]), ("yz", y[2], z[1])] {
        if (a - b).abs() > ASYMMETRY * largest {
            return Err(PyTypeError::new_err(format!("the matrix is not symmetric: {name} is {a} and {b}")));
        }
    }
    Ok(Some(vec![x[0], y[1], z[2], x[1], x[2], y[2]]))
}

/// A joint, its ratio and its offset.
///
/// # Errors
/// `TypeError`.
pub fn mimicked(given: &Bound<'_, PyAny>) -> PyResult<Option<(String, f64, f64)>> {
    given.extract().map_err(|_| {
        let message = format!("give the name of a joint, a ratio and an offset, not {}", shown(given));
        PyTypeError::new_err(message)
    })
}

/// Names, of which one alone would be read letter by letter.
///
/// # Errors
/// `TypeError`.
pub fn names(given: &Bound<'_, PyAny>) -> PyResult<Option<Vec<String>>> {
    let wrong = || PyTypeError::new_err(format!("give a list of names, not {}", shown(given)));
    if given.is_instance_of::<PyString>() { Err(wrong()) } else { given.extract().map_err(|_| wrong()) }
}

fn shown(given: &Bound<'_, PyAny>) -> String {
    given.repr().map_or_else(|_| "this".into(), |text| text.to_string())
}

/// Entries xx, yy, zz, xy, xz, yz.
pub fn inertia_of(py: Python<'_>, entries: Option<Vec<f64>>) -> PyResult<[f64; 6]> {
    let Some(entries) = entries else { return Ok([0.0; 6]) };
    let full: Result<[f64; 6], _> = entries.as_slice().try_into();
    full.or_else(|_| match *entries.as_slice() {
        [xx, yy, zz] => Ok([xx, yy, zz, 0.0, 0.0, 0.0]),
        _ => {
            let message = format!(
                "inertia has {} entries; give xx, yy, zz, xy, xz, yz or a 3 x 3 matrix",
                entries.len()
            );
            Err(argument(py, "inertia", message))
        }
    })
}
