//! What is only worth knowing: a message of the logger `costate`, no warning.

use pyo3::prelude::*;

/// Logs a text at the level of information.
///
/// # Errors
/// Those of handlers of the logger.
pub fn note(py: Python<'_>, text: &str) -> PyResult<()> {
    let logger = py.import("logging")?.call_method1("getLogger", ("costate",))?;
    logger.call_method1("info", ("%s", text))?;
    Ok(())
}
