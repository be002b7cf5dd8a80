//! Inertias as arguments describe them.

use crate::errors::argument;
use pyo3::prelude::*;

/// Entries xx, yy, zz, xy, xz, yz.
pub fn inertia_of(py: Python<'_>, entries: Option<Vec<f64>>) -> PyResult<[f64; 6]> {
    let Some(entries) = entries else { return Ok([0.0; 6]) };
    let full: Result<[f64; 6], _> = entries.as_slice().try_into();
    full.or_else(|_| match *entries.as_slice() {
        [xx, yy, zz] => Ok([xx, yy, zz, 0.0, 0.0, 0.0]),
        _ => {
            let message = format!("inertia has {} entries; give xx, yy, zz, xy, xz, yz", entries.len());
            Err(argument(py, "inertia", message))
        }
    })
}
